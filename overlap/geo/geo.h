// SPDX-License-Identifier: Apache-2.0
// Learned overlap volumes that can be trusted with forces:
//
//     pair ─ gate ─► empty: V = 0
//              └──► centre ──► frame P, V₀ ──► features f ──► ρ(f) ──► V = V₀ exp φ
//
// φ = ln 1.28 + ρ(f) − ρ(f*) with f* the features of the onset P*: whatever the network ρ has learned, V and
// the true volume become equal as the overlap vanishes. V has all derivatives wherever it is positive; what
// the exact model has by symmetry (order of vertices and of tetrahedra, rigid motion, scale, net force and
// torque of a pair) it has to rounding.
//
// The network is anything with the two operations below; without one φ = ln 1.28. Pairs too flat for the
// frame, or whose centre Newton's method does not find, are answered by the exact model and flagged FALLBACK
// (their Hessian by clipping).
#ifndef TETLAP_OVERLAP_GEO_GEO_H
#define TETLAP_OVERLAP_GEO_GEO_H

#include "overlap/geo/bundle/bundle.h"
#include "overlap/geo/features/features.h"
#include "overlap/geo/frame.h"
#include "overlap/ops.h"

enum { OVERLAP_GEO_CHUNK = OVERLAP_GEO_BLOCK }; // a network is given at most so many pairs at once

// ρ. All functions may be called from several threads at once.
typedef struct OverlapGeoNetwork {
  const void *self;  // borrowed
  int feature_count; // must have a feature set
  // ρ (count) and, unless NULL, dρ/df (count, feature_count) of features (count, feature_count).
  Status (*eval)(const void *self, int count, const double *features, double *value, double *gradient);
  // The same of OVERLAP_GEO_CHUNK pairs side by side: features and gradient (feature_count, chunk), value
  // (chunk), on cache lines. NULL: eval is used.
  Status (*eval_columns)(const void *self, const double *features, double *value, double *gradient);
  // second (count, n, n): second derivatives of ρ at each of features (count, feature_count) along all pairs
  // of its n directions in feature space (count, n, feature_count); n at most 12. NULL: no Hessian.
  Status (*curve)(const void *self, int count, const double *features, int direction_count,
                  const double *directions, double *second);
  // The same of OVERLAP_GEO_CHUNK pairs side by side, as OverlapGeoBends has them: features with their
  // changes (feature_count, 1 + 12, chunk), second (78, chunk), on cache lines. NULL: curve is used.
  Status (*curve_columns)(const void *self, const double *features, double *second);
} OverlapGeoNetwork;

typedef struct OverlapGeoModel {
  const OverlapGeoFeatureSet *set; // NULL: no network, φ = ln 1.28
  OverlapGeoNetwork network;
  const OverlapGeoBundleKernel *kernel;
  double offset; // ln 1.28 − ρ(f*)
} OverlapGeoModel;

// `network` NULL: the constant. STATUS_INPUT: there is no feature set of that size; else what ρ(f*) fails
// with.
Status overlap_geo_create(OverlapGeoModel *model, const OverlapGeoNetwork *network);

// Evaluates the batch in this thread; a failure is the network's.
Status overlap_geo_eval(const OverlapGeoModel *model, const OverlapBatch *batch);

// What training needs of one pair: features (set->count), ln V₀, and their changes along each of `count`
// directions (count, 24) in the coordinates: (count, set->count) and (count). Only with INSIDE anything is
// written.
OverlapGeoOutcome overlap_geo_features_tangent(const OverlapGeoFeatureSet *set, const double pair[24],
                                               int count, const double *directions, double *features,
                                               double *feature_changes, double *log_volume,
                                               double *log_volume_changes);

#endif

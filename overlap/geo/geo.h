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
// The centroid x̄ is the centre moved within the frame. Let α_k = Σ_m c_m(f) e_mk, with e_mk the features
// that plane k has of its own (features/features.h) and c_m(f) what the network makes of the pair's beside
// ρ. Let z = Σ_k α_k q_k with q_k the rows of Q. A plane's s_k, a barycentric coordinate of a tetrahedron,
// is s_k (1 + q_k·z) at x̄. Hence x̄ goes along with affine maps and any order of planes, and is the centre
// of a simplex at the onset of an overlap. It lies inside of both tetrahedra, since z is shortened where a
// slack would lose 99 % of itself.
//
// The network is anything with the operations below; without one φ = ln 1.28. Pairs too flat for the
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
  // The same of OVERLAP_GEO_CHUNK pairs side by side: features and gradient (feature_count, chunk), outputs
  // (output_count, chunk), on cache lines: ρ and, if more than one is wanted, c. NULL: eval is used.
  Status (*eval_columns)(const void *self, const double *features, int output_count, double *outputs,
                         double *gradient);
  // All outputs (output_count) of one pair's features, and of `count` ≤ 3 seeds (count, output_count) the
  // derivatives of Σ seed · output by the features (count, feature_count). NULL: not.
  Status (*pull)(const void *self, const double *features, int count, const double *seeds, double *outputs,
                 double *slopes);
  // Whether it has the c: eval_columns and 1 + plane_count outputs.
  bool has_centroid;
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
  // V is not the volume but a bound of another model's error: exp ρ V₀ without the onset's part, 0 where the
  // frame cannot be had. No other model is asked. Where that model is blended with clip, the bound fades
  // (overlap/geo/coplanar.h).
  bool is_bound;
  bool is_alone; // pairs with nearly coplanar faces are not blended
} OverlapGeoModel;

// `network` NULL: the constant. STATUS_INPUT: there is no feature set of that size; else what ρ(f*) fails
// with.
Status overlap_geo_create(OverlapGeoModel *model, const OverlapGeoNetwork *network);

// The bound that a network gives: see is_bound.
Status overlap_geo_create_bound(OverlapGeoModel *model, const OverlapGeoNetwork *network);

// Evaluates the batch in this thread; a failure is the network's.
Status overlap_geo_eval(const OverlapGeoModel *model, const OverlapBatch *batch);

// The same, and beside each V what `bound` makes of the same features: bounds (pair_count).
Status overlap_geo_eval_bounded(const OverlapGeoModel *model, const OverlapGeoModel *bound,
                                const OverlapBatch *batch, double *bounds);

// f*, the features (set->count) of the onset P*.
void overlap_geo_features_onset(const OverlapGeoFeatureSet *set, double *features);

// What training the centroid needs of one pair: features (set->count), for the centroid `centroid` its z
// (3) in a frame, and Σ_k e_mk q_k (plane_count, 3) in the same. Only with INSIDE anything is written.
OverlapGeoOutcome overlap_geo_features_centroid(const OverlapGeoFeatureSet *set, const double pair[24],
                                                const double centroid[3], double *features, double z[3],
                                                double (*vectors)[3]);

// What training needs of one pair: features (set->count), ln V₀, and their changes along each of `count`
// directions (count, 24) in the coordinates: (count, set->count) and (count). Only with INSIDE anything is
// written.
OverlapGeoOutcome overlap_geo_features_tangent(const OverlapGeoFeatureSet *set, const double pair[24],
                                               int count, const double *directions, double *features,
                                               double *feature_changes, double *log_volume,
                                               double *log_volume_changes);

#endif

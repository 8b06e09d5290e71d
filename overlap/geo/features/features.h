// SPDX-License-Identifier: Apache-2.0
// Polynomials in the projector P of a pair (geo/frame.h) that no order of its planes changes, hence neither
// that of the vertices nor that of the two tetrahedra. With d_i = P_ii, powers taken entry by entry, and
// links E^bq_ij = Σ_k d_k^q P_ik^b P_jk^b, in this order:
//
//   degrees   Σ_i d_i^k, k = 2 … 5
//   pairs     Σ_ij d_i^a d_j^b P_ij^n, for n = 1 … power_count, a = 0 … 3, b = a … 3; those with a = 0 and
//             n ≤ 2 say nothing new and are left out
//   wedges    Σ_ij d_i^r d_j^s E_ij P_ij^a, for each link, a = 1 … 3, (r, s) = (0, 0), (0, 1), (1, 1);
//             without (0, 0) for b = a = 1, which is a degree
//   squares   Σ_ij E_ij E'_ij P_ij^a, for each link E and each E' up to it, a = 0 … 2
//
// What a plane k has of its own, which another order of the planes only permutes (for the centroid: q_k, a
// row of Q, weighted by them and summed over the planes is a vector of the frame):
//
//   degrees   d_k^a, a = 1 … 4
//   rows      d_k^a Σ_j P_kj^n d_j^b, for n = 1 … 4, b = 0 … 3, a = 0 … 3, a + b ≤ 4; those with
//             b = 0 for n ≤ 2 and a = 0 for n = 1 say nothing new
//   links     Σ_j E_kj P_kj^a d_j^s, for each link, a = 1 … 3, s = 0, 1; without s = 1 for a = 3, and
//             without s = 0 for b = a = 1, which is a row
//
// The derivative of φ(features) by P is found by one backward sweep; its change along a direction by
// differentiating that sweep once more. All of it eight pairs, or eight directions of a pair, at a time.
#ifndef TETLAP_OVERLAP_GEO_FEATURES_FEATURES_H
#define TETLAP_OVERLAP_GEO_FEATURES_FEATURES_H

#include "overlap/geo/constants.h"
#include "overlap/geo/features/pack.h"

// The set with so many features, NULL if there is none: 36: degrees and pairs; 70: wedges too; 100: all; 56
// and 120: as 36 and 100, the pairs up to n = 6 for 4.
#define OVERLAP_GEO_FEATURE_COUNTS "36, 56, 70, 100, 120"
const OverlapGeoFeatureSet *overlap_geo_features_set(int count);

// How many features each plane has.
int overlap_geo_features_plane_count(const OverlapGeoFeatureSet *set);

// The arithmetic, compiled for several instruction sets. All give the same bits.
typedef struct OverlapGeoKernel {
  const char *name;
  // Features of P (count).
  void (*features)(const OverlapGeoFeatureSet *set, const GeoSymmetric *projector,
                   OverlapGeoInvariants *invariants, GeoPack *features);
  // Those of each plane: (plane_count, GEO_LANES).
  void (*planes)(const OverlapGeoFeatureSet *set, const OverlapGeoInvariants *invariants,
                 GeoPack (*planes)[GEO_LANES]);
  // The change of the features (count) along a change of P; `change` gets that of the invariants.
  void (*push)(const OverlapGeoFeatureSet *set, const OverlapGeoInvariants *invariants,
               const GeoSymmetric *projector_change, OverlapGeoInvariants *change, GeoPack *features_change);
  // The change of those of each plane (plane_count, GEO_LANES) along that of the invariants.
  void (*push_planes)(const OverlapGeoFeatureSet *set, const OverlapGeoInvariants *invariants,
                      const OverlapGeoInvariants *change, GeoPack (*planes_change)[GEO_LANES]);
  // Φ = ∂φ/∂P, the derivative by P_ij and by P_ji, for ∂φ/∂features = `weights` (count).
  void (*pull)(const OverlapGeoFeatureSet *set, const OverlapGeoInvariants *invariants,
               const GeoPack *weights, OverlapGeoSweep *sweep, GeoSymmetric *slope);
  // The change of Φ along the direction of `change`, the weights held fixed; after a pull with the same.
  void (*bend)(const OverlapGeoFeatureSet *set, const OverlapGeoInvariants *invariants,
               const GeoPack *weights, const OverlapGeoSweep *sweep, const OverlapGeoInvariants *change,
               GeoSymmetric *slope_change);
} OverlapGeoKernel;

// The fastest that this processor has.
const OverlapGeoKernel *overlap_geo_features_kernel(void);
// All that it has, the portable one first.
const OverlapGeoKernel *const *overlap_geo_features_kernels(int *count);

extern const OverlapGeoKernel overlap_geo_features_kernel_portable;
#if defined(__x86_64__)
extern const OverlapGeoKernel overlap_geo_features_kernel_avx512;
#endif

#endif

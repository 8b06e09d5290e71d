// SPDX-License-Identifier: Apache-2.0
// What features are made of, in packs (pack.h). Its text is also part of what a device compiles: it includes
// nothing.
#ifndef TETLAP_OVERLAP_GEO_FEATURES_INVARIANTS_H
#define TETLAP_OVERLAP_GEO_FEATURES_INVARIANTS_H

enum { GEO_ENTRIES = 36 };

// The entries of a symmetric 8 × 8 matrix in each lane: the diagonal, then the rows below it.
typedef struct GeoSymmetric {
  GeoPack at[GEO_ENTRIES];
} GeoSymmetric;

static inline int geo_entry(int i, int j) {
  return i == j ? i : i > j ? GEO_LANES + i * (i - 1) / 2 + j : GEO_LANES + j * (j - 1) / 2 + i;
}

enum {
  OVERLAP_GEO_MAX_FEATURES = 128,
  OVERLAP_GEO_MAX_POWER = 6, // of P
  OVERLAP_GEO_MAX_LINKS = 4,
  OVERLAP_GEO_DEGREES = 6,      // d⁰ … d⁵
  OVERLAP_GEO_MIXED = 4,        // d⁰ … d³
  OVERLAP_GEO_WEDGE_POWER = 3,  // of P in wedges
  OVERLAP_GEO_SQUARE_POWER = 2, // of P in squares
  OVERLAP_GEO_PLANE_DEGREE = 4, // of d in the features of a plane
  OVERLAP_GEO_PLANE_POWER = 4,  // of P in them
  OVERLAP_GEO_MAX_PLANE_FEATURES = 64,
};

typedef struct OverlapGeoFeatureSet {
  const char *name;
  int count;       // of features
  int power_count; // highest n of the pairs, at least OVERLAP_GEO_PLANE_POWER
  int link_count;  // OVERLAP_GEO_MAX_LINKS; 0: neither wedges nor squares
  struct {
    int power;  // b: 1 or 2
    int degree; // q: 0 … 3
  } links[OVERLAP_GEO_MAX_LINKS];
  bool has_squares;
} OverlapGeoFeatureSet;

// Everything that the features of one P are sums of; also the change of all that along a direction.
typedef struct OverlapGeoInvariants {
  GeoSymmetric power[OVERLAP_GEO_MAX_POWER + 1];                        // P^n, n ≥ 1
  GeoPack degree[OVERLAP_GEO_DEGREES][GEO_LANES];                       // d^a
  GeoPack row[OVERLAP_GEO_MAX_POWER + 1][OVERLAP_GEO_MIXED][GEO_LANES]; // Σ_j P_ij^n d_j^b
  GeoSymmetric link[OVERLAP_GEO_MAX_LINKS];                             // E
} OverlapGeoInvariants;

typedef struct OverlapGeoMixed {
  GeoPack at[OVERLAP_GEO_MIXED][GEO_LANES];
} OverlapGeoMixed;

// What the backward sweep leaves for its own derivative.
typedef struct OverlapGeoSweep {
  OverlapGeoMixed pairs[OVERLAP_GEO_MAX_POWER + 1];         // c_b,i: Σ_b c_b,i d_j^b times P_ij^n
  GeoPack degree[OVERLAP_GEO_DEGREES][GEO_LANES];           // ∂φ/∂(d^a)
  GeoSymmetric link[OVERLAP_GEO_MAX_LINKS];                 // ∂φ/∂E
  GeoPack fan[OVERLAP_GEO_MAX_LINKS][GEO_LANES][GEO_LANES]; // that times P^b
} OverlapGeoSweep;

#endif

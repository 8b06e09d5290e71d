// SPDX-License-Identifier: GPL-3.0-or-later
// Polynomials in the projector P of a pair (geo_frame.h) that no order of its planes changes, hence neither
// that of the vertices nor that of the two tetrahedra. With d_i = P_ii, powers taken entry by entry, and
// links E^bq_ij = Σ_k d_k^q P_ik^b P_jk^b, in this order:
//
//   degrees   Σ_i d_i^k, k = 2 … 5
//   pairs     Σ_ij d_i^a d_j^b P_ij^n, for n = 1 … power_count, a = 0 … 3, b = a … 3; those with a = 0 and
//             n ≤ 2 say nothing new and are left out
//   wedges    Σ_ij d_i^r d_j^s E_ij P_ij^a, for each link, a = 1 … wedge_power, (r, s) = (0, 0), (0, 1),
//             (1, 1); without (0, 0) for b = a = 1, which is a degree
//   squares   Σ_ij E_ij E'_ij P_ij^a, for each link E and each E' up to it, a = 0 … square_power
//
// The derivative of φ(features) by P is found by one backward sweep; its change along a direction by
// differentiating that sweep once more.
#ifndef TETLAP_CONTACT_GEO_FEATURES_H
#define TETLAP_CONTACT_GEO_FEATURES_H

#include <stdbool.h>

#include "contact/geo_lanes.h"

enum {
  CONTACT_GEO_MAX_FEATURES = 256,
  CONTACT_GEO_MAX_POWER = 6, // of P
  CONTACT_GEO_MAX_LINKS = 6,
  CONTACT_GEO_DEGREES = 6, // d⁰ … d⁵
  CONTACT_GEO_MIXED = 4,   // d⁰ … d³
};

typedef struct ContactGeoFeatureSet {
  const char *name;
  int count;       // of features
  int power_count; // highest n of the pairs
  int link_count;  // 0: neither wedges nor squares
  struct {
    int power;  // b, 1 or 2
    int degree; // q, 1 … 3
  } links[CONTACT_GEO_MAX_LINKS];
  int wedge_power;  // at most 3
  int square_power; // at most 2; −1: no squares
} ContactGeoFeatureSet;

// The set with so many features (36: degrees and pairs; 70: wedges too; 100: all), NULL if there is none.
const ContactGeoFeatureSet *contact_geo_feature_set(int count);

// First a of the pairs with that n, and whether a link's wedges with that a include (r, s) = (0, 0).
static inline int contact_geo_first_degree(int n) {
  return n <= 2;
}
static inline bool contact_geo_has_plain_wedge(const ContactGeoFeatureSet *set, int link, int a) {
  return a > 1 || set->links[link].power > 1;
}

// Everything that the features of one P are sums of; also the change of all that along a direction.
typedef struct ContactGeoInvariants {
  GeoMatrix power[CONTACT_GEO_MAX_POWER + 1];                          // P^n, n ≥ 1
  double degree[CONTACT_GEO_DEGREES][GEO_LANES];                       // d^a
  double row[CONTACT_GEO_MAX_POWER + 1][CONTACT_GEO_MIXED][GEO_LANES]; // Σ_j P_ij^n d_j^b
  GeoMatrix mean, product;                                             // (d_i + d_j)/2, d_i d_j
  GeoMatrix link[CONTACT_GEO_MAX_LINKS];                               // E
} ContactGeoInvariants;

// Features of P (count).
void contact_geo_features(const ContactGeoFeatureSet *set, const GeoMatrix *projector,
                          ContactGeoInvariants *invariants, double *features);

// Their change (count) along a symmetric change of P; `change` gets that of the invariants.
void contact_geo_features_push(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                               const GeoMatrix *projector_change, ContactGeoInvariants *change,
                               double *features_change);

// What the backward sweep leaves for its own derivative. φ̄ below: derivatives of φ.
typedef struct ContactGeoSweep {
  double pairs[CONTACT_GEO_MAX_POWER + 1][CONTACT_GEO_MIXED]
              [GEO_LANES];                       // c^n_b,i: Σ_b c_b,i d_j^b beside P_ij^n
  double degree[CONTACT_GEO_DEGREES][GEO_LANES]; // φ̄ of d^a
  GeoMatrix link[CONTACT_GEO_MAX_LINKS];         // φ̄ of E
  GeoMatrix fan[CONTACT_GEO_MAX_LINKS];          // that times P^b
} ContactGeoSweep;

// Φ = ∂φ/∂P, symmetric, for ∂φ/∂features = `weights` (count).
void contact_geo_features_pull(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                               const double *weights, ContactGeoSweep *sweep, GeoMatrix *slope);

// The change of Φ along the direction of `change`, the weights held fixed; after a pull with the same
// weights.
void contact_geo_features_bend(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                               const double *weights, const ContactGeoSweep *sweep,
                               const ContactGeoInvariants *change, GeoMatrix *slope_change);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Features forward, and their change along a direction, each function beside its differential.
#include "contact/geo_features.h"

#include <stddef.h>
#include <string.h>

static const ContactGeoFeatureSet sets[] = {
    {.name = "pairs", .count = 36, .power_count = 4, .square_power = -1},
    {.name = "wedges",
     .count = 70,
     .power_count = 4,
     .link_count = 4,
     .links = {{1, 1}, {2, 0}, {1, 2}, {2, 1}},
     .wedge_power = 3,
     .square_power = -1},
    {.name = "squares",
     .count = 100,
     .power_count = 4,
     .link_count = 4,
     .links = {{1, 1}, {2, 0}, {1, 2}, {2, 1}},
     .wedge_power = 3,
     .square_power = 2},
};

const ContactGeoFeatureSet *contact_geo_feature_set(int count) {
  for (size_t s = 0; s < sizeof sets / sizeof *sets; s++)
    if (sets[s].count == count) return &sets[s];
  return NULL;
}

// Σ_ij a_ij b_ij
static inline double contract(const GeoMatrix *a, const GeoMatrix *b) {
  double sum[GEO_LANES] = {0};
  for (int i = 0; i < GEO_LANES; i++)
    for (int j = 0; j < GEO_LANES; j++) sum[j] += a->row[i][j] * b->row[i][j];
  return geo_sum(sum);
}

static inline double total(const GeoMatrix *a) {
  double sum[GEO_LANES] = {0};
  for (int i = 0; i < GEO_LANES; i++) geo_add(sum, 1, a->row[i]);
  return geo_sum(sum);
}

// c = a ∘ b, entry by entry.
static inline void combine(const GeoMatrix *a, const GeoMatrix *b, GeoMatrix *c) {
  for (int i = 0; i < GEO_LANES; i++)
    for (int j = 0; j < GEO_LANES; j++) c->row[i][j] = a->row[i][j] * b->row[i][j];
}

// c += a ∘ b
static inline void combine_add(const GeoMatrix *a, const GeoMatrix *b, GeoMatrix *c) {
  for (int i = 0; i < GEO_LANES; i++)
    for (int j = 0; j < GEO_LANES; j++) c->row[i][j] += a->row[i][j] * b->row[i][j];
}

// y += a x, a symmetric.
static inline void apply_add(const GeoMatrix *a, const double x[GEO_LANES], double y[GEO_LANES]) {
  for (int i = 0; i < GEO_LANES; i++) geo_add(y, x[i], a->row[i]);
}

static int highest_power(const ContactGeoFeatureSet *set) {
  return set->link_count > 0 && set->wedge_power > set->power_count ? set->wedge_power : set->power_count;
}

static void fill_powers(const ContactGeoFeatureSet *set, const GeoMatrix *projector,
                        ContactGeoInvariants *invariants) {
  invariants->power[1] = *projector;
  for (int n = 2; n <= highest_power(set); n++)
    combine(&invariants->power[n - 1], projector, &invariants->power[n]);
  double(*degree)[GEO_LANES] = invariants->degree;
  for (int i = 0; i < GEO_LANES; i++) {
    degree[0][i] = 1;
    degree[1][i] = projector->row[i][i];
  }
  for (int a = 2; a < CONTACT_GEO_DEGREES; a++)
    for (int i = 0; i < GEO_LANES; i++) degree[a][i] = degree[a - 1][i] * degree[1][i];
}

static void change_powers(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                          const GeoMatrix *projector_change, ContactGeoInvariants *change) {
  change->power[1] = *projector_change;
  for (int n = 2; n <= highest_power(set); n++)
    for (int i = 0; i < GEO_LANES; i++)
      for (int j = 0; j < GEO_LANES; j++)
        change->power[n].row[i][j] = n * invariants->power[n - 1].row[i][j] * projector_change->row[i][j];
  for (int i = 0; i < GEO_LANES; i++) {
    change->degree[0][i] = 0;
    change->degree[1][i] = projector_change->row[i][i];
  }
  for (int a = 2; a < CONTACT_GEO_DEGREES; a++)
    for (int i = 0; i < GEO_LANES; i++)
      change->degree[a][i] = a * invariants->degree[a - 1][i] * change->degree[1][i];
}

static void fill_rows(const ContactGeoFeatureSet *set, ContactGeoInvariants *invariants) {
  for (int n = 1; n <= set->power_count; n++)
    for (int b = 0; b < CONTACT_GEO_MIXED; b++) {
      double sum[GEO_LANES] = {0};
      apply_add(&invariants->power[n], invariants->degree[b], sum);
      memcpy(invariants->row[n][b], sum, sizeof sum);
    }
}

static void change_rows(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                        ContactGeoInvariants *change) {
  for (int n = 1; n <= set->power_count; n++)
    for (int b = 0; b < CONTACT_GEO_MIXED; b++) {
      double sum[GEO_LANES] = {0};
      apply_add(&change->power[n], invariants->degree[b], sum);
      if (b > 0) apply_add(&invariants->power[n], change->degree[b], sum);
      memcpy(change->row[n][b], sum, sizeof sum);
    }
}

static void fill_links(const ContactGeoFeatureSet *set, ContactGeoInvariants *invariants) {
  const double *d = invariants->degree[1];
  for (int i = 0; i < GEO_LANES; i++)
    for (int j = 0; j < GEO_LANES; j++) {
      invariants->mean.row[i][j] = (d[i] + d[j]) / 2;
      invariants->product.row[i][j] = d[i] * d[j];
    }
  for (int e = 0; e < set->link_count; e++) {
    const GeoMatrix *spoke = &invariants->power[set->links[e].power];
    const double *weight = invariants->degree[set->links[e].degree];
    for (int i = 0; i < GEO_LANES; i++) {
      double sum[GEO_LANES] = {0};
      for (int k = 0; k < GEO_LANES; k++) geo_add(sum, weight[k] * spoke->row[i][k], spoke->row[k]);
      memcpy(invariants->link[e].row[i], sum, sizeof sum);
    }
  }
}

static void change_links(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                         ContactGeoInvariants *change) {
  const double *d = invariants->degree[1], *moved = change->degree[1];
  for (int i = 0; i < GEO_LANES; i++)
    for (int j = 0; j < GEO_LANES; j++) {
      change->mean.row[i][j] = (moved[i] + moved[j]) / 2;
      change->product.row[i][j] = moved[i] * d[j] + d[i] * moved[j];
    }
  for (int e = 0; e < set->link_count; e++) {
    int b = set->links[e].power, q = set->links[e].degree;
    const GeoMatrix *spoke = &invariants->power[b], *spoke_change = &change->power[b];
    const double *weight = invariants->degree[q], *weight_change = change->degree[q];
    GeoMatrix half; // half of the change is the transpose of the other half
    for (int i = 0; i < GEO_LANES; i++) {
      double sum[GEO_LANES] = {0};
      for (int k = 0; k < GEO_LANES; k++)
        geo_add(sum, weight[k] * spoke_change->row[i][k] + weight_change[k] / 2 * spoke->row[i][k],
                spoke->row[k]);
      memcpy(half.row[i], sum, sizeof sum);
    }
    for (int i = 0; i < GEO_LANES; i++)
      for (int j = 0; j < GEO_LANES; j++) change->link[e].row[i][j] = half.row[i][j] + half.row[j][i];
  }
}

static double *list_pairs(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                          double *next) {
  for (int k = 2; k < CONTACT_GEO_DEGREES; k++) *next++ = geo_sum(invariants->degree[k]);
  for (int n = 1; n <= set->power_count; n++)
    for (int a = contact_geo_first_degree(n); a < CONTACT_GEO_MIXED; a++)
      for (int b = a; b < CONTACT_GEO_MIXED; b++)
        *next++ = geo_dot(invariants->degree[a], invariants->row[n][b]);
  return next;
}

static double *list_pairs_change(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                                 const ContactGeoInvariants *change, double *next) {
  for (int k = 2; k < CONTACT_GEO_DEGREES; k++) *next++ = geo_sum(change->degree[k]);
  for (int n = 1; n <= set->power_count; n++)
    for (int a = contact_geo_first_degree(n); a < CONTACT_GEO_MIXED; a++)
      for (int b = a; b < CONTACT_GEO_MIXED; b++)
        *next++ = geo_dot(change->degree[a], invariants->row[n][b]) +
                  geo_dot(invariants->degree[a], change->row[n][b]);
  return next;
}

static double *list_wedges(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                           double *next) {
  for (int e = 0; e < set->link_count; e++)
    for (int a = 1; a <= set->wedge_power; a++) {
      GeoMatrix wedge;
      combine(&invariants->link[e], &invariants->power[a], &wedge);
      if (contact_geo_has_plain_wedge(set, e, a)) *next++ = total(&wedge);
      *next++ = contract(&wedge, &invariants->mean);
      *next++ = contract(&wedge, &invariants->product);
    }
  return next;
}

static double *list_wedges_change(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                                  const ContactGeoInvariants *change, double *next) {
  for (int e = 0; e < set->link_count; e++)
    for (int a = 1; a <= set->wedge_power; a++) {
      GeoMatrix wedge, wedge_change;
      combine(&invariants->link[e], &invariants->power[a], &wedge);
      combine(&change->link[e], &invariants->power[a], &wedge_change);
      combine_add(&invariants->link[e], &change->power[a], &wedge_change);
      if (contact_geo_has_plain_wedge(set, e, a)) *next++ = total(&wedge_change);
      *next++ = contract(&wedge_change, &invariants->mean) + contract(&wedge, &change->mean);
      *next++ = contract(&wedge_change, &invariants->product) + contract(&wedge, &change->product);
    }
  return next;
}

static double *list_squares(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                            double *next) {
  for (int e = 0; e < set->link_count; e++)
    for (int g = 0; g <= e && set->square_power >= 0; g++) {
      GeoMatrix square;
      combine(&invariants->link[e], &invariants->link[g], &square);
      *next++ = total(&square);
      for (int a = 1; a <= set->square_power; a++) *next++ = contract(&square, &invariants->power[a]);
    }
  return next;
}

static double *list_squares_change(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                                   const ContactGeoInvariants *change, double *next) {
  for (int e = 0; e < set->link_count; e++)
    for (int g = 0; g <= e && set->square_power >= 0; g++) {
      GeoMatrix square, square_change;
      combine(&invariants->link[e], &invariants->link[g], &square);
      combine(&change->link[e], &invariants->link[g], &square_change);
      combine_add(&invariants->link[e], &change->link[g], &square_change);
      *next++ = total(&square_change);
      for (int a = 1; a <= set->square_power; a++)
        *next++ = contract(&square_change, &invariants->power[a]) + contract(&square, &change->power[a]);
    }
  return next;
}

void contact_geo_features(const ContactGeoFeatureSet *set, const GeoMatrix *projector,
                          ContactGeoInvariants *invariants, double *features) {
  fill_powers(set, projector, invariants);
  fill_rows(set, invariants);
  features = list_pairs(set, invariants, features);
  if (set->link_count == 0) return;
  fill_links(set, invariants);
  features = list_wedges(set, invariants, features);
  list_squares(set, invariants, features);
}

void contact_geo_features_push(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                               const GeoMatrix *projector_change, ContactGeoInvariants *change,
                               double *features_change) {
  change_powers(set, invariants, projector_change, change);
  change_rows(set, invariants, change);
  features_change = list_pairs_change(set, invariants, change, features_change);
  if (set->link_count == 0) return;
  change_links(set, invariants, change);
  features_change = list_wedges_change(set, invariants, change, features_change);
  list_squares_change(set, invariants, change, features_change);
}

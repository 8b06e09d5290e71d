// SPDX-License-Identifier: GPL-3.0-or-later
// The backward sweep through the features, and the differential of that sweep. In both, what has been found
// of Φ is not symmetric until the end, where its symmetric part is taken.
#include <string.h>

#include "contact/geo_features.h"

// Weights of a polynomial in P_ij and its first three derivatives there.
typedef struct Polynomial {
  double weight[4];
} Polynomial;

static inline double value(const Polynomial *w, double p) {
  return w->weight[0] + p * (w->weight[1] + p * (w->weight[2] + p * w->weight[3]));
}
static inline double first(const Polynomial *w, double p) {
  return w->weight[1] + p * (2 * w->weight[2] + p * (3 * w->weight[3]));
}
static inline double second(const Polynomial *w, double p) {
  return 2 * w->weight[2] + p * (6 * w->weight[3]);
}

// The wedges of one link, for (r, s) = (0, 0), (0, 1), (1, 1).
typedef struct WedgeWeights {
  Polynomial plain, mean, product;
} WedgeWeights;

static const double *read_wedges(const ContactGeoFeatureSet *set, int link, const double *next,
                                 WedgeWeights *wedge) {
  memset(wedge, 0, sizeof *wedge);
  for (int a = 1; a <= set->wedge_power; a++) {
    if (contact_geo_has_plain_wedge(set, link, a)) wedge->plain.weight[a] = *next++;
    wedge->mean.weight[a] = *next++;
    wedge->product.weight[a] = *next++;
  }
  return next;
}

static const double *read_square(const ContactGeoFeatureSet *set, const double *next, Polynomial *square) {
  memset(square, 0, sizeof *square);
  for (int a = 0; a <= set->square_power; a++) square->weight[a] = *next++;
  return next;
}

static const double *pull_pairs(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                                const double *next, ContactGeoSweep *sweep, GeoMatrix *slope) {
  memset(sweep->pairs, 0, sizeof sweep->pairs);
  for (int k = 2; k < CONTACT_GEO_DEGREES; k++, next++)
    for (int i = 0; i < GEO_LANES; i++) sweep->degree[k][i] += *next;
  for (int n = 1; n <= set->power_count; n++) {
    for (int a = contact_geo_first_degree(n); a < CONTACT_GEO_MIXED; a++)
      for (int b = a; b < CONTACT_GEO_MIXED; b++, next++) {
        geo_add(sweep->pairs[n][b], *next, invariants->degree[a]);
        geo_add(sweep->degree[a], *next, invariants->row[n][b]);
        geo_add(sweep->degree[b], *next, invariants->row[n][a]);
      }
    for (int i = 0; i < GEO_LANES; i++) {
      double beside[GEO_LANES] = {0};
      for (int b = 0; b < CONTACT_GEO_MIXED; b++)
        geo_add(beside, n * sweep->pairs[n][b][i], invariants->degree[b]);
      for (int j = 0; j < GEO_LANES; j++)
        slope->row[i][j] += n > 1 ? invariants->power[n - 1].row[i][j] * beside[j] : beside[j];
    }
  }
  return next;
}

static const double *bend_pairs(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                                const double *next, const ContactGeoSweep *sweep,
                                const ContactGeoInvariants *change, double degree[][GEO_LANES],
                                GeoMatrix *slope) {
  next += CONTACT_GEO_DEGREES - 2;
  for (int n = 1; n <= set->power_count; n++) {
    double pairs[CONTACT_GEO_MIXED][GEO_LANES] = {{0}};
    for (int a = contact_geo_first_degree(n); a < CONTACT_GEO_MIXED; a++)
      for (int b = a; b < CONTACT_GEO_MIXED; b++, next++) {
        geo_add(pairs[b], *next, change->degree[a]);
        geo_add(degree[a], *next, change->row[n][b]);
        geo_add(degree[b], *next, change->row[n][a]);
      }
    for (int i = 0; i < GEO_LANES; i++) {
      double beside[GEO_LANES] = {0}, beside_change[GEO_LANES] = {0};
      for (int b = 0; b < CONTACT_GEO_MIXED; b++) {
        geo_add(beside, n * sweep->pairs[n][b][i], invariants->degree[b]);
        geo_add(beside_change, n * pairs[b][i], invariants->degree[b]);
        geo_add(beside_change, n * sweep->pairs[n][b][i], change->degree[b]);
      }
      for (int j = 0; j < GEO_LANES; j++)
        slope->row[i][j] += n > 1 ? change->power[n - 1].row[i][j] * beside[j] +
                                        invariants->power[n - 1].row[i][j] * beside_change[j]
                                  : beside_change[j];
    }
  }
  return next;
}

// Adds to the derivatives by the degrees what comes through (d_i + d_j)/2 and d_i d_j.
static void pull_means(const ContactGeoInvariants *invariants, const GeoMatrix *mean,
                       const GeoMatrix *product, double degree[GEO_LANES]) {
  for (int i = 0; i < GEO_LANES; i++) {
    geo_add(degree, 1, mean->row[i]);
    geo_add(degree, 2 * invariants->degree[1][i], product->row[i]);
  }
}

static const double *pull_wedges(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                                 const double *next, ContactGeoSweep *sweep, GeoMatrix *slope) {
  GeoMatrix mean, product;
  memset(&mean, 0, sizeof mean);
  memset(&product, 0, sizeof product);
  for (int e = 0; e < set->link_count; e++) {
    WedgeWeights w;
    next = read_wedges(set, e, next, &w);
    for (int i = 0; i < GEO_LANES; i++)
      for (int j = 0; j < GEO_LANES; j++) {
        double p = invariants->power[1].row[i][j], link = invariants->link[e].row[i][j];
        double m = invariants->mean.row[i][j], d = invariants->product.row[i][j];
        double of_mean = value(&w.mean, p), of_product = value(&w.product, p);
        mean.row[i][j] += of_mean * link;
        product.row[i][j] += of_product * link;
        sweep->link[e].row[i][j] = value(&w.plain, p) + of_mean * m + of_product * d;
        slope->row[i][j] += (first(&w.plain, p) + first(&w.mean, p) * m + first(&w.product, p) * d) * link;
      }
  }
  pull_means(invariants, &mean, &product, sweep->degree[1]);
  return next;
}

static const double *bend_wedges(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                                 const double *next, const ContactGeoInvariants *change,
                                 double degree[][GEO_LANES], GeoMatrix *link_change, GeoMatrix *slope) {
  GeoMatrix mean, product, product_change; // φ̄ of product itself is needed: it meets δd
  memset(&mean, 0, sizeof mean);
  memset(&product, 0, sizeof product);
  memset(&product_change, 0, sizeof product_change);
  for (int e = 0; e < set->link_count; e++) {
    WedgeWeights w;
    next = read_wedges(set, e, next, &w);
    for (int i = 0; i < GEO_LANES; i++)
      for (int j = 0; j < GEO_LANES; j++) {
        double p = invariants->power[1].row[i][j], dp = change->power[1].row[i][j];
        double link = invariants->link[e].row[i][j], dlink = change->link[e].row[i][j];
        double m = invariants->mean.row[i][j], dm = change->mean.row[i][j];
        double d = invariants->product.row[i][j], dd = change->product.row[i][j];
        double of_mean = value(&w.mean, p), of_product = value(&w.product, p);
        double mean_first = first(&w.mean, p), product_first = first(&w.product, p);
        double all_first = first(&w.plain, p) + mean_first * m + product_first * d;
        double all_second = second(&w.plain, p) + second(&w.mean, p) * m + second(&w.product, p) * d;
        mean.row[i][j] += mean_first * dp * link + of_mean * dlink;
        product.row[i][j] += of_product * link;
        product_change.row[i][j] += product_first * dp * link + of_product * dlink;
        link_change[e].row[i][j] = all_first * dp + of_mean * dm + of_product * dd;
        slope->row[i][j] +=
            (all_second * dp + mean_first * dm + product_first * dd) * link + all_first * dlink;
      }
  }
  pull_means(invariants, &mean, &product_change, degree[1]);
  for (int i = 0; i < GEO_LANES; i++) geo_add(degree[1], 2 * change->degree[1][i], product.row[i]);
  return next;
}

static void pull_squares(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                         const double *next, ContactGeoSweep *sweep, GeoMatrix *slope) {
  for (int e = 0; e < set->link_count; e++)
    for (int g = 0; g <= e && set->square_power >= 0; g++) {
      Polynomial w;
      next = read_square(set, next, &w);
      const GeoMatrix *a = &invariants->link[e], *b = &invariants->link[g];
      GeoMatrix *a_bar = &sweep->link[e], *b_bar = &sweep->link[g];
      for (int i = 0; i < GEO_LANES; i++)
        for (int j = 0; j < GEO_LANES; j++) {
          double p = invariants->power[1].row[i][j], weight = value(&w, p);
          slope->row[i][j] += first(&w, p) * a->row[i][j] * b->row[i][j];
          a_bar->row[i][j] += weight * b->row[i][j];
          b_bar->row[i][j] += weight * a->row[i][j];
        }
    }
}

static void bend_squares(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                         const double *next, const ContactGeoInvariants *change, GeoMatrix *link_change,
                         GeoMatrix *slope) {
  for (int e = 0; e < set->link_count; e++)
    for (int g = 0; g <= e && set->square_power >= 0; g++) {
      Polynomial w;
      next = read_square(set, next, &w);
      const GeoMatrix *a = &invariants->link[e], *b = &invariants->link[g];
      const GeoMatrix *da = &change->link[e], *db = &change->link[g];
      GeoMatrix *a_bar = &link_change[e], *b_bar = &link_change[g];
      for (int i = 0; i < GEO_LANES; i++)
        for (int j = 0; j < GEO_LANES; j++) {
          double p = invariants->power[1].row[i][j], dp = change->power[1].row[i][j];
          double weight = value(&w, p), weight_first = first(&w, p);
          slope->row[i][j] += second(&w, p) * dp * a->row[i][j] * b->row[i][j] +
                              weight_first * (da->row[i][j] * b->row[i][j] + a->row[i][j] * db->row[i][j]);
          a_bar->row[i][j] += weight_first * dp * b->row[i][j] + weight * db->row[i][j];
          b_bar->row[i][j] += weight_first * dp * a->row[i][j] + weight * da->row[i][j];
        }
    }
}

// c += a b
static inline void multiply_add(const GeoMatrix *a, const GeoMatrix *b, GeoMatrix *c) {
  for (int i = 0; i < GEO_LANES; i++)
    for (int k = 0; k < GEO_LANES; k++) geo_add(c->row[i], a->row[i][k], b->row[k]);
}

// E = B diag(w) B with B = P^b, w = d^q: B̄ = 2 Ē B diag(w), w̄ = diag(B Ē B).
static void pull_links(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                       ContactGeoSweep *sweep, GeoMatrix *slope) {
  for (int e = 0; e < set->link_count; e++) {
    int b = set->links[e].power, q = set->links[e].degree;
    const GeoMatrix *spoke = &invariants->power[b];
    const double *weight = invariants->degree[q];
    GeoMatrix *fan = &sweep->fan[e];
    memset(fan, 0, sizeof *fan);
    multiply_add(&sweep->link[e], spoke, fan);
    for (int i = 0; i < GEO_LANES; i++)
      for (int j = 0; j < GEO_LANES; j++) {
        double outer = b > 1 ? b * invariants->power[b - 1].row[i][j] : 1;
        slope->row[i][j] += 2 * outer * fan->row[i][j] * weight[j];
        sweep->degree[q][j] += spoke->row[i][j] * fan->row[i][j];
      }
  }
}

static void bend_links(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                       const ContactGeoSweep *sweep, const ContactGeoInvariants *change,
                       const GeoMatrix *link_change, double degree[][GEO_LANES], GeoMatrix *slope) {
  for (int e = 0; e < set->link_count; e++) {
    int b = set->links[e].power, q = set->links[e].degree;
    const GeoMatrix *spoke = &invariants->power[b], *spoke_change = &change->power[b];
    const double *weight = invariants->degree[q], *weight_change = change->degree[q];
    const GeoMatrix *fan = &sweep->fan[e];
    GeoMatrix fan_change;
    memset(&fan_change, 0, sizeof fan_change);
    multiply_add(&link_change[e], spoke, &fan_change);
    multiply_add(&sweep->link[e], spoke_change, &fan_change);
    for (int i = 0; i < GEO_LANES; i++)
      for (int j = 0; j < GEO_LANES; j++) {
        double outer = b > 1 ? b * invariants->power[b - 1].row[i][j] : 1;
        double outer_change = b > 1 ? b * change->power[b - 1].row[i][j] : 0;
        slope->row[i][j] +=
            2 * outer_change * fan->row[i][j] * weight[j] +
            2 * outer * (fan_change.row[i][j] * weight[j] + fan->row[i][j] * weight_change[j]);
        degree[q][j] += spoke_change->row[i][j] * fan->row[i][j] + spoke->row[i][j] * fan_change.row[i][j];
      }
  }
}

// Replaces Φ by its symmetric part and adds what comes through the degrees to its diagonal.
static void finish(const double diagonal[GEO_LANES], GeoMatrix *slope) {
  for (int i = 0; i < GEO_LANES; i++) {
    for (int j = 0; j < i; j++) {
      double mean = (slope->row[i][j] + slope->row[j][i]) / 2;
      slope->row[i][j] = slope->row[j][i] = mean;
    }
    slope->row[i][i] += diagonal[i];
  }
}

void contact_geo_features_pull(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                               const double *weights, ContactGeoSweep *sweep, GeoMatrix *slope) {
  memset(sweep->degree, 0, sizeof sweep->degree);
  memset(slope, 0, sizeof *slope);
  weights = pull_pairs(set, invariants, weights, sweep, slope);
  if (set->link_count > 0) {
    weights = pull_wedges(set, invariants, weights, sweep, slope);
    pull_squares(set, invariants, weights, sweep, slope);
    pull_links(set, invariants, sweep, slope);
  }
  double diagonal[GEO_LANES] = {0};
  for (int a = 1; a < CONTACT_GEO_DEGREES; a++)
    for (int i = 0; i < GEO_LANES; i++) diagonal[i] += a * invariants->degree[a - 1][i] * sweep->degree[a][i];
  finish(diagonal, slope);
}

void contact_geo_features_bend(const ContactGeoFeatureSet *set, const ContactGeoInvariants *invariants,
                               const double *weights, const ContactGeoSweep *sweep,
                               const ContactGeoInvariants *change, GeoMatrix *slope_change) {
  double degree[CONTACT_GEO_DEGREES][GEO_LANES] = {{0}}; // change of φ̄ of d^a
  memset(slope_change, 0, sizeof *slope_change);
  weights = bend_pairs(set, invariants, weights, sweep, change, degree, slope_change);
  if (set->link_count > 0) {
    GeoMatrix link_change[CONTACT_GEO_MAX_LINKS];
    weights = bend_wedges(set, invariants, weights, change, degree, link_change, slope_change);
    bend_squares(set, invariants, weights, change, link_change, slope_change);
    bend_links(set, invariants, sweep, change, link_change, degree, slope_change);
  }
  double diagonal[GEO_LANES] = {0};
  for (int a = 1; a < CONTACT_GEO_DEGREES; a++)
    for (int i = 0; i < GEO_LANES; i++)
      diagonal[i] +=
          a * (change->degree[a - 1][i] * sweep->degree[a][i] + invariants->degree[a - 1][i] * degree[a][i]);
  finish(diagonal, slope_change);
}

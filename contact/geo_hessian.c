// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/geo_hessian.h"

#include <math.h>
#include <string.h>

enum { SIZE = CONTACT_PAIR_SIZE, HALF = CONTACT_GEO_DIRECTIONS };

// The largest coordinate of a vertex of tetrahedron t in the other.
static double reach(const ContactGeoFrame *frame, int t) {
  double bound = 0;
  for (int v = 0; v < 4; v++)
    for (int k = 0; k < 4; k++) bound = fmax(bound, fabs(frame->across[t][v][k]));
  return bound;
}

// A pair in every lane, swept backward.
typedef struct Spread {
  ContactGeoInvariants invariants;
  ContactGeoSweep sweep;
  GeoPack weights[CONTACT_GEO_MAX_FEATURES];
} Spread;

static void spread_out(const ContactGeoModel *model, const GeoMatrix *projector, const double *weights,
                       Spread *spread) {
  GeoSymmetric packed, slope;
  GeoPack features[CONTACT_GEO_MAX_FEATURES];
  for (int lane = 0; lane < GEO_PACK; lane++) {
    geo_pack_matrix(projector, lane, &packed);
    geo_pack_numbers(weights, model->set->count, lane, spread->weights);
  }
  model->kernel->features(model->set, &packed, &spread->invariants, features);
  model->kernel->pull(model->set, &spread->invariants, spread->weights, &spread->sweep, &slope);
}

// The changes of Φ and of the features along up to a pack of directions.
static void bend_slopes(const ContactGeoModel *model, const Spread *spread, const ContactGeoTangent *tangents,
                        int count, GeoMatrix *slope_changes, double *feature_changes) {
  GeoSymmetric projector_change = {{{0}}}, slope_change;
  ContactGeoInvariants change;
  GeoPack packs[CONTACT_GEO_MAX_FEATURES];
  for (int d = 0; d < count; d++) geo_pack_matrix(&tangents[d].projector, d, &projector_change);
  model->kernel->push(model->set, &spread->invariants, &projector_change, &change, packs);
  model->kernel->bend(model->set, &spread->invariants, spread->weights, &spread->sweep, &change,
                      &slope_change);
  for (int d = 0; d < count; d++) {
    geo_unpack_matrix(&slope_change, d, &slope_changes[d]);
    geo_unpack_numbers(packs, model->set->count, d, feature_changes + d * model->set->count);
  }
}

static void find_slope_changes(const ContactGeoModel *model, const GeoMatrix *projector,
                               const double *weights, const ContactGeoTangent *tangents,
                               GeoMatrix *slope_changes, double *feature_changes) {
  Spread spread;
  spread_out(model, projector, weights, &spread);
  for (int first = 0; first < HALF; first += GEO_PACK) {
    int count = HALF - first < GEO_PACK ? HALF - first : GEO_PACK;
    bend_slopes(model, &spread, tangents + first, count, slope_changes + first,
                feature_changes + first * model->set->count);
  }
}

// The columns of tetrahedron `moved`, but for the curvature of the network; the changes of the features.
static void fill_columns(const ContactGeoModel *model, const ContactGeoFrame *frame, const double *weights,
                         const GeoMatrix *slope, const ContactGeoAdjoint *adjoint, int moved,
                         double *feature_changes, double *hessian) {
  ContactGeoTangent tangents[HALF];
  GeoMatrix slope_changes[HALF];
  memset(slope_changes, 0, sizeof slope_changes);
  for (int j = 0; j < HALF; j++) {
    double direction[SIZE] = {0};
    direction[HALF * moved + j] = 1;
    contact_geo_frame_push(frame, direction, &tangents[j]);
  }
  if (model->set)
    find_slope_changes(model, &frame->projector, weights, tangents, slope_changes, feature_changes);
  for (int j = 0; j < HALF; j++) {
    double column[SIZE];
    contact_geo_frame_bend(frame, adjoint, slope, &tangents[j], &slope_changes[j], column);
    for (int i = 0; i < SIZE; i++) hessian[i * SIZE + HALF * moved + j] = column[i];
  }
}

// Features do not change under affine maps, so moving vertex b of the other tetrahedron is moving the
// vertices a of this one by minus a's coordinate b.
static void add_curvature(const ContactGeoFrame *frame, int moved, const double *curvature, double *hessian) {
  int own = HALF * moved, other = HALF - own;
  for (int j = 0; j < HALF; j++)
    for (int v = 0; v < 4; v++)
      for (int c = 0; c < 3; c++) {
        hessian[(own + 3 * v + c) * SIZE + own + j] += curvature[(3 * v + c) * HALF + j];
        double sum = 0;
        for (int a = 0; a < 4; a++) sum += frame->across[moved][a][v] * curvature[(3 * a + c) * HALF + j];
        hessian[(other + 3 * v + c) * SIZE + own + j] -= sum;
      }
}

// The columns of the other tetrahedron: its rows in `moved` by symmetry, the rest by the affine map
// δx = e_c λ_b(x), which moves b alone of its own vertices.
static void fill_other_columns(const ContactGeoFrame *frame, const double *gradient, int moved,
                               double *hessian) {
  int own = HALF * moved, other = HALF - own;
  for (int i = own; i < own + HALF; i++)
    for (int j = other; j < other + HALF; j++) hessian[i * SIZE + j] = hessian[j * SIZE + i];
  for (int i = other; i < other + HALF; i++)
    for (int b = 0; b < 4; b++)
      for (int c = 0; c < 3; c++) {
        double sum = frame->normal.column[i % 3][other / 3 + b] * gradient[i - i % 3 + c];
        for (int a = 0; a < 4; a++) sum += frame->across[moved][a][b] * hessian[i * SIZE + own + 3 * a + c];
        hessian[i * SIZE + other + 3 * b + c] = -sum;
      }
}

static void symmetrise(double *hessian) {
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < i; j++) {
      double mean = (hessian[i * SIZE + j] + hessian[j * SIZE + i]) / 2;
      hessian[i * SIZE + j] = hessian[j * SIZE + i] = mean;
    }
}

int contact_geo_hessian_begin(const ContactGeoModel *model, const ContactGeoFrame *frame,
                              const double *weights, const GeoMatrix *slope, const ContactGeoAdjoint *adjoint,
                              double *feature_changes, double *hessian) {
  int moved = reach(frame, 1) < reach(frame, 0);
  fill_columns(model, frame, weights, slope, adjoint, moved, feature_changes, hessian);
  return moved;
}

void contact_geo_hessian_end(const ContactGeoFrame *frame, int moved, const double *curvature,
                             const double *gradient, double *hessian) {
  if (curvature) add_curvature(frame, moved, curvature, hessian);
  fill_other_columns(frame, gradient, moved, hessian);
  symmetrise(hessian);
}

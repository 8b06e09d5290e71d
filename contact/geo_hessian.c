// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/geo_hessian.h"

#include <math.h>

enum { SIZE = CONTACT_PAIR_SIZE, HALF = 12 };

// The largest coordinate of a vertex of tetrahedron t in the other.
static double reach(const ContactGeoFrame *frame, int t) {
  double bound = 0;
  for (int v = 0; v < 4; v++)
    for (int k = 0; k < 4; k++) bound = fmax(bound, fabs(frame->across[t][v][k]));
  return bound;
}

// The columns of tetrahedron `moved`, but for the curvature of the network; the changes of the features.
static void fill_columns(const ContactGeoModel *model, const ContactGeoFrame *frame,
                         const ContactGeoInvariants *invariants, const double *weights,
                         const ContactGeoSweep *sweep, const GeoMatrix *slope,
                         const ContactGeoAdjoint *adjoint, int moved, double *directions, double *hessian) {
  for (int j = 0; j < HALF; j++) {
    double direction[SIZE] = {0}, column[SIZE];
    direction[HALF * moved + j] = 1;
    ContactGeoTangent tangent;
    contact_geo_frame_push(frame, direction, &tangent);
    GeoMatrix slope_change = {{{0}}};
    if (model->set) {
      ContactGeoInvariants change;
      contact_geo_features_push(model->set, invariants, &tangent.projector, &change,
                                directions + j * model->set->count);
      contact_geo_features_bend(model->set, invariants, weights, sweep, &change, &slope_change);
    }
    contact_geo_frame_bend(frame, adjoint, slope, &tangent, &slope_change, column);
    for (int i = 0; i < SIZE; i++) hessian[i * SIZE + HALF * moved + j] = column[i];
  }
}

// Features do not change under affine maps, so moving vertex b of the other tetrahedron is moving the
// vertices a of this one by minus a's coordinate b.
static void add_curvature(const ContactGeoFrame *frame, int moved, double curvature[HALF][HALF],
                          double *hessian) {
  int own = HALF * moved, other = HALF - own;
  for (int j = 0; j < HALF; j++)
    for (int v = 0; v < 4; v++)
      for (int c = 0; c < 3; c++) {
        hessian[(own + 3 * v + c) * SIZE + own + j] += curvature[3 * v + c][j];
        double sum = 0;
        for (int a = 0; a < 4; a++) sum += frame->across[moved][a][v] * curvature[3 * a + c][j];
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

Status contact_geo_hessian(const ContactGeoModel *model, const ContactGeoFrame *frame,
                           const ContactGeoInvariants *invariants, const double *features,
                           const double *weights, const ContactGeoSweep *sweep, const GeoMatrix *slope,
                           const ContactGeoAdjoint *adjoint, double *hessian) {
  int moved = reach(frame, 1) < reach(frame, 0);
  double directions[HALF * CONTACT_GEO_MAX_FEATURES], curvature[HALF][HALF];
  fill_columns(model, frame, invariants, weights, sweep, slope, adjoint, moved, directions, hessian);
  if (model->set) {
    TRY(model->network.curve(model->network.self, features, HALF, directions, &curvature[0][0]));
    add_curvature(frame, moved, curvature, hessian);
  }
  fill_other_columns(frame, adjoint->gradient, moved, hessian);
  symmetrise(hessian);
  return STATUS_OK;
}

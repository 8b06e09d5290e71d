// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/frame.h"

#include <math.h>
#include <string.h>

#include "overlap/geo/centre.h"

static void fill_projector(const GeoColumns *basis, GeoMatrix *projector) {
  const double(*q)[GEO_LANES] = basis->column;
  for (int k = 0; k < GEO_LANES; k++)
    for (int l = 0; l < GEO_LANES; l++)
      projector->row[k][l] = q[0][k] * q[0][l] + q[1][k] * q[1][l] + q[2][k] * q[2][l];
}

static double trace(const GeoMatrix *matrix) {
  double sum = 0;
  for (int k = 0; k < GEO_LANES; k++) sum += matrix->row[k][k];
  return sum;
}

OverlapGeoOutcome overlap_geo_frame(OverlapGeoFrame *frame, const double pair[24]) {
  OverlapGeoGate gate;
  OverlapGeoOutcome outcome = overlap_geo_gate(&gate, pair);
  if (outcome != OVERLAP_GEO_INSIDE) return outcome;
  frame->step_count = overlap_geo_centre(&gate.normal, gate.slack);
  if (frame->step_count == 0) return OVERLAP_GEO_UNFIT;

  frame->normal = gate.normal;
  memcpy(frame->slack, gate.slack, sizeof gate.slack);
  memcpy(frame->across, gate.across, sizeof gate.across);
  frame->is_enclosed = gate.is_enclosed;
  for (int c = 0; c < 3; c++)
    for (int l = 0; l < GEO_LANES; l++)
      frame->scaled.column[c][l] = frame->normal.column[c][l] / frame->slack[l];
  frame->basis = frame->scaled;
  double length[3];
  overlap_geo_centre_orthonormalise(&frame->basis, 2, length);
  frame->volume = 100.0 / 6 / (length[0] * length[1] * length[2]);
  fill_projector(&frame->basis, &frame->projector);
  if (!(fabs(trace(&frame->projector) - 3) <= OVERLAP_GEO_TRACE_TOLERANCE && frame->volume > 0))
    return OVERLAP_GEO_UNFIT;
  return frame->volume > OVERLAP_GEO_LEAST_SHARE * gate.least_volume ? OVERLAP_GEO_INSIDE : OVERLAP_GEO_EMPTY;
}

void overlap_geo_frame_onset(GeoMatrix *projector) {
  for (int k = 0; k < GEO_LANES; k++)
    for (int l = 0; l < GEO_LANES; l++) projector->row[k][l] = k < 4 && l < 4 ? (k == l) - 0.25 : 0;
}

// c = a b; a may be sparse.
static void multiply(const GeoMatrix *a, const GeoMatrix *b, GeoMatrix *c) {
  for (int i = 0; i < GEO_LANES; i++) {
    double row[GEO_LANES] = {0};
    for (int k = 0; k < GEO_LANES; k++)
      if (a->row[i][k] != 0) geo_add(row, a->row[i][k], b->row[k]);
    memcpy(c->row[i], row, sizeof row);
  }
}

// c = a − P a
static void project_out(const OverlapGeoFrame *frame, const GeoMatrix *a, GeoMatrix *c) {
  double inner[3][GEO_LANES] = {{0}}; // Qᵀ a
  for (int k = 0; k < GEO_LANES; k++)
    for (int b = 0; b < 3; b++) geo_add(inner[b], frame->basis.column[b][k], a->row[k]);
  for (int i = 0; i < GEO_LANES; i++) {
    memcpy(c->row[i], a->row[i], sizeof c->row[i]);
    for (int b = 0; b < 3; b++) geo_add(c->row[i], -frame->basis.column[b][i], inner[b]);
  }
}

// y = P x
static void project(const OverlapGeoFrame *frame, const double x[GEO_LANES], double y[GEO_LANES]) {
  for (int l = 0; l < GEO_LANES; l++) y[l] = 0;
  for (int b = 0; b < 3; b++) geo_add(y, geo_dot(frame->basis.column[b], x), frame->basis.column[b]);
}

// G_ka, or its change given those of A and w.
static inline double coupling(const GeoMatrix *response, const double shift[GEO_LANES], int k, int a) {
  return (response->row[k][k] - response->row[k][a]) - (shift[k] - shift[a]);
}

void overlap_geo_frame_pull(const OverlapGeoFrame *frame, const GeoMatrix *slope, double own,
                            OverlapGeoAdjoint *adjoint) {
  adjoint->own = own;
  multiply(slope, &frame->projector, &adjoint->slope);
  project_out(frame, &adjoint->slope, &adjoint->response);
  double diagonal[GEO_LANES];
  for (int k = 0; k < GEO_LANES; k++) {
    for (int l = 0; l < GEO_LANES; l++)
      adjoint->response.row[k][l] = 2 * adjoint->response.row[k][l] - own * frame->projector.row[k][l];
    diagonal[k] = adjoint->response.row[k][k];
  }
  project(frame, diagonal, adjoint->shift);
  for (int a = 0; a < GEO_LANES; a++) {
    double sum[3] = {0, 0, 0};
    for (int k = a & 4; k < (a & 4) + 4; k++) {
      double g = coupling(&adjoint->response, adjoint->shift, k, a);
      for (int c = 0; c < 3; c++) sum[c] += g * frame->scaled.column[c][k];
    }
    for (int c = 0; c < 3; c++) adjoint->gradient[3 * a + c] = frame->slack[a] * sum[c];
  }
}

// y = Θ x, with Θ = −diag(rate) − τ.
static void multiply_theta(const double rate[GEO_LANES], double tau[GEO_LANES][4], const double x[GEO_LANES],
                           double y[GEO_LANES]) {
  for (int k = 0; k < GEO_LANES; k++) {
    const double *own = x + (k & 4);
    y[k] = -rate[k] * x[k] -
           ((tau[k][0] * own[0] + tau[k][1] * own[1]) + (tau[k][2] * own[2] + tau[k][3] * own[3]));
  }
}

// τ_ka for the four vertices a of plane k's own tetrahedron, and t.
static void fill_tau(const OverlapGeoFrame *frame, const double direction[24], double tau[GEO_LANES][4],
                     double t[GEO_LANES]) {
  for (int k = 0; k < GEO_LANES; k++) {
    const double *moves = direction + 3 * (k & 4);
    t[k] = 0;
    for (int a = 0; a < 4; a++) {
      double along = 0;
      for (int c = 0; c < 3; c++) along += frame->scaled.column[c][k] * moves[3 * a + c];
      t[k] += tau[k][a] = frame->slack[(k & 4) + a] * along;
    }
  }
}

void overlap_geo_frame_push(const OverlapGeoFrame *frame, const double direction[24],
                            OverlapGeoTangent *tangent) {
  double tau[GEO_LANES][4], t[GEO_LANES], load[GEO_LANES], v[GEO_LANES];
  fill_tau(frame, direction, tau, t);
  for (int a = 0; a < GEO_LANES; a++) {
    load[a] = t[a];
    for (int k = a & 4; k < (a & 4) + 4; k++) load[a] -= tau[k][a & 3];
  }
  project(frame, load, v);
  for (int l = 0; l < GEO_LANES; l++) tangent->rate[l] = v[l] - t[l];

  const double(*q)[GEO_LANES] = frame->basis.column;
  double moved[3][GEO_LANES]; // Θ Q, then (1 − P) Θ Q
  double inner[3][3];         // Qᵀ Θ Q
  for (int b = 0; b < 3; b++) {
    multiply_theta(tangent->rate, tau, frame->scaled.column[b], tangent->scaled.column[b]);
    multiply_theta(tangent->rate, tau, q[b], moved[b]);
    for (int c = 0; c < 3; c++) inner[c][b] = geo_dot(q[c], moved[b]);
  }
  tangent->log_volume = -(inner[0][0] + inner[1][1] + inner[2][2]);
  for (int b = 0; b < 3; b++)
    for (int c = 0; c < 3; c++) geo_add(moved[b], -inner[c][b], q[c]);
  for (int k = 0; k < GEO_LANES; k++)
    for (int l = 0; l < GEO_LANES; l++) {
      double sum = 0;
      for (int b = 0; b < 3; b++) sum += moved[b][k] * q[b][l] + q[b][k] * moved[b][l];
      tangent->projector.row[k][l] = sum;
    }
}

// δA = 2 (1 − P)(δΦ P + Φ δP) − 2 δP Φ P − δP, the last for log V alone
static void change_response(const OverlapGeoFrame *frame, const OverlapGeoAdjoint *adjoint,
                            const GeoMatrix *slope, const OverlapGeoTangent *tangent,
                            const GeoMatrix *slope_change, GeoMatrix *change) {
  GeoMatrix inner, part;
  multiply(slope_change, &frame->projector, &inner);
  multiply(slope, &tangent->projector, &part);
  for (int k = 0; k < GEO_LANES; k++) geo_add(inner.row[k], 1, part.row[k]);
  project_out(frame, &inner, change);
  multiply(&tangent->projector, &adjoint->slope, &part);
  for (int k = 0; k < GEO_LANES; k++)
    for (int l = 0; l < GEO_LANES; l++)
      change->row[k][l] =
          2 * (change->row[k][l] - part.row[k][l]) - adjoint->own * tangent->projector.row[k][l];
}

void overlap_geo_frame_bend(const OverlapGeoFrame *frame, const OverlapGeoAdjoint *adjoint,
                            const GeoMatrix *slope, const OverlapGeoTangent *tangent,
                            const GeoMatrix *slope_change, double change[24]) {
  GeoMatrix response;
  change_response(frame, adjoint, slope, tangent, slope_change, &response);
  double diagonal[GEO_LANES], diagonal_change[GEO_LANES], shift[GEO_LANES];
  for (int k = 0; k < GEO_LANES; k++) {
    diagonal[k] = adjoint->response.row[k][k];
    diagonal_change[k] = response.row[k][k];
  }
  project(frame, diagonal_change, shift);
  for (int k = 0; k < GEO_LANES; k++) shift[k] += geo_dot(tangent->projector.row[k], diagonal);
  for (int a = 0; a < GEO_LANES; a++) {
    double sum[3] = {0, 0, 0};
    for (int k = a & 4; k < (a & 4) + 4; k++) {
      double g = coupling(&adjoint->response, adjoint->shift, k, a);
      double dg = coupling(&response, shift, k, a);
      dg += tangent->rate[a] * g;
      for (int c = 0; c < 3; c++)
        sum[c] += dg * frame->scaled.column[c][k] + g * tangent->scaled.column[c][k];
    }
    for (int c = 0; c < 3; c++) change[3 * a + c] = frame->slack[a] * sum[c];
  }
}

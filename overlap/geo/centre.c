// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/centre.h"

#include <math.h>

void overlap_geo_centre_orthonormalise(GeoColumns *m, int passes, double length[3]) {
  for (int c = 0; c < 3; c++) {
    double *column = m->column[c];
    for (int pass = 0; pass < passes; pass++)
      for (int b = 0; b < c; b++) geo_add(column, -geo_dot(m->column[b], column), m->column[b]);
    length[c] = sqrt(geo_dot(column, column));
    double inverse = 1 / length[c];
    for (int l = 0; l < GEO_LANES; l++) column[l] *= inverse;
  }
}

// The relative changes r of the slacks in a full step, and δ.
static double find_step(const GeoColumns *normal, const double slack[GEO_LANES], double r[GEO_LANES]) {
  GeoColumns q;
  double length[3], inverse[GEO_LANES], square = 0;
  for (int l = 0; l < GEO_LANES; l++) inverse[l] = 1 / slack[l];
  for (int c = 0; c < 3; c++)
    for (int l = 0; l < GEO_LANES; l++) q.column[c][l] = normal->column[c][l] * inverse[l];
  overlap_geo_centre_orthonormalise(&q, 1, length);
  for (int l = 0; l < GEO_LANES; l++) r[l] = 0;
  for (int c = 0; c < 3; c++) {
    double y = geo_sum(q.column[c]);
    geo_add(r, y, q.column[c]);
    square += y * y;
  }
  return sqrt(square);
}

// The length of a damped step: from α = 1/(1 + δ), which is never too long (self-concordance), three Newton
// steps on Σ log(1 + α r).
static double search(const double r[GEO_LANES], double decrement) {
  double lowest = 0;
  for (int l = 0; l < GEO_LANES; l++) lowest = fmin(lowest, r[l]);
  double longest = lowest < 0 ? OVERLAP_GEO_LONGEST_STEP / -lowest : INFINITY;
  double alpha = 1 / (1 + decrement);
  for (int step = 0; step < 3; step++) {
    double term[GEO_LANES], square[GEO_LANES];
    for (int l = 0; l < GEO_LANES; l++) {
      term[l] = r[l] / (1 + alpha * r[l]);
      square[l] = term[l] * term[l];
    }
    alpha = fmin(alpha + geo_sum(term) / geo_sum(square), longest);
  }
  return alpha;
}

static void restore_slack_sum(double slack[4]) {
  double excess = slack[0] + slack[1] + slack[2] + slack[3] - 1, square = 0;
  for (int k = 0; k < 4; k++) square += slack[k] * slack[k];
  for (int k = 0; k < 4; k++) slack[k] -= excess / square * slack[k] * slack[k];
}

int overlap_geo_centre(const GeoColumns *normal, double slack[GEO_LANES]) {
  for (int step = 1; step <= OVERLAP_GEO_MAX_STEPS; step++) {
    double r[GEO_LANES];
    double decrement = find_step(normal, slack, r);
    double alpha = decrement <= OVERLAP_GEO_FULL_STEP ? 1 : search(r, decrement);
    for (int l = 0; l < GEO_LANES; l++) slack[l] += alpha * r[l] * slack[l];
    if (!(decrement < OVERLAP_GEO_CONVERGED)) continue;
    restore_slack_sum(slack);
    restore_slack_sum(slack + 4);
    return step;
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/hessian.h"

#include <math.h>

enum { SIZE = OVERLAP_PAIR_SIZE, HALF = OVERLAP_GEO_DIRECTIONS };

// The largest coordinate of a vertex of tetrahedron t in the other.
static double reach(const OverlapGeoFrame *frame, int t) {
  double bound = 0;
  for (int v = 0; v < 4; v++)
    for (int k = 0; k < 4; k++) bound = fmax(bound, fabs(frame->across[t][v][k]));
  return bound;
}

// The columns of the other tetrahedron: its rows in `moved` by symmetry, the rest by the affine map
// δx = e_c λ_b(x), which moves b alone of its own vertices.
static void fill_other_columns(const OverlapGeoFrame *frame, const double *gradient, int moved,
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

int overlap_geo_hessian_moved(const OverlapGeoFrame *frame) {
  return reach(frame, 1) < reach(frame, 0);
}

void overlap_geo_hessian_complete(const OverlapGeoFrame *frame, int moved, const double *gradient,
                                  double *hessian) {
  fill_other_columns(frame, gradient, moved, hessian);
  symmetrise(hessian);
}

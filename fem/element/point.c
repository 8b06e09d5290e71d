// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/element/point.h"

void fem_point_deformation(const FemPoint *point, const double *x, double F[9]) {
  for (int r = 0; r < 9; r++) F[r] = 0;
  for (int a = 1; a < point->node_count; a++) {
    const double *g = point->gradient[a];
    for (int i = 0; i < 3; i++) {
      double d = x[3 * a + i] - x[i];
      for (int j = 0; j < 3; j++) F[3 * i + j] += d * g[j];
    }
  }
}

void fem_point_add_force(const FemPoint *point, const double P[9], double *force) {
  double sum[3] = {0};
  for (int a = 1; a < point->node_count; a++) {
    const double *g = point->gradient[a];
    for (int i = 0; i < 3; i++) {
      double f = -point->weight * (P[3 * i] * g[0] + P[3 * i + 1] * g[1] + P[3 * i + 2] * g[2]);
      force[3 * a + i] += f;
      sum[i] += f;
    }
  }
  for (int i = 0; i < 3; i++) force[i] -= sum[i];
}

// answer[3 i + j][k] = weight Σ_l ∂P_ij/∂F_kl ∂N_b/∂X_l: how P answers when node b moves along k.
static void contract(const FemPoint *point, const double dP[81], int b, double answer[9][3]) {
  const double *g = point->gradient[b];
  double g0 = point->weight * g[0], g1 = point->weight * g[1], g2 = point->weight * g[2];
  for (int r = 0; r < 9; r++)
    for (int k = 0; k < 3; k++)
      answer[r][k] = dP[9 * r + 3 * k] * g0 + dP[9 * r + 3 * k + 1] * g1 + dP[9 * r + 3 * k + 2] * g2;
}

void fem_point_add_tangent(const FemPoint *point, const double dP[81], double *matrix) {
  int n = 3 * point->node_count;
  for (int b = 0; b < point->node_count; b++) {
    double answer[9][3];
    contract(point, dP, b, answer);
    for (int a = 0; a <= b; a++) {
      const double *g = point->gradient[a];
      for (int i = 0; i < 3; i++) {
        double *row = matrix + n * (3 * a + i) + 3 * b;
        for (int k = 0; k < 3; k++)
          row[k] += g[0] * answer[3 * i][k] + g[1] * answer[3 * i + 1][k] + g[2] * answer[3 * i + 2][k];
      }
    }
  }
}

void fem_point_mirror(int node_count, double *matrix) {
  int n = 3 * node_count;
  for (int r = 0; r < n; r++)
    for (int c = 0; c < r; c++) matrix[n * r + c] = matrix[n * c + r];
}

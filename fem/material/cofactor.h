// SPDX-License-Identifier: GPL-3.0-or-later
// det F and its derivatives: what every law that knows the volume ratio needs. Row-major 3 × 3.
#ifndef TETLAP_FEM_MATERIAL_COFACTOR_H
#define TETLAP_FEM_MATERIAL_COFACTOR_H

// cof F = ∂(det F)/∂F.
static inline void fem_cofactor_find(const double F[9], double C[9]) {
  C[0] = F[4] * F[8] - F[5] * F[7], C[1] = F[5] * F[6] - F[3] * F[8], C[2] = F[3] * F[7] - F[4] * F[6];
  C[3] = F[2] * F[7] - F[1] * F[8], C[4] = F[0] * F[8] - F[2] * F[6], C[5] = F[1] * F[6] - F[0] * F[7];
  C[6] = F[1] * F[5] - F[2] * F[4], C[7] = F[2] * F[3] - F[0] * F[5], C[8] = F[0] * F[4] - F[1] * F[3];
}

static inline double fem_cofactor_det(const double F[9]) {
  return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
         F[2] * (F[3] * F[7] - F[4] * F[6]);
}

// J − 1 from the displacement gradient G = F − I: no cancellation at small strain.
static inline double fem_cofactor_swelling(const double F[9]) {
  double G[9], C[9];
  for (int r = 0; r < 9; r++) G[r] = F[r] - (r % 4 == 0);
  fem_cofactor_find(G, C);
  return (G[0] + G[4] + G[8]) + (C[0] + C[4] + C[8]) + (G[0] * C[0] + G[1] * C[1] + G[2] * C[2]);
}

// dP += scale · ∂cof F/∂F: ∂cof_kl/∂F_mn = ± F_ij for the index triples (i, k, m) and (j, l, n) that are
// permutations.
static inline void fem_cofactor_add_derivative(const double F[9], double scale, double dP[81]) {
  static const int next[3] = {1, 2, 0}, last[3] = {2, 0, 1};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int nn = 3 * next[i] + next[j], ll = 3 * last[i] + last[j];
      int nl = 3 * next[i] + last[j], ln = 3 * last[i] + next[j];
      double entry = scale * F[3 * i + j];
      dP[9 * nn + ll] += entry, dP[9 * ll + nn] += entry;
      dP[9 * nl + ln] -= entry, dP[9 * ln + nl] -= entry;
    }
}

#endif

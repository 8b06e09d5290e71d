// SPDX-License-Identifier: Apache-2.0
#include "overlap/tpn/share.h"

#include "overlap/pair/simplex.h"

enum { SIZE = 24, HALF = 12 };

double overlap_tpn_share(const double pair[24], double closed) {
  double lambda[HALF];
  return closed *
         (1 / overlap_simplex_volume(pair, lambda) + 1 / overlap_simplex_volume(pair + HALF, lambda));
}

// With s = 1/V_A + 1/V_B: ∇(1/V) = −λ/V, ∇²(1/V) = (λ_kr λ_lc + λ_kc λ_lr)/V.
void overlap_tpn_share_bend(const double pair[24], double closed, const double closed_gradient[24],
                            const double *closed_hessian, double gradient[24], double *hessian) {
  double lambda[SIZE], slope[SIZE], inverse[2];
  for (int t = 0; t < 2; t++) inverse[t] = 1 / overlap_simplex_volume(pair + HALF * t, lambda + HALF * t);
  for (int i = 0; i < SIZE; i++) slope[i] = -lambda[i] * inverse[i / HALF];
  double scale = inverse[0] + inverse[1];
  for (int i = 0; i < SIZE; i++) gradient[i] = scale * closed_gradient[i] + closed * slope[i];
  if (!hessian) return;
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < SIZE; j++)
      hessian[SIZE * i + j] = scale * closed_hessian[SIZE * i + j] + closed_gradient[i] * slope[j] +
                              slope[i] * closed_gradient[j];
  for (int t = 0; t < 2; t++)
    overlap_simplex_add_outer(lambda + HALF * t, closed * inverse[t], closed * inverse[t],
                              hessian + (SIZE + 1) * HALF * t);
}

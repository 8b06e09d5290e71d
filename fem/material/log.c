// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/material/log.h"

#include <math.h>

#include "fem/material/cofactor.h"

FemMaterialLog fem_material_log(double swelling) {
  const double least = FEM_MATERIAL_LOG_SMALLEST;
  double J = 1 + swelling, x = (J - least) / least;
  if (x >= 0) return (FemMaterialLog){log1p(swelling), 1 / J, -1 / (J * J)};
  return (FemMaterialLog){log(least) + x - 0.5 * x * x, (1 - x) / least, -1 / (least * least)};
}

// P = μ F + (λ θ − μ) θ' cof F.
void fem_material_log_stress(const FemMaterial *material, const double F[9], double P[9]) {
  FemLame lame = fem_material_lame(material);
  FemMaterialLog theta = fem_material_log(fem_cofactor_swelling(F));
  double C[9], weight = (lame.lambda * theta.value - lame.mu) * theta.slope;
  fem_cofactor_find(F, C);
  for (int r = 0; r < 9; r++) P[r] = lame.mu * F[r] + weight * C[r];
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/material/isochoric.h"

#include <math.h>

#include "fem/material/cofactor.h"

FemMaterialPower fem_material_isochoric_power(double swelling) {
  const double least = FEM_MATERIAL_ISOCHORIC_SMALLEST, e = -2.0 / 3;
  double J = fmax(1 + swelling, least), x = 1 + swelling - J; // x < 0 on the parabola
  double g = pow(J, e), slope = e * g / J, bend = e * (e - 1) * g / (J * J);
  double less_one = x < 0 ? g - 1 : expm1(e * log1p(swelling));
  return (FemMaterialPower){less_one + slope * x + 0.5 * bend * x * x, slope + bend * x, bend};
}

// I_C − 3 from the displacement gradient.
static double stretch_of(const double F[9]) {
  double stretch = 0;
  for (int r = 0; r < 9; r++) {
    double G = F[r] - (r % 4 == 0);
    stretch += G * G + (r % 4 == 0 ? 2 * G : 0);
  }
  return stretch;
}

static double bulk_of(FemLame lame) {
  return lame.lambda + 2.0 / 3 * lame.mu;
}

// P = μ g F + (μ/2 g' I_C + K (J − 1)) cof F.
void fem_material_isochoric_stress(const FemMaterial *material, const double F[9], double P[9]) {
  FemLame lame = fem_material_lame(material);
  double C[9], swelling = fem_cofactor_swelling(F);
  FemMaterialPower g = fem_material_isochoric_power(swelling);
  double weight = 0.5 * lame.mu * g.slope * (stretch_of(F) + 3) + bulk_of(lame) * swelling;
  fem_cofactor_find(F, C);
  for (int r = 0; r < 9; r++) P[r] = lame.mu * (1 + g.less_one) * F[r] + weight * C[r];
}

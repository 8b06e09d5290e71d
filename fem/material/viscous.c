// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/material/viscous.h"

#include <string.h>

// The law linear does not tell the two configurations apart: its F is I.
static const double *damped_deformation(const FemMaterial *material, const double F[9]) {
  static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  return fem_material_is_linear(material) ? identity : F;
}

// Ė = sym(Fᵀ Ḟ) and the viscous second Piola–Kirchhoff stress Σ = 2μ_v Ė + λ_v tr Ė I.
static void find_stress(const FemMaterial *material, double beta, const double F[9], const double rate[9],
                        double strain_rate[9], double stress[9]) {
  FemLame lame = fem_material_viscous(material, beta);
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) {
      double sum = 0;
      for (int m = 0; m < 9; m += 3) sum += F[m + i] * rate[m + j] + rate[m + i] * F[m + j];
      strain_rate[3 * i + j] = strain_rate[3 * j + i] = 0.5 * sum;
    }
  double pressure = lame.lambda * (strain_rate[0] + strain_rate[4] + strain_rate[8]);
  for (int r = 0; r < 9; r++) stress[r] = 2 * lame.mu * strain_rate[r] + (r % 4 == 0 ? pressure : 0);
}

void fem_viscous_stress(const FemMaterial *material, double beta, const double F[9], const double rate[9],
                        double P[9]) {
  double strain_rate[9], stress[9];
  F = damped_deformation(material, F);
  find_stress(material, beta, F, rate, strain_rate, stress);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      P[3 * i + j] = F[3 * i] * stress[j] + F[3 * i + 1] * stress[3 + j] + F[3 * i + 2] * stress[6 + j];
}

void fem_viscous_tangent(const FemMaterial *material, double beta, const double F[9], double dP[81]) {
  fem_material_pushed_stiffness(fem_material_viscous(material, beta), damped_deformation(material, F), dP);
}

// P_v = F Σ(F, Ḟ), so ∂P_v = ∂F Σ + F C_v : sym(Ḟᵀ ∂F). The first term is this.
void fem_viscous_stiffness(const FemMaterial *material, double beta, const double F[9], const double rate[9],
                           double dP[81]) {
  double strain_rate[9], stress[9];
  memset(dP, 0, 81 * sizeof *dP);
  if (fem_material_is_linear(material)) return;
  find_stress(material, beta, F, rate, strain_rate, stress);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int l = 0; l < 3; l++) dP[9 * (3 * i + j) + 3 * i + l] += stress[3 * j + l];
}

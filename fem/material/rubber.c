// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/material/rubber.h"

#include <math.h>

#include "fem/material/cofactor.h"
#include "fem/material/svd3.h"

static double dot9(const double A[9], const double B[9]) {
  double sum = 0;
  for (int r = 0; r < 9; r++) sum += A[r] * B[r];
  return sum;
}

// Mooney–Rivlin.

// κ', d of the volumetric part ½ κ' (J − 1)² − d (J − 1) beside c₁, c₂.
typedef struct Mooney {
  double c1, c2, kappa, d; // [Pa]
} Mooney;

static Mooney mooney_of(const FemMaterial *material) {
  FemLame lame = fem_material_lame(material);
  Mooney m = {.c1 = 0.5 * lame.mu * (1 - material->mooney), .c2 = 0.5 * lame.mu * material->mooney};
  m.kappa = lame.lambda + 2 * m.c1;
  m.d = 2 * m.c1 + 4 * m.c2;
  return m;
}

// P = 2c₁ F + 2c₂ D(F) cof F + (κ' (J − 1) − d) cof F with D = ∂cof/∂F, which is linear in F.
void fem_material_mooney_stress(const FemMaterial *material, const double F[9], double P[9]) {
  Mooney m = mooney_of(material);
  double C[9], D[81] = {0}, weight = m.kappa * fem_cofactor_swelling(F) - m.d;
  fem_cofactor_find(F, C);
  fem_cofactor_add_derivative(F, 1, D);
  for (int r = 0; r < 9; r++) P[r] = 2 * m.c1 * F[r] + 2 * m.c2 * dot9(D + 9 * r, C) + weight * C[r];
}

// Ogden.

FemOgden fem_material_ogden(const FemMaterial *material) {
  double mu = fem_material_lame(material).mu, total = 0;
  FemOgden law;
  for (int p = 0; p < 3; p++) total += material->shares[p];
  for (int p = 0; p < 3; p++) {
    double own = 2 * mu * material->shares[p] / total;
    law.power[p] = material->exponents[p] - 1;
    law.own[p] = own == 0 ? 0 : own / material->exponents[p]; // the exponent of what is not there may be 0
  }
  return law;
}

static FemOgdenForce ogden_power(const FemOgden *law, double stretch) {
  FemOgdenForce f = {0, 0};
  for (int p = 0; p < 3; p++) {
    if (law->own[p] == 0) continue;
    double term = law->own[p] * pow(stretch, law->power[p]);
    f.value += term;
    f.slope += law->power[p] * term / stretch;
  }
  return f;
}

FemOgdenForce fem_material_ogden_edge(const FemMaterial *material) {
  FemOgden law = fem_material_ogden(material);
  return ogden_power(&law, FEM_MATERIAL_OGDEN_SMALLEST);
}

static FemOgdenForce ogden_force(const FemOgden *law, double stretch) {
  const double least = FEM_MATERIAL_OGDEN_SMALLEST;
  if (stretch >= least) return ogden_power(law, stretch);
  FemOgdenForce edge = ogden_power(law, least);
  return (FemOgdenForce){edge.value + edge.slope * (stretch - least), edge.slope};
}

// d = w'(1) makes the stress at rest zero; κ' = λ + d.
static double ogden_rest(const FemOgden *law) {
  return law->own[0] + law->own[1] + law->own[2];
}

void fem_material_ogden_stress(const FemMaterial *material, const double F[9], double P[9]) {
  FemSvd3 svd;
  fem_svd3_factor(&svd, F);
  FemOgden law = fem_material_ogden(material);
  double d = ogden_rest(&law), kappa = fem_material_lame(material).lambda + d, C[9];
  double weight = kappa * fem_cofactor_swelling(F) - d;
  fem_cofactor_find(F, C);
  for (int r = 0; r < 9; r++) P[r] = weight * C[r];
  for (int k = 0; k < 3; k++) {
    double f = ogden_force(&law, svd.sigma[k]).value;
    for (int r = 0; r < 9; r++) P[r] += f * svd.U[3 * (r / 3) + k] * svd.V[3 * (r % 3) + k];
  }
}

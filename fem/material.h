// SPDX-License-Identifier: GPL-3.0-or-later
// Constitutive laws of isotropic elastic solids: energy density Ψ(F), first Piola–Kirchhoff stress P = ∂Ψ/∂F
// and its derivative ∂P/∂F, exact, for every F, inverted ones included. Matrices are row-major: F[3 i + j] =
// ∂x_i/∂X_j; the 9 × 9 derivative has rows P_ij, columns F_kl in the same order.
#ifndef TETLAP_FEM_MATERIAL_H
#define TETLAP_FEM_MATERIAL_H

#include "base/status.h"

typedef enum FemMaterialLaw {
  FEM_MATERIAL_LINEAR,       // small strain: ε = sym(F) − I
  FEM_MATERIAL_COROTATIONAL, // linear in the polar stretch
  FEM_MATERIAL_STVK,         // St. Venant–Kirchhoff
  FEM_MATERIAL_NEO_HOOKEAN,  // stable neo-Hookean (Smith, de Goes, Kim 2018)
} FemMaterialLaw;

enum { FEM_MATERIAL_LAW_COUNT = 4 };

typedef struct FemMaterial {
  FemMaterialLaw law;
  double young; // [Pa]
  double poisson;
  double density; // [kg/m³]
  double damping; // β of stiffness-proportional damping [s]; < 0: the scene's
} FemMaterial;

// The name a scene uses: linear, corotational, stvk, neo_hookean; and one line of help.
const char *fem_material_name(FemMaterialLaw law);
const char *fem_material_help(FemMaterialLaw law);

typedef struct FemLame {
  double lambda, mu; // [Pa]
} FemLame;
FemLame fem_material_lame(const FemMaterial *material);

double fem_material_energy(const FemMaterial *material, const double F[9]);               // Ψ [J/m³]
void fem_material_stress(const FemMaterial *material, const double F[9], double P[9]);    // [Pa]
void fem_material_tangent(const FemMaterial *material, const double F[9], double dP[81]); // [Pa]

#endif

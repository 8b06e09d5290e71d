// SPDX-License-Identifier: GPL-3.0-or-later
// Constitutive laws of isotropic elastic solids: energy density Ψ(F), first Piola–Kirchhoff stress P = ∂Ψ/∂F
// and its derivative ∂P/∂F, exact, for every F, inverted ones included. Matrices are row-major: F[3 i + j] =
// ∂x_i/∂X_j; the 9 × 9 derivative, symmetric, has rows P_ij, columns F_kl in the same order.
//
// With λ, μ of the given E, ν, every law has Ψ = 0, P = 0 and the isotropic tangent of E, ν at F = I; all but
// `linear` also have Ψ(QF) = Ψ(F) for rotations Q:
//
//   linear        Ψ = μ ε:ε + λ/2 tr²ε                 ε = sym F − I
//   corotational  Ψ = μ ‖S − I‖² + λ/2 tr²(S − I)      F = R S, R the nearest proper rotation
//   stvk          Ψ = μ E:E + λ/2 tr²E                 E = ½ (FᵀF − I)
//   neo_hookean   Ψ = μ'/2 (I_C − 3) − μ'/2 log((I_C + 1)/4) − ¾ μ' (J − 1) + λ'/2 (J − 1)²
//                 μ' = 4/3 μ, λ' = λ + 5/6 μ, I_C = F:F, J = det F
//
// neo_hookean is the stable neo-Hookean energy of Smith, de Goes and Kim 2018 with their Lamé parameters,
// less its constant, and with their rest stability α = 1 + ¾ μ'/λ' multiplied out. The logarithm is kept:
// without it a collapse to F = 0 would be a stable state. It and stvk are smooth for all F; stvk, though,
// depends on FᵀF alone: under strong compression it softens, and a mirrored element is at rest.
//
// corotational: R comes from singular values whose last carries the sign of det F (svd3.h). R, and with it P,
// jumps where σ_i + σ_j = 0, which needs J ≤ 0; there one of the nearest rotations is taken, and the
// derivative's 1/(σ_i + σ_j) is bounded by 1e6 (a sum of stretches below 1e-6 counts as 1e-6). Everywhere
// else it is exact.
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
  double young;   // E > 0 [Pa]
  double poisson; // −1 < ν < ½
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

// The law's measure of volume change θ(F), of which every law has the term λ/2 θ²: tr ε, tr(S − I), tr E, J −
// 1. Returns θ; gradient ∂θ/∂F (9) and curvature ∂²θ/∂F² (9, 9).
double fem_material_volume(FemMaterialLaw law, const double F[9], double gradient[9]);
void fem_material_volume_curvature(FemMaterialLaw law, const double F[9], double curvature[81]);

// The same material with another first Lamé parameter λ and the same μ.
FemMaterial fem_material_with_lambda(const FemMaterial *material, double lambda);

// F C Fᵀ with the small-strain C of the law: what a strain dE = sym(Fᵀ dF) answers with, dP = F (C : dE).
// The material part of stvk's tangent, and the matrix of damping.
void fem_material_pushed_stiffness(const FemMaterial *material, const double F[9], double dP[81]);
// Its rate of change while F changes with `rate`: rate C Fᵀ + F C rateᵀ.
void fem_material_pushed_stiffness_rate(const FemMaterial *material, const double F[9], const double rate[9],
                                        double dP[81]);

#endif

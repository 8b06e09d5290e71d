// SPDX-License-Identifier: GPL-3.0-or-later
// Constitutive laws of isotropic elastic solids: the first Piola–Kirchhoff stress P = ∂Ψ/∂F of an energy
// density Ψ(F) [J/m³], exact, for every F, inverted ones included; Ψ is in fem/lanes/energy.inc, ∂P/∂F in
// fem/lanes/law.inc. Matrices are row-major: F[3 i + j] = ∂x_i/∂X_j; 9 × 9 ones have rows and columns in that
// order.
//
// With λ, μ of the given E, ν, every law has Ψ = 0, P = 0 and the isotropic tangent of E, ν at F = I; all but
// `linear` also have Ψ(QF) = Ψ(F) for rotations Q:
//
//   linear        Ψ = μ ε:ε + λ/2 tr²ε                 ε = sym F − I
//   corotational  Ψ = μ ‖S − I‖² + λ/2 tr²(S − I)      F = R S, R the nearest proper rotation
//   stvk          Ψ = μ E:E + λ/2 tr²E                 E = ½ (FᵀF − I)
//   neo_hookean   Ψ = μ'/2 (I_C − 3) − μ'/2 log((I_C + 1)/4) − ¾ μ' (J − 1) + λ'/2 (J − 1)²
//                 μ' = 4/3 μ, λ' = λ + 5/6 μ, I_C = F:F, J = det F
//   neo_hookean_log Ψ = μ/2 (I_C − 3) − μ ln J + λ/2 ln²J,  ν ≥ 0
//   neo_hookean_isochoric Ψ = μ/2 (J^(−2/3) I_C − 3) + K/2 (J − 1)²,  K = λ + 2/3 μ
//   mooney_rivlin Ψ = c₁ (I_C − 3) + c₂ (‖cof F‖² − 3) − (2c₁ + 4c₂)(J − 1) + (λ + 2c₁)/2 (J − 1)²
//                 c₁ = (1 − m) μ/2, c₂ = m μ/2
//   ogden         Ψ = Σ_i Σ_p μ_p/α_p (σ_i^α_p − 1) − d (J − 1) + (λ + d)/2 (J − 1)²,  d = Σ μ_p
//                 σ_i the principal stretches, μ_p α_p = 2 μ times the share of the term
//
// neo_hookean is the stable neo-Hookean energy of Smith, de Goes and Kim 2018 with their Lamé parameters,
// less its constant, and with their rest stability α = 1 + ¾ μ'/λ' multiplied out. The logarithm is kept:
// without it a collapse to F = 0 would be a stable state. It and stvk are smooth for all F; stvk, though,
// depends on FᵀF alone: under strong compression it softens, and a mirrored element is at rest.
//
// neo_hookean_log is the classical compressible form (Simo and Pister 1984; Bonet and Wood, eq. 6.27): its
// pressure grows without bound as J → 0, where that of neo_hookean ends at about 2 E (ν = 0.4). From J =
// 0.05 down ln J goes on as its parabola, with two continuous derivatives, so that inverted elements are
// pushed back; λ < 0 would win over the barrier.
//
// neo_hookean_isochoric is that of CalculiX and Abaqus (C₁₀ = μ/2, D₁ = 2/K; Abaqus Theory Manual, 4.6.1).
// From J = 0.05 down the power goes on as its parabola.
//
// corotational: R comes from singular values whose last carries the sign of det F (svd3.h). R, and with it P,
// jumps where σ_i + σ_j = 0, which needs J ≤ 0; there one of the nearest rotations is taken, and the
// derivative's 1/(σ_i + σ_j) is bounded by 1e6 (a sum of stretches below 1e-6 counts as 1e-6). Everywhere
// else it is exact. ogden is the same there (1e-4); below σ = 0.1 its powers go on as parabolas.
//
// Rubber laws are Mooney 1940, Rivlin 1948 and Ogden 1972 with a compressible part that is a polynomial in J
// (after Ciarlet), so that they stay finite in inverted elements; as ν → ½ they become the incompressible
// ones.
//
// Fibres (transverse isotropy) add Ψ_f = k/2 E_f², E_f = ½ (a·FᵀF a − 1), along the unit vector a at rest;
// if they buckle, only for E_f > 0.
#ifndef TETLAP_FEM_MATERIAL_MATERIAL_H
#define TETLAP_FEM_MATERIAL_MATERIAL_H

#include "fem/material/law.h"

// The name a scene uses: linear, corotational, stvk, neo_hookean; and one line of help.
const char *fem_material_name(FemMaterialLaw law);
const char *fem_material_help(FemMaterialLaw law);
// Why an element of this law may be turned inside out by a load, and what to do; for messages.
const char *fem_material_limit(FemMaterialLaw law);

void fem_material_stress(const FemMaterial *material, const double F[9], double P[9]); // [Pa]

// Cauchy stress σ = P Fᵀ / J [Pa] of a stress P: xx, yy, zz, xy, yz, xz. Zero where |J| ≤ 1e-12. The linear
// law does not tell the two configurations apart: its σ is P.
void fem_material_cauchy(FemMaterialLaw law, const double F[9], const double P[9], double stress[6]);

// The law's measure of volume change θ(F), of which every law has the term λ/2 θ²: tr ε, tr(S − I), tr E, J −
// 1, ln J. Returns θ; gradient ∂θ/∂F (9) and curvature ∂²θ/∂F² (9, 9).
double fem_material_volume(FemMaterialLaw law, const double F[9], double gradient[9]);
void fem_material_volume_curvature(FemMaterialLaw law, const double F[9], double curvature[81]);

// The same material with other Lamé parameters; with another λ and the same μ.
FemMaterial fem_material_with_lame(const FemMaterial *material, FemLame lame);
FemMaterial fem_material_with_lambda(const FemMaterial *material, double lambda);
// λ_e / μ at most of what a nodal element keeps for itself: that of ν = 1/4. Measured, a cantilever of 10
// cubes through its thickness at ν = 0.499: 0.907 of beam theory with 2, 0.916 with 1, 0.926 with 0; at 0
// nothing but μ is left against pressures that alternate.
#define FEM_MATERIAL_LARGEST_LOCAL_RATIO 1.0
FemMaterial fem_material_local(const FemMaterial *material);

// The stress is linear in F: the law linear.
bool fem_material_is_linear(const FemMaterial *material);

// β C and the viscosities as a pair of Lamé parameters [Pa s].
FemLame fem_material_viscous(const FemMaterial *material, double beta);

#endif

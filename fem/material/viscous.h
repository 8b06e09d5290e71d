// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffness-proportional damping and viscosity at a point, from F and Ḟ. Rigid motion causes no stress,
// except with the law linear, whose rate is sym Ḟ. With the Green strain rate Ė = sym(Fᵀ Ḟ) and the Lamé
// parameters C_v of β C and the material's viscosities, the density of dissipation is R = ½ Ė:C_v:Ė.
#ifndef TETLAP_FEM_MATERIAL_VISCOUS_H
#define TETLAP_FEM_MATERIAL_VISCOUS_H

#include "fem/material/material.h"

// P_v = ∂R/∂Ḟ = F Σ, Σ = C_v : Ė [Pa].
void fem_viscous_stress(const FemMaterial *material, double beta, const double F[9], const double rate[9],
                        double P[9]);
// ∂P_v/∂Ḟ [Pa s], symmetric, ≥ 0.
void fem_viscous_tangent(const FemMaterial *material, double beta, const double F[9], double dP[81]);
// The geometric part of ∂P_v/∂F [Pa], ∂F Σ: symmetric, perhaps indefinite, zero for the law linear. The rest,
// F C_v : sym(Ḟᵀ ∂F), is left out. It is not symmetric: rotations change stresses, but strains cause no
// torque. Its symmetric part couples both ways, by about β E Ω in a body that turns with Ω, far more than
// inertia does: with it Newton's method diverges on stiff bodies that turn, without it one more iteration is
// enough.
void fem_viscous_stiffness(const FemMaterial *material, double beta, const double F[9], const double rate[9],
                           double dP[81]);

#endif

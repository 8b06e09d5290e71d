// SPDX-License-Identifier: GPL-3.0-or-later
// Ψ and ∂P/∂F of the laws of fem/material/material.h and damping at a point, one point at a time, as the
// formulas have them: what vector lanes (fem/lanes/lanes.h), which never form ∂P/∂F, are compared with.
#ifndef TETLAP_TESTS_REFERENCE_MATERIAL_H
#define TETLAP_TESTS_REFERENCE_MATERIAL_H

#include "fem/material/material.h"

double reference_energy(const FemMaterial *material, const double F[9]);               // Ψ [J/m³]
void reference_tangent(const FemMaterial *material, const double F[9], double dP[81]); // [Pa]

// F C Fᵀ with the small-strain C of the Lamé parameters: what a strain dE = sym(Fᵀ dF) answers with, dP = F
// (C : dE). The material part of stvk's tangent, and the matrix of damping.
void reference_pushed_stiffness(FemLame lame, const double F[9], double dP[81]);

// Damping (fem/lanes/viscous.inc): P_v [Pa]; ∂P_v/∂Ḟ [Pa s], symmetric, ≥ 0; the geometric part of ∂P_v/∂F
// [Pa], zero for the law linear.
void reference_viscous_stress(const FemMaterial *material, double beta, const double F[9],
                              const double rate[9], double P[9]);
void reference_viscous_tangent(const FemMaterial *material, double beta, const double F[9], double dP[81]);
void reference_viscous_stiffness(const FemMaterial *material, double beta, const double F[9],
                                 const double rate[9], double dP[81]);

#endif

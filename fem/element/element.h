// SPDX-License-Identifier: GPL-3.0-or-later
// The linear tetrahedron: constant F, one quadrature point. The quadratic one is fem/element/quadratic.h.
// Nodes are given as (4, 3) arrays; matrices (12, 12) are symmetric to the last bit. Nothing depends on where
// the origin is, beyond the rounding of the given positions. Inverted elements are evaluated like others.
#ifndef TETLAP_FEM_ELEMENT_ELEMENT_H
#define TETLAP_FEM_ELEMENT_ELEMENT_H

#include "fem/material/material.h"

// What is constant in an element.
typedef struct FemElement {
  double gradient[4][3]; // ∂N_a/∂X [1/m]
  double volume;         // at rest [m³]
} FemElement;

// `rest` must be positively oriented and of positive volume, as every FemMesh is.
void fem_element_create(FemElement *element, const double rest[12]);

// F = Σ_a x_a ⊗ ∂N_a/∂X; Ḟ from velocities in the same way.
void fem_element_deformation(const FemElement *element, const double x[12], double F[9]);

// K_ai,bk = V Σ_jl ∂N_a/∂X_j ∂P_ij/∂F_kl ∂N_b/∂X_l for any symmetric ∂P/∂F.
void fem_element_spread_tangent(const FemElement *element, const double dP[81], double matrix[144]);

// Cauchy stress [Pa] (fem_material_cauchy).
void fem_element_cauchy(const FemElement *element, const FemMaterial *material, const double x[12],
                        double stress[6]);

#endif

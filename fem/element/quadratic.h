// SPDX-License-Identifier: GPL-3.0-or-later
// The quadratic tetrahedron: ten nodes, the corners 0 … 3 and the middles 4 … 9 of the edges 01, 02, 03, 12,
// 13, 23. With the barycentric coordinates L its shape functions are L_i (2 L_i − 1) and 4 L_i L_j. Four
// quadrature points of equal weight, L = (a, b, b, b), a = (5 + 3√5)/20, b = (5 − √5)/20
// (Hammer, Marlowe and Stroud 1956), integrate products of gradients exactly: at rest the stiffness is that
// of exact integration, and only rigid motions cost no energy (4 points × 6 strains = 30 coordinates − 6).
// At rest an edge may be curved (isoparametric): the same shape functions give the positions X(L), and each
// point has the volume det(∂X/∂L)/24.
//
// What λ exceeds λ_e = min(λ, 2μ) by resists the mean of the volume change θ over the element
// instead of each point's (mean dilatation, Nagtegaal, Parks and Rice 1974), or the element would lock
// somewhat as ν → ½:
//
//   U = Σ_g w_g Ψ(F_g; λ_e) + V ½ (λ − λ_e) θ̄²,   θ̄ = Σ_g w_g θ_g / V
//
// Nodes are given as (10, 3) arrays, matrices (30, 30) are symmetric to the last bit. Inverted elements are
// evaluated like others.
#ifndef TETLAP_FEM_ELEMENT_QUADRATIC_H
#define TETLAP_FEM_ELEMENT_QUADRATIC_H

#include "fem/element/point.h"
#include "fem/material/material.h"

// λ_e / μ at most: that of ν = 1/3, so that materials up to there are integrated
// pointwise, which converges with the third order. Measured, a cantilever with two elements through its
// thickness at ν = 0.499, over the converged deflection: 0.94 with all of λ, 0.97 with 10, 0.98 with 4, 0.992
// with 2, 1.001 with 1.
#define FEM_QUADRATIC_LARGEST_RATIO 2.0

enum { FEM_QUADRATIC_NODES = 10, FEM_QUADRATIC_POINTS = 4, FEM_QUADRATIC_PARTS = 8 };

typedef struct FemQuadratic {
  double gradient[FEM_QUADRATIC_POINTS][FEM_QUADRATIC_NODES][3]; // ∂N_a/∂X at each point [1/m]
  double weight[FEM_QUADRATIC_POINTS];                           // of the volume at rest [m³]
  double volume;                                                 // their sum
} FemQuadratic;

// What resists in an element: pointwise, and by the mean volume change.
typedef struct FemQuadraticLaw {
  const FemMaterial *local; // with λ_e, borrowed
  double bulk;              // λ − λ_e ≥ 0 [Pa]
} FemQuadraticLaw;

// The two ends of the edge whose middle is node 4 + k.
extern const int fem_quadratic_edges[6][2];

// `nodes` (10, 3) at rest, with fem_quadratic_min_jacobian > 0.
void fem_quadratic_create_curved(FemQuadratic *element, const double nodes[30]);

// The smallest det(∂X/∂L) at a point over that of the straight element of the same corners: 1 if all middles
// are in the middle, ≤ 0 where the element is inside out.
double fem_quadratic_min_jacobian(const double nodes[30]);

// Point 0 … 3, each near the corner of that number.
FemPoint fem_quadratic_point(const FemQuadratic *element, int point);

// The share of a corner and of a middle in an element's mass: the diagonal of the consistent mass matrix,
// scaled to the element's mass (Hinton, Rock and Zienkiewicz 1976). Row sums would be negative at corners.
double fem_quadratic_mass_share(int node);

// Cauchy stress [Pa] (fem_material_cauchy) in a part of the element: at the point near a corner for the parts
// 0 … 3 there (fem/mesh/mesh.h), the mean of the four points for the others.
void fem_quadratic_cauchy(const FemQuadratic *element, FemQuadraticLaw law, const double x[30], int part,
                          double stress[6]);

// det F at a point.
double fem_quadratic_det(const FemQuadratic *element, int point, const double x[30]);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// A quadrature point of an element with any number of nodes: what turns a stress into nodal forces and a
// tangent into a matrix. The linear tetrahedron, which has one point, does the same by hand
// (fem/element/element.h).
#ifndef TETLAP_FEM_ELEMENT_POINT_H
#define TETLAP_FEM_ELEMENT_POINT_H

typedef struct FemPoint {
  int node_count;              // n
  const double (*gradient)[3]; // ∂N_a/∂X [1/m], borrowed; they add up to zero     (node_count)
  double weight;               // of the volume at rest [m³]
} FemPoint;

// F = Σ_a x_a ⊗ ∂N_a/∂X, positions taken relative to node 0; Ḟ from velocities in the same way. x (n, 3).
void fem_point_deformation(const FemPoint *point, const double *x, double F[9]);

// force_a −= weight P ∂N_a/∂X; their sum is zero, to the last bit where `force` was zero. force (n, 3).
void fem_point_add_force(const FemPoint *point, const double P[9], double *force);

// K_ai,bk += weight Σ_jl ∂N_a/∂X_j ∂P_ij/∂F_kl ∂N_b/∂X_l for symmetric ∂P/∂F, in the upper half (node a ≤ b);
// fem_point_mirror makes the lower one. matrix (3n, 3n).
void fem_point_add_tangent(const FemPoint *point, const double dP[81], double *matrix);
void fem_point_mirror(int node_count, double *matrix);

#endif

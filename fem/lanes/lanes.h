// SPDX-License-Identifier: GPL-3.0-or-later
// Tetrahedra in vector lanes, linear and quadratic: forces and matrices of eight elements of one body at
// once, an element a lane. The formulas are those of fem/element/element.h and fem/material. The fourth-order
// tangent ∂P/∂F is a sum of terms (law.inc), and linear elements never form it. Each term contracted with two
// nodes' gradients g_a, g_b is a 3 × 3 block:
//
//   ∂P/∂F            between nodes a and b
//   I                g_a·g_b I
//   F ⊗ F            (F g_a)(F g_b)ᵀ
//   cof F ⊗ cof F    (cof F g_a)(cof F g_b)ᵀ
//   ∂cof F/∂F        skew matrix with entries ε_ikm (F (g_a × g_b))_m
//   F C Fᵀ           μ (g_a·g_b F Fᵀ + (F g_b)(F g_a)ᵀ) + λ (F g_a)(F g_b)ᵀ
//   S on the right   (g_a·S g_b) I
//   in the axes of F = U σ Vᵀ, U K' Uᵀ with K' of Vᵀ g_a, Vᵀ g_b
//
// Between unit vectors the blocks are ∂P/∂F itself. It is found so at each point of a quadratic element and
// contracted with its 45 pairs of nodes. The same source is compiled for each instruction set. A lane's
// result depends on its element alone.
#ifndef TETLAP_FEM_LANES_LANES_H
#define TETLAP_FEM_LANES_LANES_H

#include "fem/element/element.h"
#include "fem/element/quadratic.h"

enum {
  FEM_LANES = 8,
  FEM_LANES_ENTRIES = 78, // of the lower half of an element's matrix
  FEM_LANES_SLOTS = 14,   // of nodes, of pairs of nodes, and lengths: 4 + 6 + 4
  FEM_LANES_HALF = 465,   // of the lower half of a quadratic element's matrix
};

typedef double FemLanesRow[FEM_LANES];

// Eight elements with their nodes in ascending order. Lanes beyond the last element repeat it, and are not
// added.
typedef struct FemLanesElements {
  FemLanesRow gradient[9]; // ∂N_a/∂X_j at 3 (a − 1) + j, a = 1, 2, 3 [1/m]
  FemLanesRow volume;      // at rest [m³]
  int node[4][FEM_LANES];
  int count;  // of elements, 1 … 8
  int tet[8]; // the model's numbers
} FemLanesElements;

// Eight quadratic elements; lanes as above.
typedef struct FemLanesQuadratics {
  FemLanesRow gradient[FEM_QUADRATIC_POINTS][27]; // ∂N_a/∂X_j at 3 (a − 1) + j, a = 1 … 9 [1/m]
  FemLanesRow weight[FEM_QUADRATIC_POINTS];       // of the volume at rest [m³]
  FemLanesRow volume;                             // their sum
  int node[FEM_QUADRATIC_NODES][FEM_LANES];
  int count;
  int element[FEM_LANES]; // the model's numbers
} FemLanesQuadratics;

// Kernels of one instruction set. The entries of a matrix are ordered so: of nodes 0 … 3 the columns of their
// own lower triangle, then of the pairs 01, 02, 03, 12, 13, 23 the columns of the first node, three rows of
// the second each. Slots say where these ten blocks begin in the values of a FemMatrix; the last four are how
// long the first column of each node is.
typedef struct FemLanes {
  const char *name;
  // positions and velocities (vertices, 3); force (12) by node and coordinate.
  void (*force)(const FemMaterial *material, const FemLanesElements *e, const double *positions,
                FemLanesRow force[12]);
  void (*matrix)(const FemMaterial *material, const FemLanesElements *e, const double *positions,
                 double scale, FemLanesRow matrix[FEM_LANES_ENTRIES]);
  void (*damping_force)(const FemMaterial *material, double beta, const FemLanesElements *e,
                        const double *positions, const double *velocities, FemLanesRow force[12]);
  // stiffness_scale · (the geometric part of −∂f/∂x, see viscous.inc) + damping_scale · (−∂f/∂v).
  void (*damping_matrix)(const FemMaterial *material, double beta, const FemLanesElements *e,
                         const double *positions, const double *velocities, double stiffness_scale,
                         double damping_scale, FemLanesRow matrix[FEM_LANES_ENTRIES]);
  // Energy [J], and the power that damping dissipates [W], of each element.
  void (*energy)(const FemMaterial *material, const FemLanesElements *e, const double *positions,
                 FemLanesRow energy);
  void (*damping_power)(const FemMaterial *material, double beta, const FemLanesElements *e,
                        const double *positions, const double *velocities, FemLanesRow power);
  // Add lanes in ascending order. A lane whose first slot is −1 is left out.
  void (*scatter_force)(const FemLanesElements *e, FemLanesRow force[12], double *to);
  void (*scatter_matrix)(const FemLanesElements *e, int slots[FEM_LANES_SLOTS][FEM_LANES],
                         FemLanesRow matrix[FEM_LANES_ENTRIES], double *value);
  // The same of quadratic elements: force (30), matrix the lower half by rows, a slot for each entry, −1: the
  // matrix has none.
  void (*quadratic_force)(FemQuadraticLaw law, const FemLanesQuadratics *e, const double *positions,
                          FemLanesRow force[30]);
  void (*quadratic_matrix)(FemQuadraticLaw law, const FemLanesQuadratics *e, const double *positions,
                           double scale, FemLanesRow matrix[FEM_LANES_HALF]);
  void (*quadratic_damping_force)(const FemMaterial *material, double beta, const FemLanesQuadratics *e,
                                  const double *positions, const double *velocities, FemLanesRow force[30]);
  void (*quadratic_damping_matrix)(const FemMaterial *material, double beta, const FemLanesQuadratics *e,
                                   const double *positions, const double *velocities, double stiffness_scale,
                                   double damping_scale, FemLanesRow matrix[FEM_LANES_HALF]);
  void (*quadratic_energy)(FemQuadraticLaw law, const FemLanesQuadratics *e, const double *positions,
                           FemLanesRow energy);
  void (*quadratic_damping_power)(const FemMaterial *material, double beta, const FemLanesQuadratics *e,
                                  const double *positions, const double *velocities, FemLanesRow power);
  void (*scatter_quadratic_force)(const FemLanesQuadratics *e, FemLanesRow force[30], double *to);
  void (*scatter_quadratic_matrix)(const FemLanesQuadratics *e, int slots[FEM_LANES_HALF][FEM_LANES],
                                   FemLanesRow matrix[FEM_LANES_HALF], double *value);
} FemLanes;

// The widest kernels that this processor has, and all that it has, in an array of `*count`.
const FemLanes *fem_lanes(void);
const FemLanes *const *fem_lanes_list(int *count);

// The matrix (12, 12) of one lane, nodes in its order.
void fem_lanes_unpack(FemLanesRow matrix[FEM_LANES_ENTRIES], int lane, double dense[144]);

extern const FemLanes fem_lanes_portable;
#if defined(__x86_64__)
extern const FemLanes fem_lanes_avx2, fem_lanes_avx512;
#endif

#endif

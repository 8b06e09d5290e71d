// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of a function by damping's forces at a step, backwards: by positions and by velocities.
//
// Damping's force is trilinear (fem/lanes/viscous.inc): with F of x, Ḟ of v and L of λ, λ · f(x, v) =
// −V L:FΣ(F, Ḟ), where Σ(F, Ḟ) = C_v : sym(Fᵀ Ḟ) is symmetric in its two. So f is that of a matrix which is
// symmetric in velocities, and of positions
//
//   (∂f/∂v)ᵀ λ = f(x, λ),   (∂f/∂x)ᵀ λ = ½ (f(λ + v, x) − f(λ − v, x)),
//
// by polarisation, exact up to rounding. With the law linear f does not depend on its positions.
#ifndef TETLAP_FEM_GRADIENT_DAMPING_H
#define TETLAP_FEM_GRADIENT_DAMPING_H

#include "fem/effect/system.h"

typedef struct FemDamping {
  void *effect;          // borrowed; NULL: the scene is not damped
  const FemState *state; // borrowed
  size_t value_count;    // 3 · vertex_count
  double *now, *rate;    // by positions, by velocities                     (value_count)
  double *field, *force; // scratch                                         (value_count)
} FemDamping;

// Of a scene that is not damped, an empty one, to which nothing is ever added.
Status fem_damping_create(FemDamping *damping, const FemSystem *system);
void fem_damping_destroy(FemDamping *damping); // also of a zeroed one

// Both sums are 0 again, at this state.
void fem_damping_begin(FemDamping *damping, const FemState *state);
// Adds what a function has by forces · weight on the vertices.
Status fem_damping_pull(FemDamping *damping, const double *forces, double weight);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of a function g by damping's forces at a step, backwards: by positions and by velocities.
//
// Damping's force f(x, v) is quadratic in positions and linear in velocities (fem/lanes/viscous.inc). With F
// of x, Ḟ of v and L of λ, λ · f(x, v) = −V L : F Σ(F, Ḟ), Σ(F, Ḟ) = C_v : sym(Fᵀ Ḟ). This is symmetric in λ
// and v, so by velocities
//
//   (∂f/∂v)ᵀ λ = f(x, λ).
//
// By positions, as Σ is symmetric in its two, polarisation gives, exact up to rounding,
//
//   (∂f/∂x)ᵀ λ = ½ (f(λ + v, x) − f(λ − v, x)).
//
// With the law linear f does not depend on positions, and the last is 0.
#ifndef TETLAP_FEM_GRADIENT_EFFECT_DAMPING_H
#define TETLAP_FEM_GRADIENT_EFFECT_DAMPING_H

#include "fem/effect/system.h"

typedef struct FemDamping {
  void *effect;          // borrowed; NULL: the scene is not damped
  const FemState *state; // borrowed
  size_t value_count;    // 3 · vertex_count
  double *now, *rate;    // ∂g by positions, by velocities                  (value_count)
  double *field, *force; // scratch                                         (value_count)
} FemDamping;

// Of a scene without damping an empty one, to which nothing is ever added.
Status fem_damping_create(FemDamping *damping, const FemSystem *system);
void fem_damping_destroy(FemDamping *damping); // also of a zeroed one

// Sets both sums to 0, at this state.
void fem_damping_begin(FemDamping *damping, const FemState *state);
// Adds the derivatives of λ · f, λ = weight · forces (vertex_count, 3).
Status fem_damping_pull(FemDamping *damping, const double *forces, double weight);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of a function g by plasticity (fem/effect/elements/plasticity.h) at one step, backwards. Given
// are g's derivatives by forces, by the elastic energy and by the history that plasticity leaves for the next
// step. From them follow those by positions, by the history of the step before, and by the constants of
// materials. Those by positions through the forces are in the matrix.
#ifndef TETLAP_FEM_GRADIENT_EFFECT_YIELDING_H
#define TETLAP_FEM_GRADIENT_EFFECT_YIELDING_H

#include "fem/effect/elements/plasticity.h"
#include "fem/effect/system.h"
#include "fem/gradient/parameter.h"

typedef struct FemYielding {
  void *effect;           // borrowed; NULL: nothing yields in the scene
  const FemModel *model;  // borrowed
  const FemState *state;  // borrowed; its `last` is the step before
  double *now;            // ∂g/∂x, not through forces                     (vertex_count, 3)
  FemPlastic *after;      // ∂g by the history of this step, through later ones       (points)
  FemPlastic *before;     // ∂g by the history of the step before                     (points)
  FemPlasticSlope *parts; // ∂g by constants, of which μ, σ_y, H are set          (part_count)
  double *scaled;         // scratch                                       (vertex_count, 3)
} FemYielding;

// Of a scene in which nothing yields an empty one, to which nothing is ever added.
Status fem_yielding_create(FemYielding *yielding, const FemSystem *system);
void fem_yielding_destroy(FemYielding *yielding); // also of a zeroed one

// Goes to a step: what was `before` is `after` there, all else is 0.
void fem_yielding_begin(FemYielding *yielding, const FemState *state);
// Adds what g has through `after`.
void fem_yielding_pull_history(FemYielding *yielding);
// Adds the derivatives of λ · f, λ = weight · forces (vertex_count, 3).
void fem_yielding_pull(FemYielding *yielding, const double *forces, double weight);
// Adds those of `weight` times the elastic energy that plasticity counts.
void fem_yielding_pull_energy(FemYielding *yielding, double weight);
// ∂g/∂p by a constant of a material, at fixed positions.
double fem_yielding_change(const FemYielding *yielding, const FemParameter *parameter);

#endif

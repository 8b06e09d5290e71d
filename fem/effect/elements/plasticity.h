// SPDX-License-Identifier: GPL-3.0-or-later
// The inside of the effect `plasticity`, for output and derivatives.
#ifndef TETLAP_FEM_EFFECT_ELEMENTS_PLASTICITY_H
#define TETLAP_FEM_EFFECT_ELEMENTS_PLASTICITY_H

#include "fem/effect/state.h"
#include "fem/material/plastic.h"

// Adds the reduction of stress by the plastic strain of a tetrahedron at a state to its Cauchy stress [Pa]
// (xx, yy, zz, xy, yz, xz): at the point near its corner, or the mean, as in fem/element/quadratic.h.
void fem_effect_plasticity_add_stress(const void *self, int tet, const FemState *state, double stress[6]);

// Where the system's states have what it remembers: a FemPlastic for each of its points.
int fem_effect_plasticity_place(const void *self);
int fem_effect_plasticity_count(const void *self); // points

// Derivatives of a function g at one step, backwards: those by forces, by the elastic energy and by the
// history after the step become those by positions, by the history of the step before, and by constants.
typedef struct FemPlasticitySlope {
  double *now;            // by positions                                    (vertex_count, 3)
  FemPlastic *before;     // by the history of the step before               (points)
  FemPlasticSlope *parts; // by the constants of each of the model's parts   (part_count)
} FemPlasticitySlope;

// Adds those of λ · f (vertex_count, 3), but for `now`: the matrix is that of these forces.
void fem_effect_plasticity_pull_forces(const void *self, const FemState *state, const double *forces,
                                       const FemPlasticitySlope *slope);
// Adds those of `energy` times the elastic energy that plasticity counts, and those of what is remembered, by
// whose numbers g's derivatives are `after` (points).
void fem_effect_plasticity_pull_history(const void *self, const FemState *state, double energy,
                                        const FemPlastic *after, const FemPlasticitySlope *slope);

#endif

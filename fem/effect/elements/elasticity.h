// SPDX-License-Identifier: GPL-3.0-or-later
// The elasticity effect's inside, for what a run keeps account of.
#ifndef TETLAP_FEM_EFFECT_ELEMENTS_ELASTICITY_H
#define TETLAP_FEM_EFFECT_ELEMENTS_ELASTICITY_H

#include "fem/effect/state.h"

// What the elements of each body store by their own law [J] (body_count), obstacles 0; of the effect that
// fem_system_effect(system, &fem_effect_elasticity) returned. All ranks call this and have the same.
void fem_effect_elasticity_energies(void *effect, const FemState *state, double *energies);

#endif

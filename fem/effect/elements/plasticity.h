// SPDX-License-Identifier: GPL-3.0-or-later
// The inside of the effect `plasticity`, for output.
#ifndef TETLAP_FEM_EFFECT_ELEMENTS_PLASTICITY_H
#define TETLAP_FEM_EFFECT_ELEMENTS_PLASTICITY_H

#include "fem/effect/state.h"

// Adds the reduction of stress by the plastic strain of a tetrahedron at a state to its Cauchy stress [Pa]
// (xx, yy, zz, xy, yz, xz): at the point near its corner, or the mean, as in fem/element/quadratic.h.
void fem_effect_plasticity_add_stress(const void *self, int tet, const FemState *state, double stress[6]);

#endif

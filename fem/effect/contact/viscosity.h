// SPDX-License-Identifier: GPL-3.0-or-later
// Viscous contact's forces, for output.
#ifndef TETLAP_FEM_EFFECT_CONTACT_VISCOSITY_H
#define TETLAP_FEM_EFFECT_CONTACT_VISCOSITY_H

#include "fem/effect/state.h"

// Adds the forces of the effect that fem_system_effect(system, &fem_effect_viscosity) returned, at a state:
// on the first side of each interface (interface_count, 3) and on the vertices (vertex_count, 3) [N]; either
// NULL: not wanted.
Status fem_effect_viscosity_add(const void *effect, const FemState *state, double (*interfaces)[3],
                                double *vertices);
// Adds their moments about the origin [N m] (interface_count, 3).
Status fem_effect_viscosity_add_moments(const void *effect, const FemState *state, double (*moments)[3]);

#endif

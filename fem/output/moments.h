// SPDX-License-Identifier: GPL-3.0-or-later
// The moments of the forces of contact, friction and viscosity included, as forces.h has the forces.
#ifndef TETLAP_FEM_OUTPUT_MOMENTS_H
#define TETLAP_FEM_OUTPUT_MOMENTS_H

#include "fem/effect/system.h"

// On the first side of each interface, about the origin [N m] (interface_count, 3), at a state. Of an
// interface at rest the moment of its force at its centre of pressure; of a body and itself 0. Without
// contact nothing is written.
Status fem_moments_find(const FemSystem *system, const FemState *state, double (*moments)[3]);

#endif

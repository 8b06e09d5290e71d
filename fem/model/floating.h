// SPDX-License-Identifier: GPL-3.0-or-later
// A velocity that all bodies share and that nothing in the scene can notice (Galileo): bodies that float, or
// that only half-spaces without friction obstruct, move in one frame as in any other. What a run decides by
// speeds and energies — tolerances, first steps, the default stiffness, shares of energy and momentum — is
// relative to it.
#ifndef TETLAP_FEM_MODEL_FLOATING_H
#define TETLAP_FEM_MODEL_FLOATING_H

#include "base/vec3.h"
#include "fem/model/model.h"

// Whether nothing holds, drives, loads or obstructs a body: then gravity accelerates all alike, and moves
// their centre of mass alone.
bool fem_model_floats(const FemModel *model);

// Of all bodies [kg].
double fem_model_mass(const FemModel *model);

// The part of the velocity of the centre of mass that nothing can notice: all of it where bodies float, that
// along the planes where half-spaces without friction are the only obstacles, else none.
Vec3 fem_model_common_part(const FemModel *model, Vec3 velocity);

// That of the velocities at the start [m/s].
Vec3 fem_model_common_start(const FemModel *model);

#endif

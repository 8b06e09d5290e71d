// SPDX-License-Identifier: GPL-3.0-or-later
// The velocity that all bodies have in common and that changes nothing in the scene (Galilean invariance).
// Bodies that float, or that only half-spaces without friction obstruct, move alike in every inertial frame.
// Whatever a run decides by speeds and energies (tolerances, first steps, the default stiffness, shares of
// energy and momentum) is relative to it.
#ifndef TETLAP_FEM_MODEL_FLOATING_H
#define TETLAP_FEM_MODEL_FLOATING_H

#include "base/vec3.h"
#include "fem/model/model.h"

// `released` [s]: what is due until then has been released; 0: nothing.

// Whether no body is held, driven, loaded or obstructed: then gravity accelerates all alike and moves only
// their centre of mass.
bool fem_model_floats(const FemModel *model, double released);

// Of all bodies [kg].
double fem_model_mass(const FemModel *model);

// Of a body's mass at rest [m].
Vec3 fem_model_centre(const FemModel *model, const FemModelBody *body);

// The part of the velocity of the centre of mass that changes nothing: all of it where bodies float; the part
// along the planes where half-spaces without friction are the only obstacles; else none.
Vec3 fem_model_common_part(const FemModel *model, double released, Vec3 velocity);

// That of the velocities at the start [m/s].
Vec3 fem_model_common_start(const FemModel *model);

#endif

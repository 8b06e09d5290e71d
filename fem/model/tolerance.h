// SPDX-License-Identifier: GPL-3.0-or-later
// What may err and count as rest in a run: the scene's numbers, or those chosen for it.
#ifndef TETLAP_FEM_MODEL_TOLERANCE_H
#define TETLAP_FEM_MODEL_TOLERANCE_H

#include "fem/model/model.h"

// Error per step of a position [m]: the scene's tolerance times the smallest body's diagonal, 0.03 of that in
// motion without contact.
double fem_model_position_tolerance(const FemModel *model);

// Error per step of a velocity [m/s]: the scene's, or its tolerance times the lesser of two shares, with the
// numbers of fem/model/limits.h:
//   0.03 of the slowest body's wave speed √(E/ρ); all of it without contact, or where a body rubs on itself;
//   0.03 of ten times the expected speed; all of that without contact.
// The expected speed is the fastest at t = 0 without what nothing notices of it (fem/model/floating.h), or
// √(g L) where that is more, L the smallest body's diagonal.
double fem_model_velocity_tolerance(const FemModel *model);

// Share of the fastest body's present speed that a velocity may err by beside that, where there is contact
// (fem/time/error_weights.h); 0 where the scene says how far.
double fem_model_speed_share(const FemModel *model);

// What counts as rest (fem/run/rest/rest.h) [m/s], [m/s²], [s]: the scene's, or chosen.
double fem_model_rest_speed(const FemModel *model);
double fem_model_rest_acceleration(const FemModel *model);
double fem_model_rest_time(const FemModel *model);

#endif

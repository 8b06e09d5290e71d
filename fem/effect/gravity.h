// SPDX-License-Identifier: GPL-3.0-or-later
// Gravity of a static scene grows from zero to its full value until the first frame. Increasing it does work
// on the bodies, as driving vertices does.
#ifndef TETLAP_FEM_EFFECT_GRAVITY_H
#define TETLAP_FEM_EFFECT_GRAVITY_H

#include "fem/model/model.h"

// s, how much of gravity acts: 1 in a motion.
double fem_gravity_share(const FemModel *model, double time);

// The work −Δs Σ m g · (x − X) of increasing gravity by a share Δs at these positions (vertex_count, 3)
// [J].
double fem_gravity_ramp_work(const FemModel *model, double share, const double *positions);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// What a static scene asks of loads: how far the trapezoidal rule may be wrong about their work.
#ifndef TETLAP_FEM_EFFECT_LOADS_H
#define TETLAP_FEM_EFFECT_LOADS_H

#include "fem/effect/system.h"

// Along the step to a state: what the loads at its end would do, less what those at its begin would [J]; 0
// where there are none.
Status fem_effect_loads_change(const FemSystem *system, const FemState *state, double *change);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// A static run goes on by steps of load, each of which ends in equilibrium (fem/statics/statics.h).
#ifndef TETLAP_FEM_RUN_RUN_LOAD_H
#define TETLAP_FEM_RUN_RUN_LOAD_H

#include "fem/run/run_state.h"

// One step of load, halved where there is no equilibrium: solved, measured, written, observed. The run's
// `next_step` is what to try next. STATUS_SOLVER: it has become too short; STATUS_INTERRUPTED.
Status fem_run_load_advance(FemRunState *run);

#endif

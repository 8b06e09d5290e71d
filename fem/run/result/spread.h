// SPDX-License-Identifier: GPL-3.0-or-later
// Time, memory and work of a run over its ranks (base/ranks.h): least, mean and most of each.
#ifndef TETLAP_FEM_RUN_RESULT_SPREAD_H
#define TETLAP_FEM_RUN_RESULT_SPREAD_H

#include "fem/run/run_state.h"

// Into the run's result, by all ranks, once its phases are summed. One process: nothing.
void fem_run_spread_collect(const FemRunState *run, FemRunResult *result);

#endif

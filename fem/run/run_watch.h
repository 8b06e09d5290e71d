// SPDX-License-Identifier: GPL-3.0-or-later
// Who looks on while a run goes on: trouble is counted in every accepted state, the caller is told of it, and
// may stop the run.
#ifndef TETLAP_FEM_RUN_RUN_WATCH_H
#define TETLAP_FEM_RUN_RUN_WATCH_H

#include "fem/run/run_state.h"

// Of an accepted state and what was measured in it. STATUS_SOLVER: with --strict, what is trouble there;
// STATUS_INTERRUPTED; what the observer answers.
Status fem_run_watch(FemRunState *run, FemMeasures *measures);

// At the end: who is beyond the middle of another has passed it, too. STATUS_SOLVER as above.
Status fem_run_watch_passages(FemRunState *run);

#endif

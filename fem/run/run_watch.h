// SPDX-License-Identifier: GPL-3.0-or-later
// Trouble is counted in every accepted state and reported to the caller, who may stop the run.
#ifndef TETLAP_FEM_RUN_RUN_WATCH_H
#define TETLAP_FEM_RUN_RUN_WATCH_H

#include "fem/run/run_state.h"

// Examines an accepted state by what was measured in it. STATUS_SOLVER: trouble, with --strict;
// STATUS_INTERRUPTED; the Status of the observer.
Status fem_run_watch(FemRunState *run, FemMeasures *measures);

// Before the state of a time step is accepted, by the trouble that was found in it. STATUS_SOLVER: an element
// would leave another body on the opposite side; the message says which, when, and what to write instead.
Status fem_run_watch_refuse(FemRunState *run, double time, const FemTroubleState *found);

// STATUS_INTERRUPTED once the caller has asked the run to stop; the message says when.
Status fem_run_watch_stop(const FemRunState *run);

// At the end: a body beyond the middle of another counts as having passed through it. STATUS_SOLVER as above.
Status fem_run_watch_passages(FemRunState *run);

#endif

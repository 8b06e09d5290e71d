// SPDX-License-Identifier: GPL-3.0-or-later
// The pair at which an overlap model failed and ended a run, as a file for `tetlap overlap`.
#ifndef TETLAP_FEM_RUN_RUN_BLAME_H
#define TETLAP_FEM_RUN_RUN_BLAME_H

#include "fem/run/run_state.h"

// Of a run that fails with `status` and the thread's message. Where there are such a pair and a directory,
// writes unsound_pair.csv there and says so at the end of the message. Returns `status`.
Status fem_run_blame_pair(const FemRunState *run, Status status);
// Removes that of an earlier run.
Status fem_run_blame_clear(const FemRunState *run);

#endif

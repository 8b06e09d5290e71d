// SPDX-License-Identifier: GPL-3.0-or-later
// Wall time of a part of a run that no phase within it has named.
#ifndef TETLAP_FEM_RUN_RESULT_RUN_CLOCK_H
#define TETLAP_FEM_RUN_RESULT_RUN_CLOCK_H

#include "fem/run/run_state.h"

typedef struct FemRunSpan {
  double began_s, named_s;
} FemRunSpan;

FemRunSpan fem_run_clock_begin(const FemRunState *run);
// Adds what has passed since, without what other phases have been given in between, to a phase of the result.
void fem_run_clock_end(const FemRunState *run, FemRunSpan span, double *phase);

#endif

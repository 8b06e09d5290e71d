// SPDX-License-Identifier: GPL-3.0-or-later
// One step of a motion:
//
//     propose ─► judge ─► show ─► commit        the only place where the run's state changes
//        ▲         │        │
//        └─────────┴────────┘  does not stand: a shorter step from the last accepted state
//
// `propose` lets IDA step (its error test, Newton's method and the run's stall are there,
// fem/time/integrator.h) and measures where that leads; `judge` asks energy, momentum and friction
// (fem/time/verdict.h); `show` writes what lies within the step.
#ifndef TETLAP_FEM_RUN_RUN_STEP_H
#define TETLAP_FEM_RUN_RUN_STEP_H

#include "fem/run/run_state.h"

// One step, committed or to be tried again. STATUS_SOLVER: no shorter step is left, or the run stalls.
Status fem_run_step_advance(FemRunState *run);

#endif

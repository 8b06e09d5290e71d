// SPDX-License-Identifier: GPL-3.0-or-later
// The loop of a run, in parts: what fem_run (run.h) goes through by itself, and a session (session.h) turn by
// turn. For these two only.
#ifndef TETLAP_FEM_RUN_RUN_LOOP_H
#define TETLAP_FEM_RUN_RUN_LOOP_H

#include "fem/run/run_state.h"

// The run's first state, or that of its checkpoint. `model`, `options` and `result` are borrowed until the
// end; after a failure, too, fem_run_loop_end must follow.
Status fem_run_loop_begin(FemRunState *run, const FemModel *model, const FemRunOptions *options,
                          FemRunResult *result);

// One step, committed or to be tried again; then a checkpoint where one is due.
Status fem_run_loop_turn(FemRunState *run);

// Takes a checkpoint and begins anew from it, as everything does that is resumed from it.
Status fem_run_loop_begin_anew(FemRunState *run);

// Begins anew from another checkpoint of this model, which is copied. STATUS_INPUT: it is of another one.
Status fem_run_loop_restore(FemRunState *run, const FemCheckpoint *from);

// Adds to the message of a failed turn the time at which it failed, unless the message says it. A step that
// no shorter one can replace (RETRY) becomes a failure of the solver.
Status fem_run_loop_explain(const FemRunState *run, Status status);

// Fills the result as far as the run came and frees all else; `status` of the last turn.
Status fem_run_loop_end(FemRunState *run, Status status);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The checkpoints of a run that goes on: when one is due, what it holds, and whether its file is written.
#ifndef TETLAP_FEM_RUN_CHECKPOINT_RUN_CHECKPOINT_H
#define TETLAP_FEM_RUN_CHECKPOINT_RUN_CHECKPOINT_H

#include "fem/run/run_state.h"

// After the steps counted in `stats` (fem_run_state_stats). Where the scene does not say how many frames lie
// between two, it depends on steps alone, and a run that is not calm waits.
bool fem_run_checkpoint_is_due(const FemRunState *run, const FemIntegratorStats *stats);

// Takes the state between two parts as the checkpoint that the next one begins from, and offers it; what a
// static part reached is given. After a failure the former checkpoint stands.
Status fem_run_checkpoint_take(FemRunState *run, double force_scale, double driven_work);

// Writes the checkpoint if the last one that was written is old enough.
Status fem_run_checkpoint_offer(FemRunState *run);

// Removes those of an earlier run, and its end state.
Status fem_run_checkpoint_remove(const FemRunState *run);

// At the end: a run that was stopped, or failed for want of room, may be taken up; one that has ended, or
// came to where its solver gives up, leaves its last state, from which another may start.
Status fem_run_checkpoint_leave(FemRunState *run, Status status);

// How many steps lie between two checkpoints where the scene does not say how many frames.
long long fem_run_checkpoint_steps(int unknown_count);

#endif

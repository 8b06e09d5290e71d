// SPDX-License-Identifier: GPL-3.0-or-later
// Between a run and its checkpoints: what is taken from the one for the other.
#ifndef TETLAP_FEM_RUN_CHECKPOINT_RESTART_H
#define TETLAP_FEM_RUN_CHECKPOINT_RESTART_H

#include "fem/effect/system.h"
#include "fem/run/checkpoint/checkpoint.h"

// The checkpoint with which a run begins that is not resumed: initial velocities, what the model starts with
// (fem/model/start.h), and displacements (vertex_count, 3) unless NULL.
Status fem_restart_begin(FemCheckpoint *checkpoint, const FemModel *model, const double *displacement);

// Makes a checkpoint with the state, whose unknowns are u and v, the effects' histories and the counts so
// far. These include the system's; all else is the caller's. After a failure there is nothing to destroy.
Status fem_restart_collect(FemCheckpoint *checkpoint, const FemSystem *system, const FemState *state,
                           const double *u, const double *v, const FemRunResult *so_far);

// Whether the checkpoint belongs to a run of that model. STATUS_INPUT says what does not fit.
Status fem_restart_check(const FemCheckpoint *checkpoint, const FemModel *model);

// The other way: the unknowns u, v; and, once a system has begun there, what its effects remember.
void fem_restart_load(const FemCheckpoint *checkpoint, const FemNumbering *numbering, double *u, double *v);
Status fem_restart_remember(const FemCheckpoint *checkpoint, FemSystem *system);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// A checkpoint: all that a run needs to go on, and its file.
//
// The inner state of the integrator, a factorisation and contact lists cannot be saved. So at a checkpoint
// the running run discards it, too, and begins anew from these data, exactly as a run does that is resumed
// from the file. What follows is therefore the same to the last bit.
//
// The file is HDF5 (h5dump and h5py read it) behind a block of 512 bytes of text. The block holds the
// format, and the size and the digest of the rest: damage is found before HDF5 sees it. Every number has an
// attribute `unit`, the root the attribute `format`.
#ifndef TETLAP_FEM_RUN_CHECKPOINT_CHECKPOINT_H
#define TETLAP_FEM_RUN_CHECKPOINT_CHECKPOINT_H

#include <stddef.h>

#include "base/files/journal.h"
#include "fem/run/result/run_result.h"
#include "fem/time/audit.h"

enum { FEM_CHECKPOINT_NAME = 32 };
// In the run's folder: what a run that was stopped goes on from, and the state in which one ended.
static const char FEM_CHECKPOINT_FILE[] = "checkpoint.h5", FEM_CHECKPOINT_END[] = "end.h5";

// What an effect remembers (fem/effect/state.h).
typedef struct FemCheckpointEffect {
  char name[FEM_CHECKPOINT_NAME];
  double *values; // owned                                         (count)
  size_t count;
} FemCheckpointEffect;

typedef struct FemCheckpoint {
  char *origin; // JSON: what the run was started with; the program's, not read here. Owned; NULL: none
  int vertex_count;
  double time;          // [s]
  double step;          // to be tried next; 0: the integrator's choice [s]
  double *displacement; // from rest [m], owned                     (vertex_count, 3)
  double *velocity;     // [m/s], owned                             (vertex_count, 3)
  int next_frame;       // number of the frame to come
  JournalMark history;  // what history.csv holds; its size is 0 if none is written
  FemAudit audit;
  double force_scale, driven_work; // of a static scene [N], [J]
  FemRunResult so_far; // numbers and counters; its names, trajectory and effects' names are not kept
  FemCheckpointEffect effects[FEM_MAX_EFFECTS]; // in the system's order; costs in so_far (effect_count)
  int effect_count;
  char *interfaces; // those of contact in the system's order, a line "A, B" each; owned
  double *ledger;   // what a run keeps account of (fem/measure/ledger.h), owned       (ledger_count)
  size_t ledger_count;
  double *rest; // bodies at rest (fem/run/rest/rest.h), owned                            (rest_count)
  size_t rest_count;
} FemCheckpoint;

// A run's beginning: everything zero. STATUS_MEMORY.
Status fem_checkpoint_create(FemCheckpoint *checkpoint, int vertex_count);
Status fem_checkpoint_copy(FemCheckpoint *copy, const FemCheckpoint *checkpoint);
void fem_checkpoint_destroy(FemCheckpoint *checkpoint); // also of a zeroed one

// Whole or not at all. STATUS_IO names the file and the system's reason.
Status fem_checkpoint_write(const FemCheckpoint *checkpoint, const char *path);

// STATUS_IO: cannot be read; STATUS_INPUT: is none, of another format, cut short, damaged, or lacks
// something, which the message names. After a failure there is nothing to destroy.
Status fem_checkpoint_read(FemCheckpoint *checkpoint, const char *path);

#endif

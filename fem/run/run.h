// SPDX-License-Identifier: GPL-3.0-or-later
// A whole run of a scene: model → system → integrator (or, in a static scene, fem/time/statics.h) → frames.
//
//     step ──► energy audit ──► frames up to its time (interpolated) ──► accept: effects renew their lists
//      ▲            │ gains too much: back to the last accepted state, smaller step, order 1        │
//      ├────────────┴───────────────────────────── onset of a contact: restart at the root ◄─────────┤
//      └── system and integrator begin anew from the checkpoint (checkpoint.h) ◄─── when one is due ───┘
//
// A checkpoint is due after so many frames, whatever the clock says, so that two runs of a scene are the
// same; the clock only says whether it is written to checkpoint.h5. A run that is stopped, or that fails
// because nothing can be written or allocated, leaves its last checkpoint there; one that reaches its end,
// none.
#ifndef TETLAP_FEM_RUN_RUN_H
#define TETLAP_FEM_RUN_RUN_H

#include <signal.h>

#include "fem/output/recorder.h"
#include "fem/run/run_result.h"

// What an observer sees after every accepted step.
typedef struct FemRunProgress {
  FemSystem *system; // scattered at `time`; an observer may evaluate, not change it
  double time, end;  // [s]
  double step;       // last step size [s]
  long long step_count;
  int active_pairs;
  const FemMeasures *measures; // of this state; borrowed
  const FemAudit *audit;       // borrowed
  const FemTrouble *trouble;   // so far; borrowed
  bool has_trouble_begun;      // in this step
} FemRunProgress;

typedef struct FemRunOptions {
  const char *directory; // where to write; NULL: nowhere
  const volatile sig_atomic_t
      *stop; // becomes non-zero: finish the step, then STATUS_INTERRUPTED; may be NULL
  Status (*observe)(void *observer, const FemRunProgress *progress); // may be NULL
  void *observer;
  const double *initial_displacement; // from rest [m], or NULL: none    (vertex_count, 3)
  const struct FemCheckpoint *from;   // go on from there; NULL: from the start; borrowed
  const char *origin;                 // JSON, kept in the checkpoints for whoever resumes; may be NULL
  bool is_strict;       // an energy gain beyond FEM_TROUBLE_ENERGY_BOUND ends the run: STATUS_SOLVER
  bool keep_trajectory; // keep positions and interface forces of every frame in the result
} FemRunOptions;

// The solver that a model gets: the scene's, or by size for `auto`.
FemSolverKind fem_run_solver(const FemModel *model);

// How many steps lie between two checkpoints where the scene does not say how many frames.
long long fem_run_checkpoint_steps(int unknown_count);

// Runs the model to its end. `result` is filled as far as the run came also when it fails; destroy it always.
Status fem_run(const FemModel *model, const FemRunOptions *options, FemRunResult *result);
#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// What a run is asked for, and what it shows while it goes on.
#ifndef TETLAP_FEM_RUN_RUN_OPTIONS_H
#define TETLAP_FEM_RUN_RUN_OPTIONS_H

#include <signal.h>

#include "fem/output/recorder.h"

// What an observer sees after every accepted step.
typedef struct FemRunProgress {
  FemSystem *system; // its accepted state is that at `time`; an observer may evaluate, not change it
  double time, end;  // [s]
  double step;       // last step size [s]
  long long step_count;
  const FemMeasures *measures; // of this state; borrowed
  const FemAudit *audit;       // borrowed
  double energy_rise;        // of the audited total above its lowest value, as a share of the scene's energy
  double energy_bound;       // what that may be at most
  const FemTrouble *trouble; // so far; borrowed
  bool has_trouble_begun;    // in this step
} FemRunProgress;

typedef struct FemRunOptions {
  const char *directory; // where to write; NULL: nowhere
  // Becomes non-zero: finish the step, then STATUS_INTERRUPTED. May be NULL.
  const volatile sig_atomic_t *stop;
  Status (*observe)(void *observer, const FemRunProgress *progress); // may be NULL
  void *observer;
  const double *initial_displacement; // from rest [m], or NULL: none    (vertex_count, 3)
  const struct FemCheckpoint *from;   // go on from there; NULL: from the start; borrowed
  const char *origin;                 // JSON, kept in the checkpoints for those who resume; may be NULL
  bool is_strict;       // an energy gain beyond the run's bound (fem/time/audit.h) ends it: STATUS_SOLVER
  bool keep_trajectory; // keep positions and interface forces of every frame in the result
} FemRunOptions;

#endif

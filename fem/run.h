// SPDX-License-Identifier: GPL-3.0-or-later
// A whole run of a scene: model → system → integrator (or, in a static scene, fem/statics.h) → frames.
//
//     step ──► energy audit ──► frames up to its time (interpolated) ──► accept: effects renew their lists
//      ▲            │ gains too much: back to the last accepted state, smaller step, order 1        │
//      └────────────┴───────────────────────────── onset of a contact: restart at the root ◄─────────┘
#ifndef TETLAP_FEM_RUN_H
#define TETLAP_FEM_RUN_H

#include <signal.h>

#include "base/record.h"
#include "fem/audit.h"
#include "fem/integrator.h"
#include "fem/recorder.h"

// What an observer sees after every accepted step.
typedef struct FemRunProgress {
  FemSystem *system; // scattered at `time`; an observer may evaluate, not change it
  double time, end;  // [s]
  double step;       // last step size [s]
  long long step_count;
  int active_pairs;
} FemRunProgress;

typedef struct FemRunOptions {
  const char *directory; // where to write; NULL: nowhere
  const volatile sig_atomic_t
      *stop; // becomes non-zero: finish the step, then STATUS_INTERRUPTED; may be NULL
  Status (*observe)(void *observer, const FemRunProgress *progress); // may be NULL
  void *observer;
  const double *initial_displacement; // from rest [m], or NULL: none    (vertex_count, 3)
  bool keep_trajectory;               // keep positions and interface forces of every frame in the result
} FemRunOptions;

// `contact`: candidate lists, watched onsets, pressures and forces, without broad phase and overlap volumes.
// What no phase names (the energy audit, the integrator's vectors) is the difference to the total.
typedef struct FemRunPhases {
  double broad_phase, overlap, contact, forces, assembly, analysis, factorisation, solve, output,
      total; // wall [s]
} FemRunPhases;

typedef struct FemRunResult {
  double wall_s, cpu_s;
  FemRunPhases phases;
  FemIntegratorStats integrator;
  FemSolverStats solver;
  const char *solver_name;
  long long assemblies;      // of K, or K and D apart: how often the elements' matrices were added up
  long long pattern_layouts; // how often the matrix pattern was laid out
  long long energy_retries;  // steps taken back because they gained energy
  FemAudit audit;
  double end_time;         // reached [s]
  ContactPairCounts pairs; // handed to the overlap model over the whole run
  int state_unknowns;      // displacements, and in a motion as many velocities
  bool is_static;
  double residual, residual_allowed; // of the last equilibrium: largest force on an unknown [N]
  long long relaxation_steps, halvings;
  int pairs_max;
  double overlap_volume_max, contact_force_max, min_det_F, deepest_overlap_max;
  double last_contact_force; // largest interface force at the last frame [N]
  size_t peak_rss_bytes;
  Record *counters; // owned
  int effect_count; // those that the scene called for
  struct {
    const char *name; // borrowed
    FemEffectCost cost;
  } effects[FEM_MAX_EFFECTS]; //                                  (effect_count)
  // With keep_trajectory:
  int frame_count, vertex_count, interface_count;
  char **interface_names;   // "a, b", owned                       (interface_count)
  double *frame_times;      //                                     (frame_count)
  double *trajectory;       // positions [m]                       (frame_count, vertex_count, 3)
  double *interface_forces; // on the first side [N]               (frame_count, interface_count, 3)
} FemRunResult;

// The solver that a model gets: the scene's, or by size for `auto`.
FemSolverKind fem_run_solver(const FemModel *model);

// Runs the model to its end. `result` is filled as far as the run came also when it fails; destroy it always.
Status fem_run(const FemModel *model, const FemRunOptions *options, FemRunResult *result);
void fem_run_result_destroy(FemRunResult *result);

// summary.json of a run.
void fem_run_summarise(const FemRunResult *result, Record *summary);

#endif

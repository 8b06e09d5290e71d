// SPDX-License-Identifier: GPL-3.0-or-later
// A scene that is run repeatedly, without writing anything.
#ifndef TETLAP_LAB_TRIAL_H
#define TETLAP_LAB_TRIAL_H

#include "app/bench/timer.h"
#include "fem/model/model.h"
#include "fem/run/run.h"

// Must not be moved once it is begun: the model points at the scene.
typedef struct LabTrial {
  FemSceneDef scene;     // owned
  FemModel model;        // owned
  long long step_limit;  // a run ends after so many steps; 0: at the scene's end
  double wall_limit_s;   // a run ends after so long; 0: at the scene's end
  bool keeps_trajectory; // in the result
  bool accepts_failure;  // a run that the solver gives up is a result too: see `outcome`
  Status (*watch)(void *watcher, const FemRunProgress *progress); // after each accepted step; may be NULL
  void *watcher;
  AppBenchTimer timer;
  FemRunPhases *phases; // by round                     (repeats)
  FemRunResult result;  // of the last round, owned
  Status outcome;    // of the last round: OK, also at the step limit; INTERRUPTED at the wall limit; SOLVER
  char message[256]; // why it was not OK
  double run_began_s;
} LabTrial;

// "finished", "cut short" (the wall limit) or "failed" (the solver gave up).
const char *lab_trial_outcome(const LabTrial *trial);

// `trial->scene` has been read (a failed reading leaves it zeroed); builds the model. A zeroed trial, and one
// whose beginning failed, can be ended.
Status lab_trial_begin(LabTrial *trial, const AppBenchOptions *options, long long step_limit);
void lab_trial_end(LabTrial *trial);

// One run; an AppBenchAct.
Status lab_trial_run(void *trial, int round);

// The phases of the round whose wall time is the median.
FemRunPhases lab_trial_phases(const LabTrial *trial, int rounds);

// The phases by name; `other` is what the named ones leave of the total [s].
enum { LAB_TRIAL_PHASE_COUNT = 10 };
extern const char *const lab_trial_phase_names[LAB_TRIAL_PHASE_COUNT];
void lab_trial_split(const FemRunPhases *phases, double seconds[LAB_TRIAL_PHASE_COUNT]);

#endif

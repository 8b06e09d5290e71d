// SPDX-License-Identifier: GPL-3.0-or-later
// A scene that is run repeatedly, without writing anything.
#ifndef TETLAP_APP_BENCH_TRIAL_H
#define TETLAP_APP_BENCH_TRIAL_H

#include "app/bench/timer.h"
#include "fem/model/model.h"
#include "fem/run/run.h"

// Must not be moved once it is begun: the model points at the scene.
typedef struct AppBenchTrial {
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
} AppBenchTrial;

// "finished", "cut short" (the wall limit) or "failed" (the solver gave up).
const char *app_bench_trial_outcome(const AppBenchTrial *trial);

// `trial->scene` has been read (a failed reading leaves it zeroed); builds the model. A zeroed trial, and one
// whose beginning failed, can be ended.
Status app_bench_trial_begin(AppBenchTrial *trial, const AppBenchOptions *options, long long step_limit);
void app_bench_trial_end(AppBenchTrial *trial);

// One run; an AppBenchAct.
Status app_bench_trial_run(void *trial, int round);

// The phases of the round whose wall time is the median.
FemRunPhases app_bench_trial_phases(const AppBenchTrial *trial, int rounds);

// The phases by name; `other` is what the named ones leave of the total [s].
enum { APP_BENCH_PHASE_COUNT = 10 };
extern const char *const app_bench_phases[APP_BENCH_PHASE_COUNT];
void app_bench_trial_split(const FemRunPhases *phases, double seconds[APP_BENCH_PHASE_COUNT]);

#endif

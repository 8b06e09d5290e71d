// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/trial.h"

#include <omp.h>
#include <stdio.h>

#include "base/clock.h"
#include "base/memory.h"
#include "fem/model/build.h"

Status lab_trial_begin(LabTrial *trial, const AppBenchOptions *options, long long step_limit) {
  trial->step_limit = step_limit;
  trial->scene.threads = options->threads;
  omp_set_num_threads(options->threads);
  trial->phases = memory_zeroed((size_t)options->repeats, sizeof *trial->phases);
  if (!trial->phases) return status_no_memory("the phases of the rounds");
  return fem_model_create(&trial->model, &trial->scene);
}

void lab_trial_end(LabTrial *trial) {
  fem_run_result_destroy(&trial->result);
  fem_model_destroy(&trial->model);
  fem_scene_destroy(&trial->scene);
  memory_free(trial->phases);
}

// Ends the run as Ctrl-C would, once it has made its steps or used its time.
static Status stop_at_limit(void *self, const FemRunProgress *progress) {
  LabTrial *trial = self;
  if (trial->watch) TRY(trial->watch(trial->watcher, progress));
  if (trial->step_limit > 0 && progress->step_count >= trial->step_limit)
    return status_fail(STATUS_INTERRUPTED, "the trial's last step was made");
  if (trial->wall_limit_s > 0 && clock_wall_s() - trial->run_began_s > trial->wall_limit_s) {
    trial->outcome = STATUS_INTERRUPTED;
    return status_fail(STATUS_INTERRUPTED, "t = %g s of %g s was reached in %g s", progress->time,
                       progress->end, trial->wall_limit_s);
  }
  return STATUS_OK;
}

Status lab_trial_run(void *self, int round) {
  LabTrial *trial = self;
  FemRunOptions options = {
      .observe = stop_at_limit, .observer = trial, .keep_trajectory = trial->keeps_trajectory};
  fem_run_result_destroy(&trial->result);
  omp_set_num_threads(trial->scene.threads);
  trial->outcome = STATUS_OK;
  trial->message[0] = 0;
  trial->run_began_s = clock_wall_s();
  app_bench_timer_start(&trial->timer);
  Status status = fem_run(&trial->model, &options, &trial->result);
  app_bench_timer_stop(&trial->timer, round, 1);
  trial->phases[round] = trial->result.phases;
  if (status == STATUS_SOLVER) trial->outcome = STATUS_SOLVER;
  if (trial->outcome != STATUS_OK) snprintf(trial->message, sizeof trial->message, "%s", status_message());
  bool is_result = status == STATUS_INTERRUPTED || (status == STATUS_SOLVER && trial->accepts_failure);
  return is_result ? STATUS_OK : status;
}

const char *lab_trial_outcome(const LabTrial *trial) {
  return trial->outcome == STATUS_OK            ? "finished"
         : trial->outcome == STATUS_INTERRUPTED ? "cut short"
                                                : "failed";
}

FemRunPhases lab_trial_phases(const LabTrial *trial, int rounds) {
  return trial->phases[app_bench_timer_median_round(&trial->timer, rounds)];
}

const char *const lab_trial_phase_names[LAB_TRIAL_PHASE_COUNT] = {
    "broad_phase", "overlap",       "contact", "forces", "assembly",
    "analysis",    "factorisation", "solve",   "output", "other"};

void lab_trial_split(const FemRunPhases *phases, double seconds[LAB_TRIAL_PHASE_COUNT]) {
  const double named[LAB_TRIAL_PHASE_COUNT - 1] = {phases->broad_phase,   phases->overlap,  phases->contact,
                                                   phases->forces,        phases->assembly, phases->analysis,
                                                   phases->factorisation, phases->solve,    phases->output};
  double other = phases->total;
  for (int p = 0; p < LAB_TRIAL_PHASE_COUNT - 1; p++) {
    seconds[p] = named[p];
    other -= named[p];
  }
  seconds[LAB_TRIAL_PHASE_COUNT - 1] = other;
}

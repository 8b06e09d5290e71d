// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench_trial.h"

#include <omp.h>

#include "base/memory.h"

Status app_bench_trial_begin(AppBenchTrial *trial, const AppBenchOptions *options, long long step_limit) {
  trial->step_limit = step_limit;
  trial->scene.threads = options->threads;
  omp_set_num_threads(options->threads);
  trial->phases = memory_zeroed((size_t)options->repeats, sizeof *trial->phases);
  if (!trial->phases) return status_no_memory("the phases of the rounds");
  return fem_model_create(&trial->model, &trial->scene);
}

void app_bench_trial_end(AppBenchTrial *trial) {
  fem_run_result_destroy(&trial->result);
  fem_model_destroy(&trial->model);
  fem_scene_destroy(&trial->scene);
  memory_free(trial->phases);
}

// Ends the run as Ctrl-C would, once it has made its steps.
static Status stop_at_limit(void *self, const FemRunProgress *progress) {
  const AppBenchTrial *trial = self;
  if (trial->step_limit == 0 || progress->step_count < trial->step_limit) return STATUS_OK;
  return status_fail(STATUS_INTERRUPTED, "the trial's last step was made");
}

Status app_bench_trial_run(void *self, int round) {
  AppBenchTrial *trial = self;
  FemRunOptions options = {.observe = stop_at_limit, .observer = trial};
  fem_run_result_destroy(&trial->result);
  app_bench_timer_start(&trial->timer);
  Status status = fem_run(&trial->model, &options, &trial->result);
  app_bench_timer_stop(&trial->timer, round, 1);
  trial->phases[round] = trial->result.phases;
  return status == STATUS_INTERRUPTED ? STATUS_OK : status;
}

FemRunPhases app_bench_trial_phases(const AppBenchTrial *trial, int rounds) {
  return trial->phases[app_bench_timer_median_round(&trial->timer, rounds)];
}

const char *const app_bench_phases[APP_BENCH_PHASE_COUNT] = {
    "broad_phase", "overlap",       "contact", "forces", "assembly",
    "analysis",    "factorisation", "solve",   "output", "other"};

void app_bench_trial_split(const FemRunPhases *phases, double seconds[APP_BENCH_PHASE_COUNT]) {
  const double named[APP_BENCH_PHASE_COUNT - 1] = {phases->broad_phase,   phases->overlap,  phases->contact,
                                                   phases->forces,        phases->assembly, phases->analysis,
                                                   phases->factorisation, phases->solve,    phases->output};
  double other = phases->total;
  for (int p = 0; p < APP_BENCH_PHASE_COUNT - 1; p++) {
    seconds[p] = named[p];
    other -= named[p];
  }
  seconds[APP_BENCH_PHASE_COUNT - 1] = other;
}

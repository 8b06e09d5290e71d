// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/pareto/scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "app/compare/comparison.h"
#include "app/scene/overlap.h"
#include "base/log.h"
#include "base/memory.h"
#include "fem/effect/contact/contact.h"
#include "lab/trial.h"

enum { MAX_OVERRIDES = 64 };

// Errors of a model's forces in the configurations so far: relative ones, and their terms' sums.
typedef struct Errors {
  ContactAuditTerm sum;
  double *values; // owned
  size_t count, capacity;
} Errors;

typedef struct Bench {
  LabPareto *pareto;
  const char *scene;
  const char *const *overrides;
  int override_count;
  OverlapModel exact; // owned
  long long step_in_contact;
  Errors *errors;      // (model_count), owned
  LabTrial *trials;    // (model_count), owned
  LabTrial *reference; // owned
} Bench;

static Status audit_model(Bench *bench, int m, ContactSystem *contact, const FemRunProgress *progress) {
  ContactAudit audit;
  Errors *errors = &bench->errors[m];
  TRY(contact_system_audit(contact, progress->time, progress->system->accepted.positions,
                           &bench->pareto->models[m].overlap, &bench->exact, &audit));
  if (!memory_reserve((void **)&errors->values, &errors->capacity, errors->count + 1, sizeof(double)))
    return status_no_memory("the errors");
  errors->values[errors->count++] = contact_audit_error(audit.force);
  errors->sum.difference += audit.force.difference, errors->sum.size += audit.force.size;
  return STATUS_OK;
}

// All models in a configuration of the reference's run.
static Status watch(void *self, const FemRunProgress *progress) {
  Bench *bench = self;
  TRY(lab_pareto_go_on(bench->pareto));
  void *effect = fem_system_effect(progress->system, &fem_effect_contact);
  if (!effect) return STATUS_OK;
  ContactSystem *contact = fem_effect_contact_system(effect);
  if (contact_system_mesh_pair_count(contact) == 0) return STATUS_OK;
  if (bench->step_in_contact++ % bench->pareto->audit_every != 0) return STATUS_OK;
  for (int m = 0; m < bench->pareto->model_count; m++) TRY(audit_model(bench, m, contact, progress));
  return STATUS_OK;
}

static Status watch_signal(void *self, const FemRunProgress *progress) {
  (void)progress;
  const Bench *bench = self;
  return lab_pareto_go_on(bench->pareto);
}

static Status begin(Bench *bench, LabTrial *trial, const char *overlap) {
  TRY(app_scene_overlap_read(bench->scene, bench->overrides, bench->override_count, overlap, &trial->scene));
  if (!trial->scene.contact.is_on)
    return status_fail(STATUS_INPUT,
                       "%s: has no contact, so overlap models cannot differ; add a 'contact' section",
                       bench->scene);
  trial->keeps_trajectory = trial->accepts_failure = true;
  trial->watch = watch_signal, trial->watcher = bench;
  AppBenchOptions options = bench->pareto->common;
  options.repeats = bench->pareto->scene_rounds;
  return lab_trial_begin(trial, &options, 0);
}

static Status run_reference(Bench *bench, const char *reference) {
  TRY(begin(bench, bench->reference, reference));
  bench->reference->watch = watch;
  log_progress("%s: the reference's run, all models in its configurations", bench->scene);
  TRY(lab_trial_run(bench->reference, 0));
  log_progress_end();
  TRY(lab_pareto_go_on(bench->pareto));
  if (bench->reference->outcome != STATUS_OK)
    return status_fail(STATUS_SOLVER, "%s, the reference %s: %s", bench->scene, reference,
                       bench->reference->message);
  if (bench->step_in_contact == 0)
    return status_fail(STATUS_INPUT, "%s: no two elements overlapped; choose a scene in which bodies meet",
                       bench->scene);
  return STATUS_OK;
}

// A model that a scene cannot use is a result as well.
static Status take_turn(void *self, int round) {
  LabTrial *trial = self;
  const Bench *bench = trial->watcher;
  TRY(lab_pareto_go_on(bench->pareto));
  Status status = lab_trial_run(trial, round);
  if (!status) return lab_pareto_go_on(bench->pareto);
  if (status != STATUS_INPUT) return status;
  trial->outcome = status;
  snprintf(trial->message, sizeof trial->message, "%s", status_message());
  return STATUS_OK;
}

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void fill_errors(const Errors *errors, LabParetoPoint *point) {
  qsort(errors->values, errors->count, sizeof *errors->values, compare);
  point->samples = (long long)errors->count;
  point->error = contact_audit_error(errors->sum);
  point->error_median = errors->values[errors->count / 2];
  point->error_p90 = errors->values[(size_t)(0.9 * (double)(errors->count - 1))];
}

static void fill_run(const LabTrial *trial, int rounds, const LabTrial *reference, LabParetoPoint *point) {
  const FemRunResult *result = &trial->result;
  point->outcome = lab_trial_outcome(trial);
  point->steps = result->integrator.steps;
  point->rejected =
      result->integrator.error_test_failures + result->integrator.newton_failures + result->energy_retries;
  if (result->pairs.tried == 0 || point->steps == 0) return;
  FemRunPhases phases = lab_trial_phases(trial, rounds);
  point->seconds = point->seconds_min = point->seconds_max = phases.overlap / (double)result->pairs.tried;
  for (int r = 0; r < rounds; r++) {
    double seconds = trial->phases[r].overlap / (double)result->pairs.tried;
    point->seconds_min = fmin(point->seconds_min, seconds);
    point->seconds_max = fmax(point->seconds_max, seconds);
  }
  point->step_s = phases.total / (double)point->steps;
  point->share = phases.overlap / phases.total;
  point->limit = 1 / (1 - point->share);
  if (trial->outcome != STATUS_OK) return;
  point->trajectory_error =
      app_comparison_trajectory_error(result, &reference->result) / reference->model.length;
  point->run_force_error = app_comparison_force_error(result, &reference->result).l2;
}

static Status run_models(Bench *bench) {
  LabPareto *pareto = bench->pareto;
  int rounds = pareto->scene_rounds;
  for (int m = 0; m < pareto->model_count; m++) {
    bench->trials[m].wall_limit_s = pareto->scene_wall_s;
    TRY(begin(bench, &bench->trials[m], pareto->models[m].source));
  }
  TRY(app_bench_timer_take_turns(bench->trials, sizeof *bench->trials, pareto->model_count, rounds, false,
                                 take_turn));
  for (int m = 0; m < pareto->model_count; m++) {
    LabParetoPoint *point = lab_pareto_add_point(pareto, m, "force", bench->scene);
    if (!point) return status_no_memory("a point");
    fill_errors(&bench->errors[m], point);
    fill_run(&bench->trials[m], rounds, bench->reference, point);
    if (bench->trials[m].outcome != STATUS_OK)
      log_warning("%s, %s: %s: %s", bench->scene, pareto->models[m].name, point->outcome,
                  bench->trials[m].message);
  }
  return STATUS_OK;
}

static Status measure(Bench *bench, const char *reference) {
  size_t models = (size_t)bench->pareto->model_count;
  bench->errors = memory_zeroed(models, sizeof *bench->errors);
  bench->trials = memory_zeroed(models, sizeof *bench->trials);
  bench->reference = memory_zeroed(1, sizeof *bench->reference);
  if (!bench->errors || !bench->trials || !bench->reference) return status_no_memory("the runs");
  TRY(overlap_model_create(&bench->exact, "exact"));
  TRY(run_reference(bench, reference));
  return run_models(bench);
}

Status lab_pareto_scenes_check(LabPareto *pareto, const char *scene, const char *reference,
                               const char *const *overrides, int override_count) {
  Bench bench = {.pareto = pareto, .scene = scene, .overrides = overrides, .override_count = override_count};
  LabTrial *trial = memory_zeroed(1, sizeof *trial);
  if (!trial) return status_no_memory("the runs");
  Status status = begin(&bench, trial, reference);
  lab_trial_end(trial);
  memory_free(trial);
  return status;
}

Status lab_pareto_scenes_measure(LabPareto *pareto, const char *scene, const char *reference,
                                 const char *const *overrides, int override_count) {
  Bench bench = {.pareto = pareto, .scene = scene, .overrides = overrides, .override_count = override_count};
  Status status = measure(&bench, reference);
  for (int m = 0; m < pareto->model_count; m++) {
    if (bench.errors) memory_free(bench.errors[m].values);
    if (bench.trials) lab_trial_end(&bench.trials[m]);
  }
  if (bench.reference) lab_trial_end(bench.reference);
  memory_free(bench.errors), memory_free(bench.trials), memory_free(bench.reference);
  overlap_model_destroy(&bench.exact);
  return status;
}

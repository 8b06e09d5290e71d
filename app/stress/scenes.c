// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/scenes.h"

#include <math.h>
#include <string.h>

#include "overlap/models.h"

static const double LIMIT_S = 60;
static const char ANY[] = "any";
// A scene whose pairs would take a model longer than this [s] is not run with it.
static const double LONGEST_S = 30;

static void ask_common(const AppStressScene *scene, const AppStressRun *run, AppStressRow *row) {
  const FemRunResult *result = &run->result;
  if (scene->asked & APP_STRESS_TOUCHES)
    app_stress_ask_occurred(row, "overlapping pairs", result->contact.pairs_max, 1);
  if (scene->asked & APP_STRESS_ENDS) app_stress_ask_end(row, result->end_time, run->scene.end);
  if (scene->is_still)
    app_stress_ask_least(row, "evaluated without an error", run->status == STATUS_OK, 1);
  else
    app_stress_ask_least(row, "all positions are numbers", app_stress_run_is_finite(run), 1);
  if (scene->asked & APP_STRESS_ENERGY)
    app_stress_ask_most(row, "energy gain", result->energy.audit.gain / result->energy.audit.scale, 1e-3);
  if (scene->asked & APP_STRESS_UPRIGHT) app_stress_ask_least(row, "det F", result->min_det_F, 1e-12);
}

static double limit_of(const AppStressScene *scene, const AppStressOptions *options) {
  if (options->limit_s > 0) return options->limit_s;
  return scene->limit_s > 0 ? scene->limit_s : LIMIT_S;
}

static void tell_cut(const AppStressRun *run, AppStressRow *row) {
  const FemRunResult *result = &run->result;
  row->is_cut = true;
  row->counter = "summary.json: end_time, cpu_s, steps, trouble";
  snprintf(
      row->remark, sizeof row->remark,
      "did not end within %.0f s of processor time: t = %.4g of %g s after %lld steps (smallest %.2g s), "
      "%lld pairs asked",
      run->limit_s, result->end_time, run->scene.end, result->integrator.steps, result->trouble.smallest_step,
      result->contact.pairs.tried);
}

// A case with a model, in `run`.
static Status run_open(const AppStressScene *scene, const AppStressOptions *options, AppStressRun *run,
                       AppStressRow *row) {
  run->limit_s = limit_of(scene, options);
  run->asked_to_stop = options->stop;
  TRY(scene->run ? scene->run(run) : app_stress_run_scene(run));
  if (options->stop && *options->stop) return status_fail(STATUS_INTERRUPTED, "interrupted");
  row->cpu_s = run->cpu_s;
  row->steps = run->result.integrator.steps, row->pairs = run->result.contact.pairs.tried;
  ask_common(scene, run, row);
  if (run->is_cut)
    tell_cut(run, row);
  else if (scene->is_still || run->result.trajectory.frame_count > 1) // judges look at the last two
    scene->judge(run, row);
  app_stress_judge(row);
  if (row->outcome == APP_STRESS_FAILED && run->message[0])
    snprintf(row->remark, sizeof row->remark, "%s", run->message);
  return STATUS_OK;
}

static Status open_with(const AppStressScene *scene, const char *model, AppStressRun *run) {
  const char *overrides[APP_STRESS_MAX_OVERRIDES + 1];
  char overlap[64];
  int count = 0;
  for (; count < APP_STRESS_MAX_OVERRIDES && scene->overrides[count]; count++)
    overrides[count] = scene->overrides[count];
  snprintf(overlap, sizeof overlap, "contact.overlap=%s", model);
  if (model != ANY) overrides[count++] = overlap;
  return app_stress_run_open(run, scene->file, overrides, count);
}

static Status run_case(const AppStressScene *scene, const AppStressOptions *options, const char *model,
                       AppStressRow *row) {
  AppStressRun run;
  TRY(open_with(scene, model, &run));
  Status status = run_open(scene, options, &run, row);
  app_stress_run_close(&run);
  return status;
}

// Pairs that the scene asks of clip; 0: it could not be run.
static long long pairs_of(const AppStressScene *scene, const AppStressOptions *options) {
  AppStressRun run;
  if (open_with(scene, "clip", &run)) return 0;
  run.limit_s = LIMIT_S;
  run.asked_to_stop = options->stop;
  Status status = scene->run ? scene->run(&run) : app_stress_run_scene(&run);
  long long pairs = status ? 0 : run.result.contact.pairs.tried;
  app_stress_run_close(&run);
  return pairs;
}

// Whether the model can be asked at all; the row says why not.
static bool is_able(const AppStressScene *scene, const AppStressOptions *options, const OverlapOps *ops,
                    AppStressRow *row) {
  OverlapModel model;
  Status created = overlap_models_create(&model, ops->name);
  overlap_model_destroy(&model);
  if (created) {
    app_stress_excuse(row, "%s", status_message());
    return false;
  }
  if (ops->lacks_scale) {
    app_stress_excuse(row, "its V does not follow the size of the pair: no forces");
    return false;
  }
  if (ops->seconds_per_pair < 1e-4) return true;
  long long pairs = pairs_of(scene, options);
  double needed = (double)pairs * ops->seconds_per_pair;
  if (needed <= LONGEST_S) return true;
  app_stress_excuse(row, "%lld pairs would take this model about %.2g s", pairs, needed);
  return false;
}

static Status run_row(const AppStressScene *scene, const AppStressOptions *options, AppStress *stress,
                      const OverlapOps *ops) {
  if (options->stop && *options->stop) return status_fail(STATUS_INTERRUPTED, "interrupted");
  AppStressRow *row = app_stress_add(stress, "scenes", scene->name, ops ? ops->name : ANY);
  if (!row) return status_no_memory("the table of hard cases");
  if (!ops || is_able(scene, options, ops, row)) {
    Status status = run_case(scene, options, row->model, row);
    if (status) {
      stress->count--; // nothing is known of it
      return status_prefix(status, "%s, %s", scene->name, ops ? ops->name : ANY);
    }
  }
  if (options->observe) options->observe(options->observer, stress);
  return STATUS_OK;
}

static Status run_scene(const AppStressScene *scene, const AppStressOptions *options, AppStress *stress) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  if (scene->is_any)
    return app_stress_wants_model(options, ANY) ? run_row(scene, options, stress, NULL) : STATUS_OK;
  for (int m = 0; m < count; m++)
    if (app_stress_wants_model(options, models[m]->name)) TRY(run_row(scene, options, stress, models[m]));
  return STATUS_OK;
}

Status app_stress_scenes_run(const AppStressOptions *options, AppStress *stress) {
  int count;
  const AppStressScene *scenes = app_stress_cases(&count);
  for (int s = 0; s < count; s++) {
    if (options->is_quick && !scenes[s].is_quick && !options->only) continue;
    if (app_stress_wants(options, scenes[s].name)) TRY(run_scene(&scenes[s], options, stress));
  }
  return STATUS_OK;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/parse.h"
#include "app/cli/ranks.h"
#include "app/compare/comparison.h"
#include "app/job/folder.h"
#include "app/job/job.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "base/machine/cpu.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/effect/contact/contact.h"

typedef struct CompareOptions {
  AppJobOptions job;
  const char *overlaps[APP_MAX_MODELS], *audited[APP_MAX_MODELS]; // names; the latter get no run of their own
  int overlap_count, audited_count;
  const char *reference;
  int audit_every;
  double wall_s;     // a run that takes longer is cut short; 0: none is
  double steps_over; // likewise one of more steps than so many times those of the reference; 0: none is
  int rank_count;
} CompareOptions;

static const AppOption option_table[] = {
    {"overlap", 'm', "NAME,...", "The overlap models to compare", 1, CLI_LIST,
     CLI_TO(CompareOptions, overlaps), .most = APP_MAX_MODELS, .example = "clip,exact",
     .count_offset = offsetof(CompareOptions, overlap_count)},
    {"reference", 0, "NAME", "The model that the others are compared with (default: the first)", 1, CLI_TEXT,
     CLI_TO(CompareOptions, reference)},
    {"audit", 0, "K",
     "Evaluate all models in every K-th step of the reference with overlapping elements (default 10; 0: "
     "never)",
     1, CLI_INTEGER, CLI_TO(CompareOptions, audit_every), 0, INT_MAX},
    {"audit-only", 0, "NAME,...", "Models that take part in the audit but get no run of their own", 1,
     CLI_LIST, CLI_TO(CompareOptions, audited), .most = APP_MAX_MODELS, .example = "exact,cgal",
     .count_offset = offsetof(CompareOptions, audited_count)},
    {"wall", 0, "SECONDS", "Stop a model's run after this wall time (default: never)", 1, CLI_NUMBER,
     CLI_TO(CompareOptions, wall_s), 1e-3, 1e7},
    {"most-steps", 0, "RATIO",
     "Stop a model's run after RATIO times the steps of the reference, which then runs first (default: "
     "never)",
     1, CLI_NUMBER, CLI_TO(CompareOptions, steps_over), 1, 1e9},
    {"ranks", 0, "N", "Share each run among N processes of this machine (tetlap-mpi)", 1, CLI_INTEGER,
     CLI_TO(CompareOptions, rank_count), 1, RANKS_MOST},
    {.table = app_job_options, .offset = offsetof(CompareOptions, job)},
    {0},
};

static Status add_model(AppComparison *comparison, const FemSceneDef *scene, const char *source,
                        bool is_driven) {
  if (comparison->model_count == APP_MAX_MODELS)
    return status_fail(STATUS_USAGE, "at most %d models can be compared", APP_MAX_MODELS);
  const char *option = is_driven ? "--overlap" : "--audit-only";
  AppComparisonModel *model = &comparison->models[comparison->model_count];
  Status status = fem_effect_contact_create_overlap(scene, source, &model->overlap);
  if (status) return status == STATUS_INPUT ? status_prefix(STATUS_USAGE, "%s", option) : status;
  model->source = source;
  model->is_driven = is_driven;
  comparison->model_count++;
  if (fem_effect_contact_check_overlap(scene, source, &model->overlap))
    return status_prefix(STATUS_INPUT, "%s", option);
  return STATUS_OK;
}

static Status name_models(AppComparison *comparison) {
  const char *sources[APP_MAX_MODELS];
  AppModelName names[APP_MAX_MODELS];
  for (int m = 0; m < comparison->model_count; m++) sources[m] = comparison->models[m].source;
  TRY(app_model_names_find(comparison->model_count, sources, names));
  for (int m = 0; m < comparison->model_count; m++)
    memcpy(comparison->models[m].name, names[m], sizeof names[m]);
  return STATUS_OK;
}

static Status add_models(AppComparison *comparison, const FemSceneDef *scene, const CompareOptions *options) {
  for (int m = 0; m < options->overlap_count; m++)
    TRY(add_model(comparison, scene, options->overlaps[m], true));
  for (int m = 0; m < options->audited_count; m++)
    TRY(add_model(comparison, scene, options->audited[m], false));
  return name_models(comparison);
}

// By what the command line says, or by what it is called.
static bool is_called(const AppComparisonModel *model, const char *text) {
  return strcmp(model->source, text) == 0 || strcmp(model->name, text) == 0;
}

static Status choose_models(AppComparison *comparison, const FemSceneDef *scene,
                            const CompareOptions *options) {
  TRY(add_models(comparison, scene, options));
  comparison->audit_every = options->audit_every;
  if (!options->reference) return STATUS_OK;
  for (int m = 0; m < comparison->model_count; m++)
    if (is_called(&comparison->models[m], options->reference) && comparison->models[m].is_driven) {
      comparison->reference = m;
      return STATUS_OK;
    }
  return status_fail(STATUS_USAGE, "--reference %s: is not among the models of --overlap",
                     options->reference);
}

typedef struct Observer {
  AppProgress progress;
  AppComparison *comparison; // NULL: no audit in this run
  long long step_in_contact;
  const char *name;      // of the model
  double began_s;        // of its run
  double wall_s;         // its limit; 0: none
  double most_steps;     // its limit; 0: none
  long long step_count;  // of the run so far
  double tell_again_s;   // how long the run may last before its estimate is given again; INFINITY: never
  bool is_cut;           // by a limit
  double mark_s, mark_t; // where the last estimate was taken
} Observer;

// What is left at the pace since the last estimate; given when the run has lasted twice as long as was said,
// then twice as long again.
static void tell_estimate(Observer *observer, const FemRunProgress *progress) {
  double now = clock_wall_s() - observer->began_s;
  if (now < observer->tell_again_s) return;
  double pace = (progress->time - observer->mark_t) / (now - observer->mark_s);
  double left = (progress->end - progress->time) / pace;
  log_info("%s: %.0f s so far, t = %.4g of %.4g s; about %.3g %s more at this pace", observer->name, now,
           progress->time, progress->end, left < 120 ? left : left / 60, left < 120 ? "s" : "minutes");
  observer->tell_again_s = 2 * now;
  observer->mark_s = now, observer->mark_t = progress->time;
}

static Status check_wall(Observer *observer, const FemRunProgress *progress) {
  if (!(observer->wall_s > 0)) return STATUS_OK;
  if (!ranks_any(clock_wall_s() - observer->began_s > observer->wall_s)) return STATUS_OK;
  observer->is_cut = true;
  return status_fail(STATUS_INTERRUPTED, "cut short by --wall: t = %g s of %g s was reached in %g s",
                     progress->time, progress->end, observer->wall_s);
}

static Status check_steps(Observer *observer, const FemRunProgress *progress) {
  if (!(observer->most_steps > 0 && (double)progress->step_count > observer->most_steps)) return STATUS_OK;
  observer->is_cut = true;
  return status_fail(STATUS_INTERRUPTED,
                     "cut short by --most-steps: t = %g s of %g s was reached in %lld steps", progress->time,
                     progress->end, progress->step_count);
}

static Status observe(void *self, const FemRunProgress *progress) {
  Observer *observer = self;
  observer->step_count = progress->step_count;
  app_job_show_progress(&observer->progress, progress);
  tell_estimate(observer, progress);
  TRY(check_wall(observer, progress));
  TRY(check_steps(observer, progress));
  return observer->comparison
             ? app_comparison_audit(observer->comparison, progress, &observer->step_in_contact)
             : STATUS_OK;
}

// Estimates of runs shorter than this are not mended.
static const double SHORT_RUN_S = 5;

// 0 for the reference itself, and where that has not reached its end.
static double limit_steps(const AppComparison *comparison, int m, const CompareOptions *options) {
  const AppComparisonModel *reference = &comparison->models[comparison->reference];
  if (m == comparison->reference || reference->status) return 0;
  return options->steps_over * (double)reference->step_count;
}

// A run of one model, expected to take so long (0: unknown). What stops the whole comparison is returned; a
// solver that gave up is kept as this model's result.
static Status run_model(AppComparison *comparison, int m, const CompareOptions *options, double expected_s) {
  AppComparisonModel *model = &comparison->models[m];
  AppJob job;
  TRY(app_job_open(&job, &options->job, model->source, model->name));
  if (!job.scene.contact.is_on) {
    app_job_close(&job);
    return status_fail(STATUS_INPUT,
                       "%s: has no contact, so overlap models cannot differ; add a 'contact' section",
                       options->job.scene_path);
  }
  memcpy(job.overlap, model->name, sizeof job.overlap); // beside the others it may be a longer one
  app_job_log_contact(&job);
  comparison->length = job.model.length;
  comparison->end = job.scene.end;
  char label[APP_MODEL_NAME + 1];
  snprintf(label, sizeof label, "%s ", model->name);
  Observer observer = {
      .progress = {.began_s = clock_wall_s(), .label = label, .is_json = options->job.is_progress_json},
      .comparison = m == comparison->reference ? comparison : NULL,
      .name = model->name,
      .began_s = clock_wall_s(),
      .wall_s = options->wall_s,
      .most_steps = limit_steps(comparison, m, options),
      .tell_again_s = expected_s > 0 ? 2 * fmax(expected_s, SHORT_RUN_S) : INFINITY};
  FemRunOptions run_options = {.directory = job.directory,
                               .stop = app_job_stop_flag(),
                               .observe = observe,
                               .observer = &observer,
                               .keep_trajectory = true};
  int missing = app_job_folder_missing(job.directory);
  model->status = fem_run(&job.model, &run_options, &model->result);
  log_progress_end();
  model->has_run = true;
  model->step_count = observer.step_count;
  if (model->status) snprintf(model->message, sizeof model->message, "%s", status_message());
  bool is_refused = app_job_folder_is_refused(model->status, &model->result);
  if (is_refused) app_job_folder_remove(job.directory, missing);
  Status status = is_refused ? STATUS_OK : app_job_write_summary(&job, &model->result, model->status);
  app_job_close(&job);
  // Ranks that have agreed on a failure share nothing after it.
  bool goes_on = ranks()->count == 1 && (model->status == STATUS_SOLVER || observer.is_cut);
  if (goes_on) {
    log_warning("%s: %s", model->name, model->message);
    return status;
  }
  if (model->status) return status_fail(model->status, "%s", model->message);
  return status;
}

static int choose_next(const AppComparison *comparison, const CompareOptions *options) {
  int best = -1;
  if (options->steps_over > 0 && !comparison->models[comparison->reference].has_run)
    return comparison->reference;
  for (int m = 0; m < comparison->model_count; m++) {
    const AppComparisonModel *model = &comparison->models[m];
    if (!model->is_driven || model->has_run) continue;
    if (best < 0 ||
        model->overlap.ops->seconds_per_pair < comparison->models[best].overlap.ops->seconds_per_pair)
      best = m;
  }
  return best;
}

// What another run will take, by what the first took: all but the overlap costs the same, and the overlap the
// model's cost of a pair for each pair that was asked for. Nothing is known after a run that failed: 0.
static double expect_time(const AppComparison *comparison, int first, int m) {
  const FemRunResult *pilot = &comparison->models[first].result;
  if (m == first || comparison->models[first].status) return 0;
  double cost = comparison->models[m].overlap.ops->seconds_per_pair;
  double overlap = (double)pilot->contact.pairs.tried * cost / cpu_thread_count();
  return pilot->cost.wall_s - pilot->cost.phases.overlap + overlap;
}

static void announce_time(const AppComparison *comparison, int m, double seconds) {
  if (!(seconds > 0)) return;
  log_info("%s: about %.3g %s if it takes as many steps; corrected if it does not",
           comparison->models[m].name, seconds < 120 ? seconds : seconds / 60,
           seconds < 120 ? "s" : "minutes");
}

static Status write_csv(const AppComparison *comparison, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  Status status = app_comparison_print_csv(comparison, writer.stream);
  if (!status) return file_commit(&writer);
  file_abandon(&writer);
  return status;
}

static Status write_results(const AppComparison *comparison, const CompareOptions *options) {
  AppJob job; // for the directory only
  TRY(app_job_open(&job, &options->job, NULL, NULL));
  char *json = file_join(job.directory, "compare.json"), *csv = file_join(job.directory, "compare.csv");
  RecordList *list = record_list_new();
  Status status = json && csv && list ? STATUS_OK : status_no_memory("the comparison");
  if (!status) {
    app_comparison_record(comparison, options->job.scene_path, list);
    status = record_list_write(list, json);
  }
  if (!status) status = write_csv(comparison, csv);
  if (!status && options->job.is_json) status = record_list_print(list, stdout);
  if (!status && !options->job.is_json) status = app_comparison_print_table(comparison, stdout);
  if (!status) log_info("wrote %s and compare.csv; the runs are in the folders beside them", json);
  record_list_destroy(list);
  memory_free(json);
  memory_free(csv);
  app_job_close(&job);
  return status;
}

// The models are made as the scene wants them.
static Status prepare(AppComparison *comparison, CompareOptions *options) {
  AppJob job;
  TRY(app_job_open(&job, &options->job, NULL, NULL));
  Status status = choose_models(comparison, &job.scene, options);
  app_job_close(&job);
  return status;
}

static Status compare(AppComparison *comparison, CompareOptions *options) {
  TRY(prepare(comparison, options));
  int first = choose_next(comparison, options);
  log_info("%s runs first: the time of the others is estimated from its own", comparison->models[first].name);
  for (int m = first; m >= 0; m = choose_next(comparison, options)) {
    double expected_s = expect_time(comparison, first, m);
    announce_time(comparison, m, expected_s);
    TRY(run_model(comparison, m, options, expected_s));
  }
  TRY(app_comparison_conclude(comparison));
  TRY(write_results(comparison, options));
  for (int m = 0; m < comparison->model_count; m++)
    if (comparison->models[m].status)
      return status_fail(STATUS_SOLVER, "%s did not reach the end: %s", comparison->models[m].name,
                         comparison->models[m].message);
  return STATUS_OK;
}

static void check(struct argp_state *state, void *options) {
  if (!((const CompareOptions *)options)->overlap_count)
    argp_error(state, "name the models, as in --overlap clip,exact");
}

static int run_command(int argument_count, char **arguments) {
  CompareOptions options = {.audit_every = 10};
  app_cli_parse(&app_command_compare, argument_count, arguments, &options);
  app_job_prepare(&options.job);
  AppComparison *comparison = memory_zeroed(1, sizeof *comparison);
  Status status = comparison ? app_ranks_start(options.rank_count) : status_no_memory("the comparison");
  if (!status) status = compare(comparison, &options);
  if (status) log_error("%s", status_message());
  if (comparison) app_comparison_destroy(comparison);
  memory_free(comparison);
  return status_exit_code(status);
}

const AppCommand app_command_compare = {
    .name = "compare",
    .help = "run a scene with several overlap models and compare them",
    .options = option_table,
    .arguments = &app_job_scene,
    .doc = "Run a scene with several overlap models and compare the results.",
    .check = check,
    .run = run_command,
    .has_threads = true,
    .has_ranks = true};

// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/scene/run.h"

#include <stdio.h>

#include "app/cli/parse.h"
#include "app/cli/ranks.h"
#include "app/cli/versions.h"
#include "app/command/commands.h"
#include "app/job/beacon.h"
#include "app/job/closing.h"
#include "app/job/folder.h"
#include "app/job/origin.h"
#include "app/loop/replay.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "datagen/capture.h"
#include "fem/effect/contact/contact.h"
#include "fem/run/check/choice.h"
#include "fem/run/checkpoint/checkpoint.h"

static const AppOption option_table[] = {
    {"overlap", 'm', "NAME", "Take this overlap model instead of the scene's", 1, CLI_TEXT,
     CLI_TO(AppRunOptions, overlap)},
    {"capture", 0, "FILE", "Keep the pairs of every step whose boxes meet, labelled, as a data set", 1,
     CLI_TEXT, CLI_TO(AppRunOptions, capture)},
    {"replay", 0, "FILE", "Set from outside what tetlap.Simulation's record says", 1, CLI_TEXT,
     CLI_TO(AppRunOptions, replay)},
    {"strict", 0, NULL,
     "Energy gained beyond 0.1 % of the scene's, and bodies that pass through each other, are an error", 1,
     CLI_FLAG, CLI_TO(AppRunOptions, is_strict)},
    {"ranks", 0, "N", "Share the run among N processes of this machine (tetlap-mpi)", 1, CLI_INTEGER,
     CLI_TO(AppRunOptions, rank_count), 1, RANKS_MOST},
    {.table = app_job_options, .offset = offsetof(AppRunOptions, job)},
    {0},
};

static void announce(const AppJob *job) {
  log_info("%s: %d %s, %d vertices, %d tetrahedra, %d unknowns, solver %s", job->scene.path,
           job->scene.body_count, job->scene.body_count == 1 ? "body" : "bodies", job->model.vertex_count,
           job->model.tet_count, job->model.free_count,
           fem_solver_name(fem_run_choice(&job->model, NULL).kind));
  app_job_log_contact(job);
}

static Status print_summary(const AppJob *job, const FemRunResult *result, Status status) {
  Record *summary = app_job_summary(job, result, status);
  if (!summary) return status_no_memory("the summary");
  Status printed = record_print(summary, stdout);
  record_destroy(summary);
  return printed;
}

// What watches the run: the progress line, and the capture if one was asked for.
typedef struct Observer {
  AppProgress progress;
  DatagenCapture *capture; // NULL: none
  FemTrouble told;         // what the log has reported
  AppBeacon beacon;
} Observer;

static Status capture_pairs(DatagenCapture *capture, FemSystem *system) {
  void *effect = fem_system_effect(system, &fem_effect_contact);
  if (!effect) return STATUS_OK;
  int count;
  const double *pairs;
  TRY(contact_system_near_pairs(fem_effect_contact_system(effect), system->accepted.time,
                                system->accepted.positions, &count, &pairs));
  return datagen_capture_append(capture, pairs, count);
}

// The first time that a kind of trouble strikes, and every event of energy.
static void warn(Observer *observer, const FemRunProgress *progress) {
  const FemTrouble *trouble = progress->trouble;
  for (int k = 0; k < FEM_TROUBLE_KIND_COUNT; k++) {
    char text[512];
    if (trouble->of[k].events == observer->told.of[k].events) continue;
    if (k == FEM_TROUBLE_ENERGY && trouble->of[k].events > observer->told.of[k].events)
      log_warning("t = %.6g s: the energy has risen by %.3g of the scene's so far, the bound is %g",
                  progress->time, progress->energy_rise, progress->energy_bound);
    else if (observer->told.of[k].events == 0) {
      fem_trouble_describe(trouble, progress->system->model, (FemTroubleKind)k, text, sizeof text);
      log_warning("%s", text);
    }
  }
  observer->told = *trouble;
}

static Status observe(void *self, const FemRunProgress *progress) {
  Observer *observer = self;
  TRY(app_job_show_progress(&observer->progress, progress));
  if (progress->has_trouble_begun) warn(observer, progress);
  TRY(app_beacon_show(&observer->beacon, progress));
  return observer->capture ? capture_pairs(observer->capture, progress->system) : STATUS_OK;
}

// Runs, and puts the capture into its place, if only of a run that was cut short.
static Status run_captured(const AppRunOptions *options, AppJob *job, const char *origin,
                           FemRunResult *result) {
  DatagenCapture capture = {0};
  Status begun = options->capture ? datagen_capture_begin(&capture, options->capture, app_versions_program(),
                                                          DATAGEN_LABEL_EXACT)
                                  : STATUS_OK;
  if (begun) {
    log_error("%s", status_message());
    return begun;
  }
  Observer observer = {
      .progress = {.began_s = clock_wall_s(), .label = "", .is_json = options->job.is_progress_json},
      .capture = options->capture ? &capture : NULL,
      .beacon = app_beacon_begin(job)};
  FemRunOptions run_options = {.directory = job->directory,
                               .stop = app_job_stop_flag(),
                               .observe = observe,
                               .observer = &observer,
                               .from = options->from,
                               .origin = origin,
                               .is_strict = options->is_strict};
  Status status = options->replay ? app_loop_replay(job, &run_options, result, options->replay)
                                  : fem_run(&job->model, &run_options, result);
  log_progress_end();
  app_beacon_end(&observer.beacon);
  if (status) log_error("%s", status_message());
  long long count = options->capture ? datagen_capture_count(&capture) : 0, apart = capture.apart;
  Status kept = options->capture ? datagen_capture_commit(&capture) : STATUS_OK;
  if (options->capture && count == 0)
    log_warning("%s: not written, since no two elements came so near that their boxes meet",
                options->capture);
  else if (options->capture && !kept)
    log_info("%s: %lld pairs, %.1f %% of them near misses, which share nothing", options->capture, count,
             100 * (double)apart / (double)count);
  if (kept) log_error("%s", status_message());
  return status ? status : kept;
}

// Where a run that did not reach its end can be taken up.
static void tell_of_checkpoint(const AppJob *job) {
  char *path = file_join(job->directory, FEM_CHECKPOINT_FILE);
  if (path && file_exists(path))
    log_info("`tetlap resume %s` continues from the last checkpoint", job->directory);
  memory_free(path);
}

// What the run is started with, as text; owned by the caller. A run that goes on must be the one that began.
static Status make_origin(const AppRunOptions *options, const AppJob *job, char **text) {
  Record *origin;
  TRY(app_origin_make(job, &options->job, options->overlap, &origin));
  if (options->replay) record_text(origin, "replay", options->replay);
  Status status =
      options->origin ? app_origin_compare(options->origin, origin, options->from_path) : STATUS_OK;
  *text = status ? NULL : record_text_of(origin);
  record_destroy(origin);
  return status || *text ? status : status_no_memory("the run's origin");
}

static Status run_opened(const AppRunOptions *options, AppJob *job, const char *origin) {
  announce(job);
  FemRunResult result = {0};
  int missing = app_job_folder_missing(job->directory);
  Status status = run_captured(options, job, origin, &result);
  bool is_refused = app_job_folder_is_refused(status, &result);
  if (status && !is_refused) tell_of_checkpoint(job);
  if (is_refused) app_job_folder_remove(job->directory, missing);
  // There is a summary of a run that failed, too, unless nothing can be written.
  Status written =
      status == STATUS_IO || is_refused ? STATUS_OK : app_job_write_summary(job, &result, status);
  if (!status && !written) app_closing_print(job, &result);
  if (options->job.is_json && !written) written = print_summary(job, &result, status);
  fem_run_result_destroy(&result);
  if (written) log_error("%s", status_message());
  return status ? status : written;
}

Status app_run_execute(const AppRunOptions *options) {
  AppJob job;
  char *origin = NULL;
  Status status = app_job_open(&job, &options->job, options->overlap, NULL);
  if (!status) status = make_origin(options, &job, &origin);
  if (status)
    log_error("%s", status_message());
  else
    status = run_opened(options, &job, origin);
  memory_free(origin);
  app_job_close(&job);
  return status;
}

static Status check_options(const AppRunOptions *options) {
  if (options->capture && file_is_same(options->capture, options->job.scene_path))
    return status_fail(STATUS_USAGE,
                       "--capture %s is the scene itself; name another file, as in --capture pairs.h5",
                       options->capture);
  if (options->replay && ranks()->count > 1)
    return status_fail(STATUS_USAGE,
                       "--replay works in one process, and there are %d: leave it out, or --ranks",
                       ranks()->count);
  if (!options->capture || ranks()->count == 1) return STATUS_OK;
  return status_fail(STATUS_USAGE,
                     "--capture writes from one process, and there are %d: leave it out, or --ranks",
                     ranks()->count);
}

static int run_command(int argument_count, char **arguments) {
  AppRunOptions options = {0};
  app_cli_parse(&app_command_run, argument_count, arguments, &options);
  app_job_prepare(&options.job);
  Status status = app_ranks_start(options.rank_count);
  if (!status) status = check_options(&options);
  if (status)
    log_error("%s", status_message());
  else
    status = app_run_execute(&options);
  return status_exit_code(status);
}

const AppCommand app_command_run = {
    .name = "run",
    .help = "run a scene and write frames, history and summary",
    .options = option_table,
    .arguments = &app_job_scene,
    .doc = "Run a scene: frames for ParaView, a history and a summary are written.",
    .run = run_command,
    .has_threads = true,
    .has_ranks = true};

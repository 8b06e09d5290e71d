// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/job/job.h"

#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/format.h"
#include "app/cli/versions.h"
#include "app/job/inputs.h"
#include "app/job/start.h"
#include "app/job/stiffness.h"
#include "app/scene/overlap.h"
#include "app/scene/read.h"
#include "app/scene/write.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "base/machine/cpu.h"
#include "base/machine/interrupt.h"
#include "base/memory.h"
#include "fem/model/build.h"
#include "fem/run/checkpoint/checkpoint.h"
#include "overlap/models.h"

static void raise_flag(int signal_number) {
  (void)signal_number;
  *interrupt_flag() = 1;
}

static void read_progress(struct argp_state *state, void *is_json, char *text) {
  if (strcmp(text, "json") != 0) argp_error(state, "--progress %s: the only form is json", text);
  *(bool *)is_json = true;
}

const AppOption app_job_options[] = {
    {"output", 'o', "DIR", "Write into DIR (default: out/ and the scene's name)", 1, CLI_TEXT,
     CLI_TO(AppJobOptions, directory)},
    {"set", 's', "KEY=VALUE", "Replace a value of the scene, as in contact.stiffness=1e6; may be repeated", 1,
     CLI_REPEATED, CLI_TO(AppJobOptions, overrides), .most = APP_MAX_OVERRIDES, .example = "--set",
     .count_offset = offsetof(AppJobOptions, override_count)},
    {"threads", 't', "N", "Use N threads (default: the scene's, else all)", 1, CLI_INTEGER,
     CLI_TO(AppJobOptions, threads), 1, APP_CLI_MOST_THREADS},
    {"json", 'j', NULL, "Print the result as JSON on standard output", 2, CLI_FLAG,
     CLI_TO(AppJobOptions, is_json)},
    {"progress", 0, "json", "Progress as a line of JSON twice a second, on standard error", 2, CLI_OWN,
     CLI_TO(AppJobOptions, is_progress_json), .read = read_progress},
    {"quiet", 'q', NULL, "Say nothing but errors", 2, CLI_FLAG, CLI_TO(AppJobOptions, is_quiet)},
    {"verbose", 'v', NULL, "Print a line per step, and why one is taken back", 2, CLI_FLAG,
     CLI_TO(AppJobOptions, is_verbose)},
    {0},
};

const AppArguments app_job_scene = {"SCENE", offsetof(AppJobOptions, scene_path), 1,
                                    .missing = "name a scene file, as in examples/01_drop.yaml",
                                    .excess = "one scene at a time; '%s' is the second"};

void app_job_prepare(const AppJobOptions *options) {
  log_set_level(options->is_quiet ? LOG_ERROR : options->is_verbose ? LOG_DEBUG : LOG_INFO);
  // The first signal lets a run end in order, a second one kills.
  struct sigaction action = {.sa_handler = raise_flag, .sa_flags = (int)SA_RESETHAND};
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

const volatile sig_atomic_t *app_job_stop_flag(void) {
  return interrupt_flag();
}

char *app_job_default_directory(const char *scene_path, const char *ending) {
  const char *slash = strrchr(scene_path, '/'), *name = slash ? slash + 1 : scene_path;
  const char *dot = strrchr(name, '.');
  int length = dot && dot > name ? (int)(dot - name) : (int)strlen(name);
  size_t size = (size_t)length + strlen(ending) + sizeof "out/";
  char *directory = memory_zeroed(size, 1);
  if (directory) snprintf(directory, size, "out/%.*s%s", length, name, ending);
  return directory;
}

static Status choose_directory(AppJob *job, const AppJobOptions *options, const char *subdirectory) {
  const char *given = options->directory;
  job->directory =
      given ? memory_copy(given, strlen(given) + 1, 1) : app_job_default_directory(options->scene_path, "");
  if (job->directory && subdirectory) {
    char *below = file_join(job->directory, subdirectory);
    memory_free(job->directory);
    job->directory = below;
  }
  return job->directory ? STATUS_OK : status_no_memory("a directory name");
}

// A model that is for pairs of one size alone gives forces that mean nothing.
static void warn_of_scale(const AppJob *job) {
  char source[PATH_MAX];
  if (app_scene_overlap_source(&job->scene, source) && overlap_models_lack_scale(source))
    log_warning("%s: V of the overlap model '%s' does not scale with the size of the pair, so forces in a "
                "scene are meaningless; use 'clip' or 'geo' for forces",
                job->scene.path, app_job_overlap(job));
}

Status app_job_open(AppJob *job, const AppJobOptions *options, const char *overlap,
                    const char *subdirectory) {
  *job = (AppJob){0};
  Status status = app_scene_overlap_read(options->scene_path, options->overrides, options->override_count,
                                         overlap, &job->scene);
  if (!status) status = choose_directory(job, options, subdirectory);
  if (!status) {
    char source[PATH_MAX];
    if (app_scene_overlap_source(&job->scene, source)) app_model_names_find_one(source, job->overlap);
    if (options->threads) job->scene.threads = options->threads;
    if (job->scene.threads) omp_set_num_threads(job->scene.threads);
    status = fem_model_create(&job->model, &job->scene);
    log_debug("%s: read and built on %d threads; output goes to %s", job->scene.path, omp_get_max_threads(),
              job->directory);
  }
  if (!status && !(job->inputs = record_new())) status = status_no_memory("the run's inputs");
  if (!status) status = app_inputs_record(&job->scene, &job->model, job->inputs);
  if (!status) status = app_start_read(&job->model, job->directory, job->inputs);
  if (!status) warn_of_scale(job);
  if (status) app_job_close(job);
  return status;
}

void app_job_close(AppJob *job) {
  fem_model_destroy(&job->model);
  fem_scene_destroy(&job->scene);
  memory_free(job->directory);
  record_destroy(job->inputs);
  *job = (AppJob){0};
}

static Status print_progress(AppProgress *progress, const FemRunProgress *state, double left) {
  static const double PERIOD_S = 0.5;
  double now = clock_wall_s();
  bool is_due = now - progress->told_at_s >= PERIOD_S || state->time >= state->end;
  Record *record = is_due ? record_new() : NULL;
  if (!record) return is_due ? status_no_memory("the progress") : STATUS_OK;
  progress->told_at_s = now;
  record_number(record, "time", state->time);
  record_number(record, "end", state->end);
  record_integer(record, "steps", state->step_count);
  record_number(record, "step_s", state->step);
  record_integer(record, "pairs", state->measures->active_pairs);
  record_number(record, "left_s", left);
  Status status = record_print_line(record, stderr);
  record_destroy(record);
  return status;
}

Status app_job_show_progress(void *self, const FemRunProgress *state) {
  AppProgress *progress = self;
  double share = state->time / state->end;
  log_debug("%st = %.9g s: step %lld of %.3g s, %d pairs overlap", progress->label, state->time,
            state->step_count, state->step, state->measures->active_pairs);
  double left = share > 0 ? (clock_wall_s() - progress->began_s) * (1 - share) / share : 0;
  if (progress->is_json) return print_progress(progress, state, left);
  log_progress("%s%3.0f %%  t %.4g of %.4g s  step %lld  h %.1e s  pairs %d  left %d:%02d", progress->label,
               100 * share, state->time, state->end, state->step_count, state->step,
               state->measures->active_pairs, (int)(left / 60), (int)fmod(left, 60));
  if (log_pace_is_due(&progress->pace, share))
    log_info("%s%.0f %%: t = %.4g of %.4g s, step %lld, about %.3g s left", progress->label,
             floor(100 * share), state->time, state->end, state->step_count, left);
  return STATUS_OK;
}

const char *app_job_overlap(const AppJob *job) {
  return job->overlap[0] ? job->overlap : NULL;
}

static const char *potential_of(const AppJob *job) {
  const FemContactDef *contact = &job->scene.contact;
  return contact->is_on ? contact_def_potential_name(contact->potential) : NULL;
}

// The absolute path of the overlap model's weights file, if it is one of the user's.
static const char *weights_of(const AppJob *job, char path[PATH_MAX]) {
  char source[PATH_MAX];
  return app_scene_overlap_source(&job->scene, source) && app_model_names_locate(source, path) ? path : NULL;
}

static void log_stiffness(const FemModel *model) {
  char stiffness[1024], levels[1024];
  FemCompliance choice;
  if (fem_compliance_choose(model, &choice)) return; // a run says why
  app_stiffness_describe(model, &choice, stiffness, sizeof stiffness);
  app_stiffness_describe_levels(model, &choice, levels, sizeof levels);
  log_info("contact: stiffness %s%s%s", stiffness, levels[0] ? "; " : "", levels);
  fem_compliance_destroy(&choice);
}

void app_job_log_contact(const AppJob *job) {
  char path[PATH_MAX];
  if (!job->scene.contact.is_on) return;
  const char *weights = weights_of(job, path);
  log_info("contact: overlap model %s%s%s%s, potential %s", app_job_overlap(job), weights ? " (" : "",
           weights ? weights : "", weights ? ")" : "", potential_of(job));
  log_stiffness(&job->model);
}

Record *app_job_summary(const AppJob *job, const FemRunResult *result, Status status) {
  Record *summary = record_new();
  if (!summary) return NULL;
  app_format_record(summary);
  record_text(summary, "scene", job->scene.path);
  record_text(summary, "title", job->scene.title);
  char weights[PATH_MAX];
  record_text(summary, "overlap", app_job_overlap(job));
  record_text(summary, "weights", weights_of(job, weights));
  record_text(summary, "potential", potential_of(job));
  record_text(summary, "outcome", fem_run_outcome(result, status));
  if (status) record_text(summary, "message", status_message());
  if (!status && result->trouble.of[FEM_TROUBLE_PASSED].steps > 0) {
    char text[512] = "finished, but ";
    size_t used = strlen(text);
    fem_trouble_describe(&result->trouble, &job->model, FEM_TROUBLE_PASSED, text + used, sizeof text - used);
    record_text(summary, "message", text);
  }
  record_integer(summary, "bodies", job->scene.body_count);
  record_integer(summary, "vertices", job->model.vertex_count);
  record_integer(summary, "tetrahedra", job->model.tet_count);
  record_integer(summary, "unknowns", job->model.free_count);
  record_integer(summary, "threads", cpu_thread_count());
  fem_run_summarise(result, summary);
  return summary;
}

static Status write_record(const char *directory, const char *name, const Record *record) {
  char *path = file_join(directory, name);
  if (!path) return status_no_memory("a file name");
  Status status = record_write(record, path);
  memory_free(path);
  return status;
}

// What it takes to run the same again: the scene with every default filled in, what it reads (as digests),
// versions, processor, command.
Status app_job_write_manifest(const AppJob *job) {
  Record *manifest = record_new();
  if (!manifest) return status_no_memory("the manifest");
  app_format_record(manifest);
  app_versions_record(record_child(manifest, "versions"));
  record_text(manifest, "processor", cpu_name());
  record_integer(manifest, "threads", cpu_thread_count());
  record_text(manifest, "command", app_versions_command());
  record_merge(record_child(manifest, "inputs"), job->inputs);
  Status status = app_scene_write_resolved(&job->scene, manifest);
  if (!status) status = write_record(job->directory, "manifest.json", manifest);
  record_destroy(manifest);
  return status;
}

Status app_job_write_summary(const AppJob *job, const FemRunResult *result, Status status) {
  TRY(file_make_directories(job->directory));
  Record *summary = app_job_summary(job, result, status);
  if (!summary) return status_no_memory("the summary");
  Status written = write_record(job->directory, "summary.json", summary);
  record_destroy(summary);
  return written ? written : app_job_write_manifest(job);
}

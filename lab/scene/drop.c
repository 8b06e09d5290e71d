// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/scene/drop.h"

#include <stdio.h>

#include "app/bench/command.h"
#include "app/bench/report.h"
#include "app/scene/read.h"
#include "base/log.h"
#include "base/memory.h"
#include "lab/scene/builtin.h"
#include "lab/trial.h"

typedef struct Options {
  AppBenchOptions common;
  double stiffness[APP_BENCH_MAX_LIST], tolerance[APP_BENCH_MAX_LIST];
  int stiffness_count, tolerance_count;
  const char *scene_path; // NULL: the built-in drop
} Options;

static const struct argp_option option_table[] = {
    {"stiffness", 'k', "PA,...", 0, "Contact stiffnesses (default: 1e5,1e6,1e7,1e8,1e9)", 1},
    {"tolerance", 'e', "SHARE,...", 0, "Tolerances of the time integration (default: 1e-4)", 1},
    {"scene", 's', "FILE", 0, "Take this scene (default: a block falls flat onto the ground)", 1},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->common;
    return 0;
  case 'k':
    options->stiffness_count =
        app_bench_options_numbers(state, "stiffness", text, 1e-6, 1e30, options->stiffness);
    return 0;
  case 'e':
    options->tolerance_count =
        app_bench_options_numbers(state, "tolerance", text, 1e-12, 0.1, options->tolerance);
    return 0;
  case 's':
    options->scene_path = text;
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

typedef struct Row {
  const char *scene, *outcome;
  double stiffness, tolerance, gain, wall, cpu;
  long long steps, onsets, restarts, energy_retries, newton_failures, pairs_max;
  double force_max, deepest_overlap_max, min_det_F;
} Row;

static const AppBenchColumn columns[] = {
    {"scene", APP_BENCH_TEXT, offsetof(Row, scene), NULL, "file, or (drop)"},
    {"stiffness", APP_BENCH_NUMBER, offsetof(Row, stiffness), "κ Pa", "contact.stiffness"},
    {"tolerance", APP_BENCH_NUMBER, offsetof(Row, tolerance), "tolerance", "time.tolerance"},
    {"outcome", APP_BENCH_TEXT, offsetof(Row, outcome), "outcome", "finished or failed"},
    {"energy_gain_relative", APP_BENCH_NUMBER, offsetof(Row, gain), "energy gain",
     "largest rise of the audited total over the scene's energy"},
    {"steps", APP_BENCH_INTEGER, offsetof(Row, steps), "steps", "accepted steps"},
    {"onsets", APP_BENCH_INTEGER, offsetof(Row, onsets), "onsets", "contacts that began and were located"},
    {"restarts", APP_BENCH_INTEGER, offsetof(Row, restarts), "restarts", "of the integrator"},
    {"energy_retries", APP_BENCH_INTEGER, offsetof(Row, energy_retries), "energy retries",
     "steps taken back because they gained energy"},
    {"newton_failures", APP_BENCH_INTEGER, offsetof(Row, newton_failures), NULL,
     "steps tried again because Newton's method or a force asked for it"},
    {"pairs_max", APP_BENCH_INTEGER, offsetof(Row, pairs_max), "pairs", "most pairs in contact"},
    {"contact_force_max", APP_BENCH_NUMBER, offsetof(Row, force_max), NULL, "largest contact force [N]"},
    {"deepest_overlap_max", APP_BENCH_NUMBER, offsetof(Row, deepest_overlap_max), NULL,
     "largest share of an element that was covered"},
    {"min_det_F", APP_BENCH_NUMBER, offsetof(Row, min_det_F), NULL, "smallest volume ratio of an element"},
    {"wall_s", APP_BENCH_NUMBER, offsetof(Row, wall), "wall s", "whole run"},
    {"cpu_s", APP_BENCH_NUMBER, offsetof(Row, cpu), "cpu s", "whole run"},
};
static const AppBenchReport report = {"drop", columns, sizeof columns / sizeof *columns, sizeof(Row), false};

static Status read_scene(const Options *options, double stiffness, double tolerance, FemSceneDef *scene) {
  if (!options->scene_path) return lab_scene_builtin_drop(stiffness, tolerance, scene);
  char kappa[64], error[64];
  snprintf(kappa, sizeof kappa, "contact.stiffness=%.17g", stiffness);
  snprintf(error, sizeof error, "time.tolerance=%.17g", tolerance);
  return app_scene_read(options->scene_path, (const char *const[]){kappa, error}, 2, scene);
}

static Row row_of(const LabTrial *trial, const Options *options, int rounds) {
  AppBenchTime time = app_bench_timer_time(&trial->timer, rounds);
  const FemRunResult *result = &trial->result;
  return (Row){.scene = options->scene_path ? options->scene_path : "(drop)",
               .outcome = lab_trial_outcome(trial),
               .tolerance = trial->scene.tolerance,
               .stiffness = trial->scene.contact.stiffness,
               .gain = result->audit.gain / result->audit.scale,
               .wall = time.wall,
               .cpu = time.cpu,
               .steps = result->integrator.steps,
               .onsets = result->integrator.roots,
               .restarts = result->integrator.restarts,
               .energy_retries = result->energy_retries,
               .newton_failures = result->integrator.newton_failures,
               .pairs_max = result->pairs_max,
               .force_max = result->contact_force_max,
               .deepest_overlap_max = result->deepest_overlap_max,
               .min_det_F = result->min_det_F};
}

// A run that the solver gives up is a result as well: it becomes a row.
static Status measure(LabTrial *trial, const Options *options, double stiffness, double tolerance, Row *row) {
  TRY(read_scene(options, stiffness, tolerance, &trial->scene));
  TRY(lab_trial_begin(trial, &options->common, 0));
  trial->accepts_failure = true;
  int rounds = 0;
  while (rounds < options->common.repeats && trial->outcome == STATUS_OK) TRY(lab_trial_run(trial, rounds++));
  if (trial->outcome != STATUS_OK) log_warning("κ = %g Pa: %s", stiffness, trial->message);
  *row = row_of(trial, options, rounds);
  return STATUS_OK;
}

static Status measure_all(const Options *options, LabTrial *trial, Row *rows, int *row_count) {
  for (int e = 0; e < options->tolerance_count; e++)
    for (int k = 0; k < options->stiffness_count; k++) {
      double stiffness = options->stiffness[k];
      log_progress("κ = %g Pa, %d of %d", stiffness, *row_count + 1,
                   options->tolerance_count * options->stiffness_count);
      Status status = measure(trial, options, stiffness, options->tolerance[e], &rows[*row_count]);
      lab_trial_end(trial);
      *trial = (LabTrial){0};
      log_progress_end();
      if (status != STATUS_OK) return status;
      ++*row_count;
    }
  return STATUS_OK;
}

static Status run(const Options *options) {
  Row rows[APP_BENCH_MAX_LIST * APP_BENCH_MAX_LIST];
  int row_count = 0;
  LabTrial *trial = memory_zeroed(1, sizeof *trial);
  if (!trial) return status_no_memory("the run");
  Status status = measure_all(options, trial, rows, &row_count);
  memory_free(trial);
  return status ? status : app_bench_report_print(&report, &options->common, rows, row_count);
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .doc = "Measure how much energy a drop gains, over contact stiffness and tolerance.",
    .children = app_bench_command_children,
    .help_filter = app_bench_command_help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = {.threads = 1, .repeats = 1},
                     .stiffness = {1e5, 1e6, 1e7, 1e8, 1e9},
                     .stiffness_count = 5,
                     .tolerance = {1e-4},
                     .tolerance_count = 1};
  app_bench_command_read(&lab_drop, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_drop = {.name = "drop",
                             .help = "energy gain of a drop, over contact stiffness",
                             .argp = &argp,
                             .run = run_command,
                             .has_threads = true,
                             .rows = &report,
                             .describe_rows = app_bench_command_rows};

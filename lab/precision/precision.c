// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/precision/precision.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/bench/command.h"
#include "app/bench/report.h"
#include "app/cli/argument.h"
#include "app/compare/comparison.h"
#include "app/compare/precision.h"
#include "app/scene/overlap.h"
#include "app/scene/refine.h"
#include "base/log.h"
#include "base/memory.h"
#include "lab/precision/summary.h"
#include "lab/trial.h"

enum { MAX_SCENES = 16, MAX_OVERLAPS = 16, MAX_OVERRIDES = 64 };

typedef struct Options {
  AppBenchOptions common;
  const char *scenes[MAX_SCENES];
  int scene_count;
  const char *overlaps[MAX_OVERLAPS]; // names or weights files
  int overlap_count;
  double tolerances[APP_BENCH_MAX_LIST], levels[APP_BENCH_MAX_LIST];
  int tolerance_count, level_count;
  const char *reference;
  double reference_tolerance, wall_limit_s;
  const char *overrides[MAX_OVERRIDES + 2]; // two places are for the model and the tolerance
  int override_count;
} Options;

enum { KEY_REFERENCE = 256, KEY_REFERENCE_TOLERANCE, KEY_WALL };

static const struct argp_option option_table[] = {
    {"overlap", 'm', "NAME,...", 0,
     "Overlap models, by name or weights file; the first is what the summary holds the others against "
     "(default: clip,geo,geo-small)",
     1},
    {"tolerance", 'e', "SHARE,...", 0, "Tolerances of the time integration (default: 1e-3,3e-4,1e-4,3e-5)",
     1},
    {"level", 'l', "FACTOR,...", 0, "Mesh levels: edges are divided by it (default: 1)", 1},
    {"reference", KEY_REFERENCE, "NAME", 0, "Overlap model of the reference (default: clip)", 1},
    {"reference-tolerance", KEY_REFERENCE_TOLERANCE, "SHARE", 0, "Tolerance of the reference (default: 1e-6)",
     1},
    {"wall", KEY_WALL, "SECONDS", 0, "Cut a run short that takes longer (default: 60; references never)", 1},
    {"set", 's', "KEY=VALUE", 0, "Replace a value of the scenes, as in time.end=0.2; may be repeated", 1},
    {0},
};

static error_t parse_argument(char *text, Options *options, struct argp_state *state) {
  app_argument_add(state, "scenes", text, MAX_SCENES, options->scenes, &options->scene_count);
  return 0;
}

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->common;
    return 0;
  case 'm':
    options->overlap_count =
        app_argument_list(state, "overlap", text, "clip,geo", MAX_OVERLAPS, options->overlaps);
    return 0;
  case 'e':
    options->tolerance_count =
        app_bench_options_numbers(state, "tolerance", text, 1e-12, 0.1, options->tolerances);
    return 0;
  case 'l':
    options->level_count = app_bench_options_numbers(state, "level", text, 0.1, 64, options->levels);
    return 0;
  case KEY_REFERENCE:
    options->reference = text;
    return 0;
  case KEY_REFERENCE_TOLERANCE:
    options->reference_tolerance = app_argument_number(state, "reference-tolerance", text, 1e-12, 0.1);
    return 0;
  case KEY_WALL:
    options->wall_limit_s = app_argument_number(state, "wall", text, 1e-3, 1e7);
    return 0;
  case 's':
    app_argument_add(state, "--set", text, MAX_OVERRIDES, options->overrides, &options->override_count);
    return 0;
  case ARGP_KEY_ARG:
    return parse_argument(text, options, state);
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "name scene files with contact, as in examples/02_two_blocks.yaml");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

typedef struct Row {
  const char *scene, *overlap, *reference, *outcome;
  double level, tolerance;
  long long tetrahedra, steps, rejected, error_failures, newton_failures, newton_iterations, setups;
  long long energy_retries, restarts;
  double trajectory, force, centre, force_finest, gain, wall, cpu, spread, overlap_s;
} Row;

static const AppBenchColumn columns[] = {
    {"scene", APP_BENCH_TEXT, offsetof(Row, scene), "scene", "file"},
    {"level", APP_BENCH_NUMBER, offsetof(Row, level), "level", "what the edges of the scene were divided by"},
    {"tetrahedra", APP_BENCH_INTEGER, offsetof(Row, tetrahedra), NULL, "of all bodies and obstacles"},
    {"overlap", APP_BENCH_TEXT, offsetof(Row, overlap), "overlap", "overlap model"},
    {"tolerance", APP_BENCH_NUMBER, offsetof(Row, tolerance), "tolerance", "of the time integration"},
    {"outcome", APP_BENCH_TEXT, offsetof(Row, outcome), "outcome", "finished, failed or cut short (--wall)"},
    {"trajectory_error", APP_BENCH_NUMBER, offsetof(Row, trajectory), "path RMS/L",
     "RMS over vertices and frames of the distance from the reference on this mesh, over the smallest body's "
     "diagonal"},
    {"force_error", APP_BENCH_NUMBER, offsetof(Row, force), "force L2",
     "‖Δf‖₂/‖f‖₂ of the forces between bodies over all frames, likewise"},
    {"centre_error_finest", APP_BENCH_NUMBER, offsetof(Row, centre), "centre, finest",
     "RMS distance of the bodies' centres from the reference on the finest mesh, over the diagonal"},
    {"force_error_finest", APP_BENCH_NUMBER, offsetof(Row, force_finest), NULL,
     "of the forces, against the reference on the finest mesh"},
    {"steps", APP_BENCH_INTEGER, offsetof(Row, steps), "steps", "accepted steps"},
    {"rejected", APP_BENCH_INTEGER, offsetof(Row, rejected), "rejected",
     "steps tried again: error test, Newton's method, energy audit"},
    {"error_test_failures", APP_BENCH_INTEGER, offsetof(Row, error_failures), NULL, "of the rejected"},
    {"newton_failures", APP_BENCH_INTEGER, offsetof(Row, newton_failures), NULL, "of the rejected"},
    {"energy_retries", APP_BENCH_INTEGER, offsetof(Row, energy_retries), NULL, "of the rejected"},
    {"newton_iterations", APP_BENCH_INTEGER, offsetof(Row, newton_iterations), "Newton", "Newton iterations"},
    {"setups", APP_BENCH_INTEGER, offsetof(Row, setups), NULL, "matrices that were factorised"},
    {"restarts", APP_BENCH_INTEGER, offsetof(Row, restarts), NULL, "of the integrator"},
    {"energy_gain_relative", APP_BENCH_NUMBER, offsetof(Row, gain), "energy gain",
     "largest rise of the audited total over the scene's energy"},
    {"wall_s", APP_BENCH_NUMBER, offsetof(Row, wall), "wall s", "whole run"},
    {"cpu_s", APP_BENCH_NUMBER, offsetof(Row, cpu), "cpu s", "whole run"},
    {"spread", APP_BENCH_NUMBER, offsetof(Row, spread), NULL, "of the wall time: (max − min) / median"},
    {"overlap_s", APP_BENCH_NUMBER, offsetof(Row, overlap_s), "overlap s", "wall time of the overlap model"},
    {"reference", APP_BENCH_TEXT, offsetof(Row, reference), NULL,
     "overlap model and tolerance of the reference"},
};
static const AppBenchReport report = {"precision", columns, sizeof columns / sizeof *columns, sizeof(Row),
                                      false};

// One scene on one mesh.
typedef struct Stage {
  const Options *options;
  const char *scene;
  double level;
  const char *reference;            // in words
  const AppPrecisionCourse *finest; // borrowed
} Stage;

typedef struct Table {
  Row *rows;
  int count;
} Table;

static Status begin(LabTrial *trial, const Stage *stage, const char *overlap, double tolerance) {
  const Options *options = stage->options;
  const char *overrides[MAX_OVERRIDES + 1];
  char error[64];
  snprintf(error, sizeof error, "time.tolerance=%.17g", tolerance);
  for (int i = 0; i < options->override_count; i++) overrides[i] = options->overrides[i];
  overrides[options->override_count] = error;
  TRY(app_scene_overlap_read(stage->scene, overrides, options->override_count + 1, overlap, &trial->scene));
  TRY(app_scene_refine(&trial->scene, stage->level));
  trial->keeps_trajectory = trial->accepts_failure = true;
  return lab_trial_begin(trial, &options->common, 0);
}

static Row row_of(const LabTrial *trial, const Stage *stage, const FemRunResult *reference,
                  const AppPrecisionCourse *course) {
  AppBenchTime time = app_bench_timer_time(&trial->timer, stage->options->common.repeats);
  const FemRunResult *result = &trial->result;
  const FemIntegratorStats *counts = &result->integrator;
  bool is_whole = trial->outcome == STATUS_OK;
  double length = trial->model.length;
  return (Row){.scene = stage->scene,
               .overlap = trial->scene.contact.overlap,
               .reference = stage->reference,
               .outcome = lab_trial_outcome(trial),
               .level = stage->level,
               .tolerance = trial->scene.tolerance,
               .tetrahedra = trial->model.tet_count,
               .steps = counts->steps,
               .rejected = counts->error_test_failures + counts->newton_failures + result->energy_retries,
               .error_failures = counts->error_test_failures,
               .newton_failures = counts->newton_failures,
               .newton_iterations = counts->newton_iterations,
               .setups = counts->setups,
               .energy_retries = result->energy_retries,
               .restarts = counts->restarts,
               .trajectory = is_whole ? app_comparison_trajectory_error(result, reference) / length : NAN,
               .force = is_whole ? app_comparison_force_error(result, reference).l2 : NAN,
               .centre = is_whole ? app_precision_course_centre_error(course, stage->finest) / length : NAN,
               .force_finest = is_whole ? app_precision_course_force_error(course, stage->finest) : NAN,
               .gain = result->audit.gain / result->audit.scale,
               .wall = time.wall,
               .cpu = time.cpu,
               .spread = (time.wall_max - time.wall_min) / time.wall,
               .overlap_s = lab_trial_phases(trial, stage->options->common.repeats).overlap};
}

static Status add_row(const LabTrial *trial, const Stage *stage, const FemRunResult *reference,
                      const char *overlap, Table *table) {
  AppPrecisionCourse course;
  TRY(app_precision_course_create(&course, &trial->model, &trial->result));
  table->rows[table->count] = row_of(trial, stage, reference, &course);
  table->rows[table->count++].overlap = overlap; // the scene's own string ends with the trial
  app_precision_course_destroy(&course);
  if (trial->outcome != STATUS_OK)
    log_warning("%s, %s at %g: %s: %s", stage->scene, overlap, trial->scene.tolerance,
                lab_trial_outcome(trial), trial->message);
  return STATUS_OK;
}

static Status run_contestants(LabTrial *trials, const Stage *stage, const FemRunResult *reference,
                              Table *table) {
  const Options *options = stage->options;
  int count = 0;
  for (int m = 0; m < options->overlap_count; m++)
    for (int e = 0; e < options->tolerance_count; e++) {
      trials[count].wall_limit_s = options->wall_limit_s;
      TRY(begin(&trials[count++], stage, options->overlaps[m], options->tolerances[e]));
    }
  TRY(app_bench_timer_take_turns(trials, sizeof *trials, count, options->common.repeats, false,
                                 lab_trial_run));
  for (int t = 0; t < count; t++)
    TRY(add_row(&trials[t], stage, reference, options->overlaps[t / options->tolerance_count], table));
  return STATUS_OK;
}

static Status run_reference(LabTrial *trial, const Stage *stage) {
  const Options *options = stage->options;
  trial->step_limit = 0;
  log_progress("%s, level %g: reference", stage->scene, stage->level);
  TRY(begin(trial, stage, options->reference, options->reference_tolerance));
  if (!trial->scene.contact.is_on)
    return status_fail(STATUS_INPUT,
                       "%s: has no contact, so overlap models cannot differ; add a 'contact' section",
                       stage->scene);
  TRY(lab_trial_run(trial, 0));
  log_progress_end();
  if (trial->outcome == STATUS_OK) return STATUS_OK;
  return status_fail(STATUS_SOLVER, "%s, the reference at tolerance %g: %s", stage->scene,
                     options->reference_tolerance, trial->message);
}

// The first level of a scene is the finest: its reference's course is kept for the others.
static Status run_stage(Stage *stage, AppPrecisionCourse *finest, Table *table) {
  int count = stage->options->overlap_count * stage->options->tolerance_count;
  LabTrial *trials = memory_zeroed((size_t)count + 1, sizeof *trials), *reference = trials + count;
  if (!trials) return status_no_memory("the runs");
  Status status = run_reference(reference, stage);
  if (!status && !finest->centres)
    status = app_precision_course_create(finest, &reference->model, &reference->result);
  stage->finest = finest;
  if (!status) status = run_contestants(trials, stage, &reference->result, table);
  for (int t = 0; t <= count; t++) lab_trial_end(&trials[t]);
  memory_free(trials);
  return status;
}

static void sort_down(double *levels, int count) {
  for (int i = 1; i < count; i++)
    for (int j = i; j > 0 && levels[j] > levels[j - 1]; j--) {
      double kept = levels[j];
      levels[j] = levels[j - 1], levels[j - 1] = kept;
    }
}

static Status run_scene(const Options *options, const char *scene, const char *reference, Table *table) {
  AppPrecisionCourse finest = {0};
  Status status = STATUS_OK;
  for (int l = 0; l < options->level_count && !status; l++) {
    Stage stage = {.options = options, .scene = scene, .level = options->levels[l], .reference = reference};
    status = run_stage(&stage, &finest, table);
  }
  app_precision_course_destroy(&finest);
  return status;
}

static Status summarise(const Options *options, const Table *table) {
  LabPrecisionRun *runs = memory_zeroed((size_t)table->count, sizeof *runs);
  if (!runs) return status_no_memory("the summary");
  for (int r = 0; r < table->count; r++) {
    const Row *row = &table->rows[r];
    runs[r] = (LabPrecisionRun){.scene = row->scene,
                                .overlap = row->overlap,
                                .level = row->level,
                                .tolerance = row->tolerance,
                                .is_finished = strcmp(row->outcome, "finished") == 0,
                                .steps = (double)row->steps,
                                .rejected = (double)row->rejected,
                                .newton_iterations = (double)row->newton_iterations,
                                .setups = (double)row->setups,
                                .cpu_s = row->cpu,
                                .wall_s = row->wall,
                                .overlap_s = row->overlap_s,
                                .force_error = row->force,
                                .trajectory_error = row->trajectory};
  }
  Status status = lab_precision_summary_print(&options->common, options->overlaps, options->overlap_count,
                                              runs, table->count);
  memory_free(runs);
  return status;
}

static Status run(Options *options) {
  char reference[1100];
  snprintf(reference, sizeof reference, "%s at %g", options->reference, options->reference_tolerance);
  sort_down(options->levels, options->level_count);
  Table table = {.rows = memory_zeroed((size_t)(options->scene_count * options->level_count *
                                                options->overlap_count * options->tolerance_count),
                                       sizeof *table.rows)};
  if (!table.rows) return status_no_memory("the rows");
  Status status = STATUS_OK;
  for (int s = 0; s < options->scene_count && !status; s++)
    status = run_scene(options, options->scenes[s], reference, &table);
  if (!status) status = app_bench_report_print(&report, &options->common, table.rows, table.count);
  if (!status && options->common.format != APP_BENCH_FORMAT_CSV) status = summarise(options, &table);
  memory_free(table.rows);
  return status;
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "SCENE…",
    .doc = "Measure what precision costs: whole runs with every overlap model, at every tolerance, on every "
           "mesh level, against a reference at a far smaller tolerance.",
    .children = app_bench_command_children,
    .help_filter = app_bench_command_help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = app_bench_options_default(1),
                     .overlaps = {"clip", "geo", "geo-small"},
                     .overlap_count = 3,
                     .tolerances = {1e-3, 3e-4, 1e-4, 3e-5},
                     .tolerance_count = 4,
                     .levels = {1},
                     .level_count = 1,
                     .reference = "clip",
                     .reference_tolerance = 1e-6,
                     .wall_limit_s = 60};
  app_bench_command_read(&lab_precision, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_precision = {
    .name = "precision",
    .help = "error of whole runs against their time, over tolerances and mesh levels",
    .argp = &argp,
    .run = run_command,
    .has_threads = true,
    .rows = &report,
    .describe_rows = app_bench_command_rows};

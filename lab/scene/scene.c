// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/scene/scene.h"

#include <stdio.h>
#include <string.h>

#include "app/bench/command.h"
#include "app/bench/models.h"
#include "app/bench/report.h"
#include "app/cli/argument.h"
#include "app/cli/model_names.h"
#include "app/scene/overlap.h"
#include "base/memory.h"
#include "lab/trial.h"

enum { MAX_SCENES = 16, MAX_OVERRIDES = 64 };

typedef struct Options {
  AppBenchOptions common;
  const char *scenes[MAX_SCENES];
  int scene_count;
  const char *overlaps[APP_BENCH_MAX_MODELS]; // names and weights files; none: each scene's own
  int overlap_count;
  const char *overrides[MAX_OVERRIDES + 1]; // the last place is for the overlap model
  int override_count;
} Options;

static const struct argp_option option_table[] = {
    {"overlap", 'm', "NAME,...", 0,
     "Take these overlap models, or weights files, in turns (default: the scene's)", 1},
    {"set", 's', "KEY=VALUE", 0,
     "Replace a value of the scenes, as in contact.stiffness=1e6; may be repeated", 1},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->common;
    return 0;
  case 'm':
    options->overlap_count = app_bench_models_read(state, "overlap", text, options->overlaps);
    return 0;
  case 's':
    app_argument_add(state, "--set", text, MAX_OVERRIDES, options->overrides, &options->override_count);
    return 0;
  case ARGP_KEY_ARG:
    app_argument_add(state, "scenes", text, MAX_SCENES, options->scenes, &options->scene_count);
    return 0;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "name scene files, as in examples/01_drop.yaml");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

typedef struct Row {
  const char *scene, *overlap, *solver;
  long long vertices, tetrahedra, unknowns, steps, factorisations, pairs_max;
  double wall, cpu, spread, phases[LAB_TRIAL_PHASE_COUNT], gain;
} Row;

#define PHASE(name, number, head)                                                                            \
  {                                                                                                          \
    name "_s", APP_BENCH_NUMBER, offsetof(Row, phases) + (number) * sizeof(double), head,                    \
        "wall time of " name                                                                                 \
  }

static const AppBenchColumn columns[] = {
    {"scene", APP_BENCH_TEXT, offsetof(Row, scene), "scene", "file"},
    {"overlap", APP_BENCH_TEXT, offsetof(Row, overlap), "overlap", "overlap model, empty without contact"},
    {"solver", APP_BENCH_TEXT, offsetof(Row, solver), NULL, "linear solver"},
    {"vertices", APP_BENCH_INTEGER, offsetof(Row, vertices), "vertices", "of all bodies and obstacles"},
    {"tetrahedra", APP_BENCH_INTEGER, offsetof(Row, tetrahedra), "tetrahedra", "of all bodies and obstacles"},
    {"unknowns", APP_BENCH_INTEGER, offsetof(Row, unknowns), NULL, "degrees of freedom that are not fixed"},
    {"steps", APP_BENCH_INTEGER, offsetof(Row, steps), "steps", "accepted steps"},
    {"factorisations", APP_BENCH_INTEGER, offsetof(Row, factorisations), "factorisations", "of the matrix"},
    {"pairs_max", APP_BENCH_INTEGER, offsetof(Row, pairs_max), "pairs", "most pairs in contact"},
    {"energy_gain_relative", APP_BENCH_NUMBER, offsetof(Row, gain), "energy gain",
     "largest rise of the audited total over the scene's energy"},
    {"wall_s", APP_BENCH_NUMBER, offsetof(Row, wall), "wall s", "whole run"},
    {"cpu_s", APP_BENCH_NUMBER, offsetof(Row, cpu), "cpu s", "whole run"},
    {"spread", APP_BENCH_NUMBER, offsetof(Row, spread), "spread", "of the wall time: (max − min) / median"},
    PHASE("broad_phase", 0, NULL),
    PHASE("overlap", 1, "overlap s"),
    PHASE("contact", 2, NULL),
    PHASE("forces", 3, NULL),
    PHASE("assembly", 4, NULL),
    PHASE("analysis", 5, NULL),
    PHASE("factorisation", 6, NULL),
    PHASE("solve", 7, NULL),
    PHASE("output", 8, NULL),
    PHASE("other", 9, NULL),
};
static const AppBenchReport report = {"scene", columns, sizeof columns / sizeof *columns, sizeof(Row), false};

static Row row_of(const LabTrial *trial, const char *overlap, int rounds) {
  AppBenchTime time = app_bench_timer_time(&trial->timer, rounds);
  const FemRunResult *result = &trial->result;
  Row row = {.scene = trial->scene.path,
             .overlap = trial->scene.contact.is_on ? overlap : NULL,
             .solver = result->solver_name,
             .vertices = trial->model.vertex_count,
             .tetrahedra = trial->model.tet_count,
             .unknowns = trial->model.free_count,
             .steps = result->integrator.steps,
             .factorisations = result->solver.factorisations,
             .pairs_max = result->pairs_max,
             .wall = time.wall,
             .cpu = time.cpu,
             .spread = (time.wall_max - time.wall_min) / time.wall,
             .gain = result->audit.gain / result->audit.scale};
  FemRunPhases phases = lab_trial_phases(trial, rounds);
  lab_trial_split(&phases, row.phases);
  return row;
}

// `overlap` NULL: the scene's own.
static Status begin(LabTrial *trial, Options *options, const char *path, const char *overlap) {
  TRY(app_scene_overlap_read(path, options->overrides, options->override_count, overlap, &trial->scene));
  return lab_trial_begin(trial, &options->common, 0);
}

// What each run's overlap model is called: those that were asked for in a list, a scene's own by itself.
static Status name_overlaps(const LabTrial *trials, AppModelName *names, int count, const Options *options) {
  if (options->overlap_count) {
    TRY(app_model_names_find(options->overlap_count, options->overlaps, names));
    for (int t = options->overlap_count; t < count; t++)
      memcpy(names[t], names[t % options->overlap_count], sizeof *names);
    return STATUS_OK;
  }
  for (int t = 0; t < count; t++) {
    char source[PATH_MAX];
    if (app_scene_overlap_source(&trials[t].scene, source)) app_model_names_find_one(source, names[t]);
  }
  return STATUS_OK;
}

static Status measure(LabTrial *trials, AppModelName *names, Row *rows, int count, Options *options) {
  int rounds = options->common.repeats, models = options->overlap_count ? options->overlap_count : 1;
  for (int t = 0; t < count; t++)
    TRY(begin(&trials[t], options, options->scenes[t / models],
              options->overlap_count ? options->overlaps[t % models] : NULL));
  TRY(name_overlaps(trials, names, count, options));
  TRY(app_bench_timer_take_turns(trials, sizeof *trials, count, rounds, false, lab_trial_run));
  for (int t = 0; t < count; t++) rows[t] = row_of(&trials[t], names[t], rounds);
  return app_bench_report_print(&report, &options->common, rows, count);
}

static Status run(Options *options) {
  int count = options->scene_count * (options->overlap_count ? options->overlap_count : 1);
  LabTrial *trials = memory_zeroed((size_t)count, sizeof *trials);
  AppModelName *names = memory_zeroed((size_t)count, sizeof *names);
  Row *rows = memory_zeroed((size_t)count, sizeof *rows);
  Status status =
      trials && names && rows ? measure(trials, names, rows, count, options) : status_no_memory("the runs");
  for (int t = 0; t < count && trials; t++) lab_trial_end(&trials[t]);
  memory_free(trials), memory_free(names), memory_free(rows);
  return status;
}

static const struct argp argp = {.options = option_table,
                                 .parser = parse,
                                 .args_doc = "SCENE…",
                                 .doc = "Measure whole runs of scenes; nothing is written.",
                                 .children = app_bench_command_children,
                                 .help_filter = app_bench_command_help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = {.threads = 1, .repeats = 3}};
  app_bench_command_read(&lab_scene, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_scene = {.name = "scene",
                              .help = "whole runs of scenes",
                              .argp = &argp,
                              .run = run_command,
                              .has_threads = true,
                              .rows = &report,
                              .describe_rows = app_bench_command_rows};

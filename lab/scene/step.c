// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/scene/step.h"

#include "app/bench/command.h"
#include "app/bench/report.h"
#include "app/cli/argument.h"
#include "app/scene/read.h"
#include "base/memory.h"
#include "lab/trial.h"

enum { MAX_OVERRIDES = 64 };

typedef struct Options {
  AppBenchOptions common;
  const char *scene;
  const char *overrides[MAX_OVERRIDES];
  int override_count;
  int steps; // 0: to the scene's end
} Options;

static const struct argp_option option_table[] = {
    {"set", 's', "KEY=VALUE", 0, "Replace a value of the scene, as in contact.overlap=exact; may be repeated",
     1},
    {"steps", 'k', "N", 0, "End the run after N steps (default: at the scene's end)", 1},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->common;
    return 0;
  case 's':
    app_argument_add(state, "--set", text, MAX_OVERRIDES, options->overrides, &options->override_count);
    return 0;
  case 'k':
    options->steps = (int)app_argument_integer(state, "steps", text, 1, 1000000000);
    return 0;
  case ARGP_KEY_ARG:
    if (options->scene) argp_error(state, "one scene at a time; '%s' is the second", text);
    options->scene = text;
    return 0;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "name a scene file, as in examples/01_drop.yaml");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

typedef struct Row {
  const char *scene, *overlap, *phase;
  long long steps;
  double wall, per_step, share;
} Row;

static const AppBenchColumn columns[] = {
    {"scene", APP_BENCH_TEXT, offsetof(Row, scene), NULL, "file"},
    {"overlap", APP_BENCH_TEXT, offsetof(Row, overlap), NULL, "overlap model, empty without contact"},
    {"phase", APP_BENCH_TEXT, offsetof(Row, phase), "phase", "as in summary.json; the last row is `total`"},
    {"steps", APP_BENCH_INTEGER, offsetof(Row, steps), "steps", "accepted steps"},
    {"wall_s", APP_BENCH_NUMBER, offsetof(Row, wall), "wall s", "in the whole run"},
    {"wall_s_per_step", APP_BENCH_NUMBER, offsetof(Row, per_step), "s a step", "wall time over steps"},
    {"share", APP_BENCH_NUMBER, offsetof(Row, share), "share", "of the run's wall time"},
};
static const AppBenchReport report = {"step", columns, sizeof columns / sizeof *columns, sizeof(Row), false};

static Row row_of(const LabTrial *trial, const char *phase, double seconds, double total) {
  long long steps = trial->result.integrator.steps;
  return (Row){.scene = trial->scene.path,
               .overlap = trial->scene.contact.is_on ? trial->scene.contact.overlap : NULL,
               .phase = phase,
               .steps = steps,
               .wall = seconds,
               .per_step = seconds / (double)steps,
               .share = seconds / total};
}

static Status print(const LabTrial *trial, const Options *options) {
  Row rows[LAB_TRIAL_PHASE_COUNT + 1];
  double seconds[LAB_TRIAL_PHASE_COUNT];
  FemRunPhases phases = lab_trial_phases(trial, options->common.repeats);
  lab_trial_split(&phases, seconds);
  for (int p = 0; p < LAB_TRIAL_PHASE_COUNT; p++)
    rows[p] = row_of(trial, lab_trial_phase_names[p], seconds[p], phases.total);
  rows[LAB_TRIAL_PHASE_COUNT] = row_of(trial, "total", phases.total, phases.total);
  return app_bench_report_print(&report, &options->common, rows, LAB_TRIAL_PHASE_COUNT + 1);
}

static Status measure(LabTrial *trial, const Options *options) {
  TRY(app_scene_read(options->scene, options->overrides, options->override_count, &trial->scene));
  TRY(lab_trial_begin(trial, &options->common, options->steps));
  TRY(app_bench_timer_take_turns(trial, sizeof *trial, 1, options->common.repeats, false, lab_trial_run));
  return print(trial, options);
}

static Status run(const Options *options) {
  LabTrial *trial = memory_zeroed(1, sizeof *trial);
  if (!trial) return status_no_memory("the run");
  Status status = measure(trial, options);
  lab_trial_end(trial);
  memory_free(trial);
  return status;
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "SCENE",
    .doc = "Measure where the time of a run goes, one row a phase; nothing is written.",
    .children = app_bench_command_children,
    .help_filter = app_bench_command_help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = {.threads = 1, .repeats = 3}};
  app_bench_command_read(&lab_step, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_step = {.name = "step",
                             .help = "where the time of a run goes",
                             .argp = &argp,
                             .run = run_command,
                             .has_threads = true,
                             .rows = &report,
                             .describe_rows = app_bench_command_rows};

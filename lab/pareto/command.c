// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/pareto/command.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "app/bench/overlap/pairs.h"
#include "app/cli/argument.h"
#include "app/job/job.h"
#include "app/plot/gnuplot.h"
#include "app/plot/plot.h"
#include "app/training/sweep.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "lab/pareto/pairs.h"
#include "lab/pareto/scenes.h"

enum { MAX_OVERRIDES = 64 };

typedef struct Options {
  LabPareto pareto; // what is measured and how
  const char *directory, *sweep, *reference;
  const char *models[LAB_PARETO_MAX_MODELS];
  int model_count; // 0: all
  const char *scenes[LAB_PARETO_MAX_SCENES];
  int scene_count;
  bool wants_set[APP_BENCH_SET_COUNT];
  const char *overrides[MAX_OVERRIDES];
  int override_count;
} Options;

enum { KEY_SWEEP = 256, KEY_SET, KEY_COUNT, KEY_BATCH, KEY_WALL, KEY_ROUNDS, KEY_AUDIT, KEY_REFERENCE };

static const struct argp_option option_table[] = {
    {"output", 'o', "DIR", 0, "Write pareto.json, pareto.csv and pictures here (default: out/pareto)", 1},
    {"model", 'm', "NAME,...", 0, "Models, by name or weights file (default: all that there are)", 1},
    {"sweep", KEY_SWEEP, "DIR", 0,
     "Also the networks of this sweep, as in examples/train/sweep; what is not in DIR/weights of the output "
     "is trained first",
     1},
    {"pairs", KEY_SET, "NAME,...", 0, "Sets of pairs: near, uniform (default: both)", 1},
    {"count", 'n', "N", 0, "Pairs that errors are taken over (default: 20000; slow models fewer)", 1},
    {"batch", 'b', "N", 0, "Pairs a call (default: 2048, the paper's)", 1},
    {"device", 'D', "NAME", 0,
     "Also the models that have kernels on a device: host, opencl, cuda, auto (`tetlap devices` lists them); "
     "pairs and answers lie there, --count pairs a call",
     1},
    {"wall", KEY_WALL, "SECONDS", 0, "Stop a scene's run after this wall time (default: 60)", 1},
    {"rounds", KEY_ROUNDS, "N", 0, "Runs of each scene with each model, in turns (default: 1)", 1},
    {"audit", KEY_AUDIT, "K", 0, "Evaluate all models in every K-th step in contact (default: 20)", 1},
    {"reference", KEY_REFERENCE, "NAME", 0, "Overlap model of the scenes' reference run (default: clip)", 1},
    {"set", 's', "KEY=VALUE", 0, "Replace a value of the scenes, as in time.end=0.2; may be repeated", 1},
    {0},
};

static error_t parse_number(int key, char *text, struct argp_state *state, LabPareto *pareto) {
  switch (key) {
  case 'n':
    pareto->error_pairs = (int)app_argument_integer(state, "count", text, 1, 10000000);
    return 0;
  case 'b':
    pareto->batch = (int)app_argument_integer(state, "batch", text, 1, 10000000);
    return 0;
  case KEY_WALL:
    pareto->scene_wall_s = app_argument_number(state, "wall", text, 1e-3, 1e7);
    return 0;
  case KEY_ROUNDS:
    pareto->scene_rounds = (int)app_argument_integer(state, "rounds", text, 1, APP_BENCH_MAX_REPEATS);
    return 0;
  case KEY_AUDIT:
    pareto->audit_every = (int)app_argument_integer(state, "audit", text, 1, 1000000000);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->pareto.common;
    return 0;
  case 'o':
    options->directory = text;
    return 0;
  case 'm':
    options->model_count =
        app_argument_list(state, "model", text, "clip,geo", LAB_PARETO_MAX_MODELS, options->models);
    return 0;
  case KEY_SWEEP:
    options->sweep = text;
    return 0;
  case 'D':
    options->pareto.device = text;
    return 0;
  case KEY_SET:
    app_bench_options_choose(state, "pairs", text, app_bench_sets, 2, options->wants_set);
    return 0;
  case KEY_REFERENCE:
    options->reference = text;
    return 0;
  case 's':
    app_argument_add(state, "--set", text, MAX_OVERRIDES, options->overrides, &options->override_count);
    return 0;
  case ARGP_KEY_ARG:
    app_argument_add(state, "scenes", text, LAB_PARETO_MAX_SCENES, options->scenes, &options->scene_count);
    return 0;
  default:
    return parse_number(key, text, state, &options->pareto);
  }
}

// Models without weights are left out, by name, unless they were asked for.
static Status add_all(LabPareto *pareto) {
  int count;
  const OverlapOps *const *models = overlap_model_list(&count);
  for (int m = 0; m < count; m++) {
    Status status = lab_pareto_add_model(pareto, models[m]->name);
    if (status == STATUS_IO)
      log_warning("left out: %s", status_message());
    else
      TRY(status);
  }
  return STATUS_OK;
}

static Status add_named(LabPareto *pareto, const Options *options) {
  for (int m = 0; m < options->model_count; m++) {
    Status status = lab_pareto_add_model(pareto, options->models[m]);
    if (status) return status == STATUS_INPUT ? status_prefix(STATUS_USAGE, "--model") : status;
  }
  return STATUS_OK;
}

static Status add_sweep(LabPareto *pareto, const Options *options) {
  AppSweep sweep;
  char *weights = file_join(options->directory, "weights");
  if (!weights) return status_no_memory("the sweep");
  Status status = file_make_directories(weights);
  if (!status)
    status = app_sweep_train(&sweep, options->sweep, weights, pareto->common.threads, app_job_stop_flag());
  memory_free(weights);
  TRY(status);
  for (int w = 0; w < sweep.count && !status; w++) status = lab_pareto_add_model(pareto, sweep.weights[w]);
  app_sweep_destroy(&sweep);
  return status;
}

static Status measure(LabPareto *pareto, const Options *options) {
  TRY(lab_pareto_create(pareto));
  TRY(options->model_count ? add_named(pareto, options) : add_all(pareto));
  for (int s = 0; s < options->scene_count; s++)
    TRY(lab_pareto_scenes_check(pareto, options->scenes[s], options->reference, options->overrides,
                                options->override_count));
  if (options->sweep) TRY(add_sweep(pareto, options));
  for (int set = 0; set < 2; set++)
    if (options->wants_set[set]) TRY(lab_pareto_pairs_measure(pareto, app_bench_sets[set]));
  for (int s = 0; s < options->scene_count; s++)
    TRY(lab_pareto_scenes_measure(pareto, options->scenes[s], options->reference, options->overrides,
                                  options->override_count));
  lab_pareto_finish(pareto);
  return lab_pareto_write(pareto, options->directory);
}

static Status print(const LabPareto *pareto) {
  TRY(app_bench_report_print(&lab_pareto_report, &pareto->common, pareto->points, (int)pareto->point_count));
  if (pareto->comparison_count == 0 || pareto->common.format == APP_BENCH_FORMAT_CSV) return STATUS_OK;
  if (pareto->common.format != APP_BENCH_FORMAT_JSON) puts("");
  return app_bench_report_print(&lab_pareto_comparison_report, &pareto->common, pareto->comparisons,
                                pareto->comparison_count);
}

static Status draw(const Record *points, const char *picture, const char *script) {
  FileWriter writer;
  TRY(file_begin(&writer, script));
  Status status = app_plot_frontier(writer.stream, picture, points, NULL);
  if (status) {
    file_abandon(&writer);
    return status;
  }
  TRY(file_commit(&writer));
  return app_gnuplot_run(script, picture);
}

// pareto.svg and pareto.png, with the scripts that drew them, as `tetlap plot` would.
static Status draw_all(const char *directory) {
  static const char *const pictures[] = {"pareto.svg", "pareto.png"}, *const scripts[] = {"pareto.svg.gp",
                                                                                          "pareto.png.gp"};
  char *path = file_join(directory, "pareto.json");
  Record *points = NULL;
  Status status = path ? record_read(&points, path) : status_no_memory("a file name");
  for (int k = 0; k < 2 && !status; k++) {
    char *picture = file_join(directory, pictures[k]), *script = file_join(directory, scripts[k]);
    status = picture && script ? draw(points, picture, script) : status_no_memory("a file name");
    memory_free(picture);
    memory_free(script);
  }
  if (points) record_destroy(points);
  memory_free(path);
  return status;
}

static Status run(Options *options) {
  LabPareto *pareto = &options->pareto;
  omp_set_num_threads(pareto->common.threads);
  Status status = measure(pareto, options);
  if (!status) status = print(pareto);
  if (!status && draw_all(options->directory) != STATUS_OK) log_warning("no picture: %s", status_message());
  if (!status) log_info("wrote %s: pareto.json, pareto.csv, pareto.svg, pareto.png", options->directory);
  lab_pareto_destroy(pareto);
  return status;
}

static char *help(int key, const char *text, void *input) {
  (void)input;
  return app_bench_report_help(&lab_pareto_report, key, text);
}

static const struct argp_child children[] = {{.argp = &app_bench_options_argp}, {0}};
static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "[SCENE…]",
    .doc =
        "Measure what accuracy costs: error against time of every overlap model and every size of network, "
        "for V, for ∇V, and for the contact forces of whole scenes, in one run.",
    .children = children,
    .help_filter = help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.pareto = {.common = app_bench_options_default(5),
                                .batch = 2048,
                                .error_pairs = 20000,
                                .scene_wall_s = 60,
                                .scene_rounds = 1,
                                .audit_every = 20,
                                .stop = app_job_stop_flag()},
                     .directory = "out/pareto",
                     .reference = "clip",
                     .wants_set = {true, true}};
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  app_job_prepare(&(AppJobOptions){0});
  return app_cli_command_end(run(&options));
}

const AppCommand lab_pareto_command = {.name = "pareto",
                                       .help = "measure error against time of all overlap models",
                                       .argp = &argp,
                                       .run = run_command,
                                       .has_threads = true};

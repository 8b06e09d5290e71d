// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/scene/scaling.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "app/bench/command.h"
#include "app/bench/contestant.h"
#include "app/bench/models.h"
#include "app/bench/overlap/pairs.h"
#include "app/bench/report.h"
#include "app/cli/argument.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/text.h"
#include "fem/run/check/choice.h"
#include "lab/scene/builtin.h"
#include "lab/trial.h"

enum { MAX_ROWS = APP_BENCH_MAX_MODELS * APP_BENCH_MAX_LIST + 16 * APP_BENCH_MAX_LIST };
static const double GIB = 1024.0 * 1024 * 1024;
static const uint64_t SEED = 1;

typedef struct Options {
  AppBenchOptions common;
  bool wants_model[APP_BENCH_MAX_MODELS];
  int pairs[APP_BENCH_MAX_LIST], pair_sizes;
  int nodes[APP_BENCH_MAX_LIST], node_sizes;
  int steps;
  const LabSceneLarge *scene;
  FemSolverKind solver;   // of its runs
  double memory, seconds; // limits of one size [GiB], [s]
} Options;

enum { KEY_MEMORY = 256, KEY_SECONDS, KEY_SOLVER, KEY_SCENE };

static const struct argp_option option_table[] = {
    {"model", 'm', "NAME,...", 0, "Overlap models (default: clip,geo-small,geo)", 1},
    {"pairs", 'p', "N,...", 0, "Pairs a call, V + ∇V (default: 1e3,1e4,1e5,1e6; 0: none)", 1},
    {"nodes", 'n', "N,...", 0, "Vertices of the scene (default: 1e3,3e3,1e4; 0: none)", 1},
    {"scene", KEY_SCENE, "NAME", 0, "blocks (the default), pressed, ball, press or floating (static)", 1},
    {"steps", 'k', "N", 0, "Steps of each run (default: 10)", 1},
    {"solver", KEY_SOLVER, "NAME", 0, "Linear solver of the runs (default: auto)", 1},
    {"memory", KEY_MEMORY, "GIB", 0, "Leave out sizes that take more (default: 6)", 1},
    {"seconds", KEY_SECONDS, "S", 0,
     "Leave out calls that take longer by the model's own guess, and end runs that "
     "do (default: 60)",
     1},
    {0},
};

static int read_sizes(struct argp_state *state, const char *option, char *text, int *sizes) {
  return strcmp(text, "0") == 0 ? 0 : app_bench_options_counts(state, option, text, 100000000, sizes);
}

static FemSolverKind read_solver(struct argp_state *state, char *text) {
  const char *names[FEM_SOLVER_COUNT];
  for (int k = 0; k < FEM_SOLVER_COUNT; k++) names[k] = fem_solver_name((FemSolverKind)k);
  return (FemSolverKind)app_bench_options_choose_one(state, "solver", text, names, FEM_SOLVER_COUNT);
}

static const LabSceneLarge *read_scene(struct argp_state *state, char *text) {
  const char *names[LAB_SCENE_LARGE_COUNT];
  for (int k = 0; k < LAB_SCENE_LARGE_COUNT; k++) names[k] = lab_scene_builtin_large[k].name;
  return &lab_scene_builtin_large[app_bench_options_choose_one(state, "scene", text, names,
                                                               LAB_SCENE_LARGE_COUNT)];
}

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->common;
    return 0;
  case 'm':
    app_bench_models_choose(state, "model", text, options->wants_model);
    return 0;
  case 'p':
    options->pair_sizes = read_sizes(state, "pairs", text, options->pairs);
    return 0;
  case 'n':
    options->node_sizes = read_sizes(state, "nodes", text, options->nodes);
    return 0;
  case 'k':
    options->steps = (int)app_argument_integer(state, "steps", text, 1, 1000000);
    return 0;
  case KEY_SOLVER:
    options->solver = read_solver(state, text);
    return 0;
  case KEY_SCENE:
    options->scene = read_scene(state, text);
    return 0;
  case KEY_MEMORY:
    options->memory = app_argument_number(state, "memory", text, 1e-3, 1e6);
    return 0;
  case KEY_SECONDS:
    options->seconds = app_argument_number(state, "seconds", text, 1e-3, 1e6);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

typedef struct Row {
  const char *subject, *of; // overlap and the model, or step and the phase
  long long size, done;     // pairs or vertices; calls or steps
  double seconds, cpu, spread, each, exponent;
  double newton, set_ups, iterations, peak; // of the whole run, of `total` alone
} Row;

static const AppBenchColumn columns[] = {
    {"subject", APP_BENCH_TEXT, offsetof(Row, subject), "of",
     "overlap (size: pairs) or step (size: vertices)"},
    {"name", APP_BENCH_TEXT, offsetof(Row, of), "",
     "overlap model, or of a step `total`, `Newton` (an iteration of Newton's method, everything in it) and "
     "its "
     "phases; `factorisation` is told a set-up"},
    {"size", APP_BENCH_INTEGER, offsetof(Row, size), "size", "pairs of a call, or vertices of the scene"},
    {"seconds", APP_BENCH_NUMBER, offsetof(Row, seconds), "s", "wall time of a call or a step [s]"},
    {"cpu_seconds", APP_BENCH_NUMBER, offsetof(Row, cpu), "cpu s", "processor time of it; not of phases [s]"},
    {"spread", APP_BENCH_NUMBER, offsetof(Row, spread), "spread", "(max − min) / median; not of phases"},
    {"seconds_per_item", APP_BENCH_NUMBER, offsetof(Row, each), "s each", "a pair or a vertex [s]"},
    {"exponent", APP_BENCH_NUMBER, offsetof(Row, exponent), "exponent",
     "p of the power law time ~ sizeᵖ that fits all sizes of this name best; of processor time, for phases "
     "of wall time"},
    {"newton_iterations", APP_BENCH_COUNT, offsetof(Row, newton), "Newton", "of the run"},
    {"set_ups", APP_BENCH_COUNT, offsetof(Row, set_ups), "set-ups", "factors or hierarchies made in the run"},
    {"iterations_per_solve", APP_BENCH_NUMBER, offsetof(Row, iterations), "its",
     "iterations of an iterative linear solver, the mean of a solve"},
    {"peak_bytes", APP_BENCH_COUNT, offsetof(Row, peak), "peak B",
     "largest resident set of the process so far, so sizes should ascend"},
    {"done", APP_BENCH_INTEGER, offsetof(Row, done), NULL, "steps of the run; calls of a round"},
};
static const AppBenchReport report = {"scaling", columns, sizeof columns / sizeof *columns, sizeof(Row),
                                      false};

double lab_scaling_exponent(const double *sizes, const double *seconds, int count) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (int i = 0; i < count; i++) {
    if (!(sizes[i] > 0 && seconds[i] > 0)) continue;
    double a = log(sizes[i]), b = log(seconds[i]);
    n++, x += a, y += b, xx += a * a, xy += a * b;
  }
  double spread = n * xx - x * x;
  return n >= 2 && spread > 0 ? (n * xy - x * y) / spread : NAN;
}

typedef struct Table {
  Row rows[MAX_ROWS];
  int count;
} Table;

static void fit(Table *table) {
  for (int r = 0; r < table->count; r++) {
    double sizes[MAX_ROWS], seconds[MAX_ROWS];
    int count = 0;
    for (int other = 0; other < table->count; other++) {
      const Row *row = &table->rows[other];
      if (strcmp(row->subject, table->rows[r].subject) != 0 || strcmp(row->of, table->rows[r].of) != 0)
        continue;
      sizes[count] = (double)row->size, seconds[count++] = isnan(row->cpu) ? row->seconds : row->cpu;
    }
    table->rows[r].exponent = lab_scaling_exponent(sizes, seconds, count);
  }
}

static bool is_affordable(const Options *options, const char *what, int size, double bytes, double seconds) {
  if (bytes <= options->memory * GIB && seconds <= options->seconds) return true;
  log_warning("left out: %s with %d: about %.2g GiB and %.2g s a call; --memory and --seconds allow more",
              what, size, bytes / GIB, seconds);
  return false;
}

// A model over all sizes; rounds go over the sizes in turns.
static Status measure_model(const Options *options, const OverlapModel *model, double *pairs, double *volume,
                            double *gradient, Table *table) {
  AppBenchContestant *contestants = memory_zeroed((size_t)options->pair_sizes, sizeof *contestants);
  if (!contestants) return status_no_memory("the contestants");
  int count = 0, rounds = options->common.repeats;
  for (int s = 0; s < options->pair_sizes; s++) {
    if (!is_affordable(options, model->ops->name, options->pairs[s], 0,
                       options->pairs[s] * model->ops->seconds_per_pair))
      continue;
    contestants[count++] = (AppBenchContestant){
        .model = model,
        .threads = options->common.threads,
        .batch = {.pair_count = options->pairs[s], .pairs = pairs, .volume = volume, .gradient = gradient}};
  }
  Status status = app_bench_timer_take_turns(contestants, sizeof *contestants, count, rounds, true,
                                             app_bench_contestant_take_turn);
  for (int c = 0; c < count && !status; c++) {
    AppBenchTime time = app_bench_timer_time(&contestants[c].timer, rounds);
    double size = contestants[c].batch.pair_count;
    table->rows[table->count++] = (Row){.subject = "overlap",
                                        .of = model->ops->name,
                                        .size = contestants[c].batch.pair_count,
                                        .done = contestants[c].calls,
                                        .seconds = time.wall * size,
                                        .cpu = time.cpu * size,
                                        .spread = (time.wall_max - time.wall_min) / time.wall,
                                        .each = time.wall,
                                        .newton = NAN,
                                        .set_ups = NAN,
                                        .iterations = NAN,
                                        .peak = NAN};
  }
  memory_free(contestants);
  return status;
}

static Status measure_models(const Options *options, int most, double *arrays[3], Table *table) {
  int count;
  const OverlapOps *const *models = overlap_model_list(&count);
  TRY(app_bench_pairs_fill("near", most, SEED, arrays[0]));
  for (int m = 0; m < count && m < APP_BENCH_MAX_MODELS; m++) {
    if (!options->wants_model[m]) continue;
    OverlapModel model;
    Status status = overlap_model_create(&model, models[m]->name);
    if (status == STATUS_IO) {
      log_warning("left out: %s", status_message());
      continue;
    }
    TRY(status);
    status = measure_model(options, &model, arrays[0], arrays[1], arrays[2], table);
    overlap_model_destroy(&model);
    TRY(status);
  }
  return STATUS_OK;
}

static Status measure_pairs(Options *options, Table *table) {
  const double bytes = (2 * OVERLAP_PAIR_SIZE + 1) * sizeof(double);
  int most = 0, kept = 0;
  for (int s = 0; s < options->pair_sizes; s++) {
    if (!is_affordable(options, "pairs", options->pairs[s], bytes * options->pairs[s], 0)) continue;
    options->pairs[kept++] = options->pairs[s];
    if (options->pairs[s] > most) most = options->pairs[s];
  }
  options->pair_sizes = kept;
  if (kept == 0) return STATUS_OK;
  double *arrays[3] = {memory_zeroed((size_t)most * OVERLAP_PAIR_SIZE, sizeof(double)),
                       memory_zeroed((size_t)most, sizeof(double)),
                       memory_zeroed((size_t)most * OVERLAP_PAIR_SIZE, sizeof(double))};
  bool fits = arrays[0] && arrays[1] && arrays[2];
  Status status =
      fits ? measure_models(options, most, arrays, table) : status_no_memory("the pairs (--pairs)");
  for (int a = 0; a < 3; a++) memory_free(arrays[a]);
  return status;
}

static long long set_ups_of(const FemRunResult *result) {
  return result->solver.hierarchies > 0 ? result->solver.hierarchies : result->solver.factorisations;
}

// Phases by name beside the whole: what is none in this scene is left out.
static void add_phases(const LabTrial *trial, int rounds, Table *table) {
  double seconds[LAB_TRIAL_PHASE_COUNT];
  const FemRunResult *result = &trial->result;
  AppBenchTime time = app_bench_timer_time(&trial->timer, rounds);
  FemRunPhases phases = lab_trial_phases(trial, rounds);
  double steps = fmax((double)result->integrator.steps, 1), size = trial->model.vertex_count;
  Row row = {
      .subject = "step", .of = "total", .size = trial->model.vertex_count, .done = result->integrator.steps};
  row.seconds = time.wall / steps, row.cpu = time.cpu / steps, row.each = row.seconds / size;
  row.spread = (time.wall_max - time.wall_min) / time.wall;
  row.newton = (double)result->integrator.newton_iterations;
  row.set_ups = (double)set_ups_of(result);
  row.iterations =
      result->solver.solves ? (double)result->solver.iterations / (double)result->solver.solves : NAN;
  row.peak = (double)result->peak_rss_bytes;
  table->rows[table->count++] = row;
  double share = fmax(row.newton, 1) / steps; // Newton's iterations a step
  row.newton = row.set_ups = row.iterations = row.peak = NAN;
  row.of = "Newton", row.seconds /= share, row.cpu /= share, row.each /= share;
  table->rows[table->count++] = row;
  lab_trial_split(&phases, seconds);
  for (int p = 0; p < LAB_TRIAL_PHASE_COUNT; p++) {
    bool is_factor = strcmp(lab_trial_phase_names[p], "factorisation") == 0;
    double parts = is_factor ? (double)set_ups_of(result) : steps;
    if (!(seconds[p] > 0 && parts > 0)) continue;
    row.of = lab_trial_phase_names[p];
    row.seconds = seconds[p] / parts, row.each = row.seconds / size, row.cpu = row.spread = NAN;
    table->rows[table->count++] = row;
  }
}

static Status measure_nodes(const Options *options, LabTrial *trial, int nodes, Table *table) {
  int rounds = options->common.repeats;
  TRY(options->scene->read(nodes, &trial->scene));
  trial->scene.solver = options->solver;
  trial->wall_limit_s = options->seconds;
  TRY(lab_trial_begin(trial, &options->common, options->steps));
  if (!is_affordable(options, "vertices", nodes, fem_run_choice(&trial->model, NULL).bytes, 0))
    return STATUS_OK;
  TRY(app_bench_timer_take_turns(trial, sizeof *trial, 1, rounds, false, lab_trial_run));
  add_phases(trial, rounds, table);
  return STATUS_OK;
}

static Status measure(Options *options, Table *table) {
  omp_set_num_threads(options->common.threads);
  TRY(measure_pairs(options, table));
  for (int s = 0; s < options->node_sizes; s++) {
    LabTrial *trial = memory_zeroed(1, sizeof *trial);
    if (!trial) return status_no_memory("the run");
    Status status = measure_nodes(options, trial, options->nodes[s], table);
    lab_trial_end(trial);
    memory_free(trial);
    TRY(status);
  }
  fit(table);
  return app_bench_report_print(&report, &options->common, table->rows, table->count);
}

static Status run(Options *options) {
  Table *table = memory_zeroed(1, sizeof *table);
  if (!table) return status_no_memory("the rows");
  Status status = measure(options, table);
  memory_free(table);
  return status;
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .doc = "Measure how time grows with the number of pairs and with the number of vertices.",
    .children = app_bench_command_children,
    .help_filter = app_bench_command_help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = app_bench_options_default(3),
                     .pairs = {1000, 10000, 100000, 1000000},
                     .pair_sizes = 4,
                     .nodes = {1000, 3000, 10000},
                     .node_sizes = 3,
                     .steps = 10,
                     .scene = &lab_scene_builtin_large[0],
                     .solver = FEM_SOLVER_AUTO,
                     .memory = 6,
                     .seconds = 60};
  const char *names[APP_BENCH_MAX_MODELS];
  int models = app_bench_models_list(names);
  for (int m = 0; m < models; m++) options.wants_model[m] = text_lists("clip geo-small geo", names[m]);
  app_bench_command_read(&lab_scaling, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_scaling = {.name = "scaling",
                                .help = "how time grows with pairs and with vertices",
                                .argp = &argp,
                                .run = run_command,
                                .has_threads = true,
                                .rows = &report,
                                .describe_rows = app_bench_command_rows};

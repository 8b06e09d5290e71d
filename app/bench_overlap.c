// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench_overlap.h"

#include <limits.h>
#include <omp.h>
#include <stdbool.h>

#include "app/bench_options.h"
#include "app/bench_pairs.h"
#include "app/bench_report.h"
#include "app/bench_timer.h"
#include "base/log.h"
#include "base/memory.h"
#include "contact/overlap.h"

enum { MAX_MODELS = 16, QUANTITY_COUNT = 3 };
static const char *const quantities[QUANTITY_COUNT] = {"V", "V+grad", "V+grad+hess"};

static const double ROUND_S = 0.05,
                    CALL_S = 0.25; // what a round and a call may take, by the model's own guess
static const uint64_t SEED = 1;

typedef struct Options {
  AppBenchOptions common;
  bool wants_model[MAX_MODELS], wants_set[APP_BENCH_SET_COUNT], wants_quantity[QUANTITY_COUNT];
  int batch;
} Options;

static const struct argp_option option_table[] = {
    {"model", 'm', "NAME,…", 0, "Overlap models to measure (default: all)", 1},
    {"set", 's', "NAME,…", 0, "Sets of pairs: near, uniform, disjoint (default: all)", 1},
    {"quantity", 'Q', "NAME,…", 0, "V, V+grad, V+grad+hess (default: all that a model has)", 1},
    {"batch", 'b', "N", 0, "Pairs a call (default: 4096, fewer for slow models)", 1},
    {0},
};

static int list_models(const char *names[MAX_MODELS]) {
  int count;
  const ContactOverlapOps *const *models = contact_overlap_list(&count);
  if (count > MAX_MODELS) count = MAX_MODELS;
  for (int m = 0; m < count; m++) names[m] = models[m]->name;
  return count;
}

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  const char *models[MAX_MODELS];
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->common;
    return 0;
  case 'm':
    app_bench_options_choose(state, "model", text, models, list_models(models), options->wants_model);
    return 0;
  case 's':
    app_bench_options_choose(state, "set", text, app_bench_sets, APP_BENCH_SET_COUNT, options->wants_set);
    return 0;
  case 'Q':
    app_bench_options_choose(state, "quantity", text, quantities, QUANTITY_COUNT, options->wants_quantity);
    return 0;
  case 'b':
    options->batch = app_bench_options_count(state, "batch", text, 10000000);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

// A model on a set, for a quantity.
typedef struct Contestant {
  ContactOverlapModel model; // owned
  const char *set, *quantity;
  ContactOverlapBatch batch; // volume, gradient and hessian are shared by all contestants
  int calls;                 // a round
  AppBenchTimer timer;       // a pair
} Contestant;

typedef struct Bench {
  const Options *options;
  double *pairs[APP_BENCH_SET_COUNT]; // NULL: not wanted
  double *volume, *gradient, *hessian;
  Contestant *contestants;
  int contestant_count;
} Bench;

static int limited(double value, int largest) {
  return value < 1 ? 1 : value < largest ? (int)value : largest;
}

// Sizes the batch and the number of calls by what the model says that a pair costs.
static Status add_contestant(Bench *bench, const ContactOverlapOps *ops, int set, int quantity) {
  Contestant *contestant = &bench->contestants[bench->contestant_count];
  TRY(contact_overlap_create(&contestant->model, ops->name));
  bench->contestant_count++;
  double per_pair = ops->seconds_per_pair * (quantity == 2 ? 4 : 1);
  int batch = limited(CALL_S * bench->options->common.threads / per_pair, bench->options->batch);
  contestant->set = app_bench_sets[set], contestant->quantity = quantities[quantity];
  contestant->calls = limited(ROUND_S * bench->options->common.threads / (per_pair * batch), INT_MAX);
  contestant->batch = (ContactOverlapBatch){.pair_count = batch,
                                            .pairs = bench->pairs[set],
                                            .volume = bench->volume,
                                            .gradient = quantity >= 1 ? bench->gradient : NULL,
                                            .hessian = quantity >= 2 ? bench->hessian : NULL};
  return STATUS_OK;
}

static Status add_contestants(Bench *bench) {
  int model_count;
  const ContactOverlapOps *const *models = contact_overlap_list(&model_count);
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++)
    for (int quantity = 0; quantity < QUANTITY_COUNT; quantity++)
      for (int m = 0; m < model_count && m < MAX_MODELS; m++) {
        const Options *options = bench->options;
        if (!options->wants_set[set] || !options->wants_quantity[quantity] || !options->wants_model[m])
          continue;
        if (quantity == 2 && !models[m]->has_hessian) continue;
        TRY(add_contestant(bench, models[m], set, quantity));
      }
  if (bench->contestant_count == 0)
    return status_fail(STATUS_USAGE, "none of the chosen models has a Hessian: nothing to measure");
  return STATUS_OK;
}

static Status make_inputs(Bench *bench) {
  const Options *options = bench->options;
  size_t batch = (size_t)options->batch, pair = CONTACT_PAIR_SIZE;
  bench->contestants =
      memory_zeroed((size_t)APP_BENCH_SET_COUNT * QUANTITY_COUNT * MAX_MODELS, sizeof *bench->contestants);
  bench->volume = memory_zeroed(batch, sizeof *bench->volume);
  bench->gradient = memory_zeroed(batch * pair, sizeof *bench->gradient);
  bench->hessian =
      memory_zeroed(options->wants_quantity[2] ? batch * pair * pair : 0, sizeof *bench->hessian);
  if (!bench->contestants || !bench->volume || !bench->gradient || !bench->hessian)
    return status_no_memory("the batch (--batch)");
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) {
    if (!options->wants_set[set]) continue;
    if (!(bench->pairs[set] = memory_zeroed(batch * pair, sizeof *bench->pairs[set])))
      return status_no_memory("the batch (--batch)");
    TRY(app_bench_pairs_make(app_bench_sets[set], options->batch, SEED, bench->pairs[set]));
  }
  return STATUS_OK;
}

// Fills no memory that others do not fill too: the contestants share what a batch returns.
static Status take_turn(void *self, int round) {
  Contestant *contestant = self;
  app_bench_timer_start(&contestant->timer);
  for (int call = 0; call < contestant->calls; call++)
    TRY(contact_overlap_eval(&contestant->model, &contestant->batch));
  app_bench_timer_stop(&contestant->timer, round, (double)contestant->calls * contestant->batch.pair_count);
  return STATUS_OK;
}

typedef struct Row {
  const char *model, *set, *quantity;
  long long batch;
  double rate, cpu_rate, rate_min, rate_max; // pairs a second
  double spread;
} Row;

static const AppBenchColumn columns[] = {
    {"model", APP_BENCH_TEXT, offsetof(Row, model), "model", "overlap model"},
    {"set", APP_BENCH_TEXT, offsetof(Row, set), "set", "set of pairs: near, uniform, disjoint"},
    {"quantity", APP_BENCH_TEXT, offsetof(Row, quantity), "quantity", "V, V+grad or V+grad+hess"},
    {"batch", APP_BENCH_INTEGER, offsetof(Row, batch), "batch", "pairs a call"},
    {"pairs_per_second", APP_BENCH_NUMBER, offsetof(Row, rate), "pairs/s", "of wall time"},
    {"pairs_per_cpu_second", APP_BENCH_NUMBER, offsetof(Row, cpu_rate), "pairs/cpu s", "of processor time"},
    {"pairs_per_second_min", APP_BENCH_NUMBER, offsetof(Row, rate_min), NULL, "slowest round"},
    {"pairs_per_second_max", APP_BENCH_NUMBER, offsetof(Row, rate_max), NULL, "fastest round"},
    {"spread", APP_BENCH_NUMBER, offsetof(Row, spread), "spread", "(max − min) / median"},
};
static const AppBenchReport report = {"overlap", columns, sizeof columns / sizeof *columns, sizeof(Row)};

static Row row_of(const Contestant *contestant, int rounds) {
  AppBenchTime time = app_bench_timer_time(&contestant->timer, rounds);
  return (Row){.model = contestant->model.ops->name,
               .set = contestant->set,
               .quantity = contestant->quantity,
               .batch = contestant->batch.pair_count,
               .rate = 1 / time.wall,
               .cpu_rate = 1 / time.cpu,
               .rate_min = 1 / time.wall_max,
               .rate_max = 1 / time.wall_min,
               .spread = time.wall / time.wall_min - time.wall / time.wall_max};
}

static Status print(const Bench *bench) {
  Row *rows = memory_zeroed((size_t)bench->contestant_count, sizeof *rows);
  if (!rows) return status_no_memory("the rows");
  const AppBenchOptions *common = &bench->options->common;
  for (int c = 0; c < bench->contestant_count; c++) rows[c] = row_of(&bench->contestants[c], common->repeats);
  Status status = app_bench_report_print(&report, common, rows, bench->contestant_count);
  memory_free(rows);
  return status;
}

static void destroy(Bench *bench) {
  for (int c = 0; c < bench->contestant_count; c++) contact_overlap_destroy(&bench->contestants[c].model);
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) memory_free(bench->pairs[set]);
  memory_free(bench->contestants), memory_free(bench->volume);
  memory_free(bench->gradient), memory_free(bench->hessian);
}

static Status run(const Options *options) {
  Bench bench = {.options = options};
  omp_set_num_threads(options->common.threads);
  Status status = make_inputs(&bench);
  if (status == STATUS_OK) status = add_contestants(&bench);
  if (status == STATUS_OK)
    status = app_bench_timer_take_turns(bench.contestants, sizeof *bench.contestants, bench.contestant_count,
                                        options->common.repeats, true, take_turn);
  if (status == STATUS_OK) status = print(&bench);
  destroy(&bench);
  return status;
}

static char *help(int key, const char *text, void *input) {
  (void)input;
  return app_bench_report_help(&report, key, text);
}

int app_bench_overlap_run(int argument_count, char **arguments) {
  static const struct argp_child children[] = {{.argp = &app_bench_options_argp}, {0}};
  static const struct argp argp = {
      .options = option_table,
      .parser = parse,
      .doc = "Measure how many pairs of tetrahedra a second the overlap models answer.",
      .children = children,
      .help_filter = help};
  Options options = {.common = {.threads = 1, .repeats = 9}, .batch = 4096};
  for (int i = 0; i < MAX_MODELS; i++) options.wants_model[i] = true;
  for (int i = 0; i < APP_BENCH_SET_COUNT; i++) options.wants_set[i] = true;
  for (int i = 0; i < QUANTITY_COUNT; i++) options.wants_quantity[i] = true;
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  Status status = run(&options);
  if (status != STATUS_OK) log_error("%s", status_message());
  return status_exit_code(status);
}

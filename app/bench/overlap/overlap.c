// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/bench.h"

#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdbool.h>

#include "app/bench/overlap/errors.h"
#include "app/bench/overlap/pairs.h"
#include "app/bench/report.h"
#include "app/bench/timer.h"
#include "app/cli/model_names.h"
#include "app/cli/parse.h"
#include "app/evaluation/card.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "overlap/models.h"

typedef enum Quantity { VOLUME, CENTROID, GRADIENT, HESSIAN, QUANTITY_COUNT } Quantity;
static const char *const quantities[QUANTITY_COUNT] = {"V", "V+centroid", "V+grad", "V+grad+hess"};

enum { MAX_MODELS = 64, MOST_ERRORS = 20000 }; // pairs that errors are taken over
static const uint64_t SEED = 1;

typedef struct Options {
  AppBenchOptions common;
  const char *models[MAX_MODELS]; // as overlap/source.h names them (model_count)
  int model_count;
  bool are_chosen; // by --model
  bool wants_set[APP_BENCH_SET_COUNT], wants_quantity[QUANTITY_COUNT];
  AppBenchList batches;
} Options;

static const AppOption option_table[] = {
    {"model", 'm', "NAME,...", "Overlap models, or files of yours, to measure (default: all models)", 1,
     CLI_LIST, CLI_TO(Options, models), .most = MAX_MODELS, .example = "clip,geo",
     .count_offset = offsetof(Options, model_count), .mark_offset = offsetof(Options, are_chosen)},
    {"set", 's', "NAME,...", "Sets of pairs: near, uniform, disjoint (default: all)", 1, CLI_CHOICES,
     CLI_TO(Options, wants_set), .most = APP_BENCH_SET_COUNT, .choices = app_bench_sets},
    {"quantity", 'Q', "NAME,...", "V, V+centroid, V+grad, V+grad+hess (default: all that a model has)", 1,
     CLI_CHOICES, CLI_TO(Options, wants_quantity), .most = QUANTITY_COUNT, .choices = quantities},
    {"batch", 'b', "N,...", "Pairs a call (default: 4096); slow models get fewer", 1, CLI_OWN,
     CLI_TO(Options, batches), .read = app_bench_options_read_batches},
    {.table = app_bench_options, .offset = offsetof(Options, common)},
    {0},
};

static int list_models(const char *names[MAX_MODELS]) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  for (int m = 0; m < count; m++) names[m] = models[m]->name;
  return count;
}

// A model that evaluates a batch of pairs repeatedly.
typedef struct Contestant {
  const OverlapModel *model; // borrowed
  OverlapBatch batch;        // its arrays are the bench's; contestants may share what is written
  int threads;
  int calls;           // a round; 0: not known before the first turn, the warm-up
  AppBenchTimer timer; // of a pair
} Contestant;

static const double ROUND_S = 0.05, CALL_S = 0.25; // what a round and a call shall take

static int limited(double value, int largest) {
  return value < 1 ? 1 : value < largest ? (int)value : largest;
}

// The largest batch, `wanted` at most, whose single call does not take long by the model's own guess;
// Hessians cost four times as much.
static int batch_of(const OverlapModel *model, bool has_hessian, int threads, int wanted) {
  double per_pair = model->ops->seconds_per_pair * (has_hessian ? 4 : 1);
  // a model that needs less than a microsecond is never cut: its guess is not that good
  return per_pair < 1e-6 ? wanted : limited(CALL_S * threads / per_pair, wanted);
}

static Status find_calls(Contestant *contestant) {
  double began = clock_wall_s();
  TRY(overlap_model_eval(contestant->model, &contestant->batch)); // wakes threads, loads caches
  double first = clock_wall_s();
  if (first - began > ROUND_S) {
    contestant->calls = 1;
    return STATUS_OK;
  }
  TRY(overlap_model_eval(contestant->model, &contestant->batch));
  contestant->calls = limited(ROUND_S / (clock_wall_s() - first + 1e-9), INT_MAX);
  return STATUS_OK;
}

// Evaluates the batch as often as fills a round and times a pair. The first turn finds how often that is.
static Status take_turn(void *self, int round) {
  Contestant *contestant = self;
  omp_set_num_threads(contestant->threads);
  if (contestant->calls == 0) TRY(find_calls(contestant));
  app_bench_timer_start(&contestant->timer);
  for (int call = 0; call < contestant->calls; call++)
    TRY(overlap_model_eval(contestant->model, &contestant->batch));
  app_bench_timer_stop(&contestant->timer, round, (double)contestant->calls * contestant->batch.pair_count);
  return STATUS_OK;
}

// What distinguishes contestants.
typedef struct Case {
  int model, set, quantity, batch, threads; // threads: their number
} Case;

typedef struct Bench {
  const Options *options;
  int model_count;
  AppModelName names[MAX_MODELS];
  OverlapModel models[MAX_MODELS]; // owned; ops NULL: not to be had
  AppModelCard cards[MAX_MODELS];
  double *pairs[APP_BENCH_SET_COUNT]; // (largest batch, 24), owned; NULL: not wanted
  AppBenchTruth truths[APP_BENCH_SET_COUNT];
  double *volume, *centroid, *gradient, *hessian;
  Contestant *contestants;
  Case *cases; // of the contestants
  int count, capacity;
} Bench;

// Where all models are measured, those whose weights are not there are left out, by name.
static Status open_models(Bench *bench) {
  const Options *options = bench->options;
  bench->model_count = options->model_count;
  TRY(app_model_names_find(options->model_count, options->models, bench->names));
  for (int m = 0; m < options->model_count; m++) {
    const char *source = options->models[m];
    Status status = app_bench_options_open(source, &bench->models[m]);
    if (status == STATUS_IO && !options->are_chosen) {
      log_warning("left out: %s", status_message());
      continue;
    }
    TRY(status);
    TRY(app_evaluation_card_read(&bench->models[m], source, &bench->cards[m]));
  }
  return STATUS_OK;
}

static void add(Bench *bench, const Case *what) {
  const OverlapModel *model = &bench->models[what->model];
  int batch = bench->options->batches.numbers[what->batch];
  bool has_hessian = what->quantity == HESSIAN, has_gradient = has_hessian || what->quantity == GRADIENT;
  bench->cases[bench->count] = *what;
  bench->contestants[bench->count++] =
      (Contestant){.model = model,
                   .threads = what->threads,
                   .batch = {.pair_count = batch_of(model, has_hessian, what->threads, batch),
                             .pairs = bench->pairs[what->set],
                             .volume = bench->volume,
                             .gradient = has_gradient ? bench->gradient : NULL,
                             .hessian = has_hessian ? bench->hessian : NULL,
                             .centroid = what->quantity == CENTROID ? bench->centroid : NULL}};
}

static bool gives(const OverlapModel *model, int quantity) {
  switch (quantity) {
  case CENTROID:
    return overlap_model_has_own_centroid(model) || overlap_model_has_gradient(model);
  case GRADIENT:
    return overlap_model_has_gradient(model);
  case HESSIAN:
    return overlap_model_has_hessian(model);
  default:
    return true;
  }
}

static void add_models(Bench *bench, Case what) {
  for (what.model = 0; what.model < bench->model_count; what.model++) {
    const OverlapModel *model = &bench->models[what.model];
    if (model->ops && gives(model, what.quantity)) add(bench, &what);
  }
}

static Status add_contestants(Bench *bench) {
  const Options *options = bench->options;
  Case what;
  for (what.set = 0; what.set < APP_BENCH_SET_COUNT; what.set++)
    for (what.quantity = 0; what.quantity < QUANTITY_COUNT; what.quantity++) {
      if (!options->wants_set[what.set] || !options->wants_quantity[what.quantity]) continue;
      for (what.batch = 0; what.batch < options->batches.count; what.batch++)
        for (int t = 0; t < options->common.thread_list.count; t++) {
          what.threads = options->common.thread_list.numbers[t];
          add_models(bench, what);
        }
    }
  if (bench->count == 0)
    return status_fail(STATUS_USAGE,
                       "none of the chosen models gives what was chosen (--quantity): nothing to measure");
  return STATUS_OK;
}

static Status make_inputs(Bench *bench) {
  const Options *options = bench->options;
  int most = app_bench_list_largest(&options->batches);
  size_t batch = (size_t)most, pair = OVERLAP_PAIR_SIZE;
  bench->capacity = APP_BENCH_SET_COUNT * QUANTITY_COUNT * MAX_MODELS * options->batches.count *
                    options->common.thread_list.count;
  bench->contestants = memory_zeroed((size_t)bench->capacity, sizeof *bench->contestants);
  bench->cases = memory_zeroed((size_t)bench->capacity, sizeof *bench->cases);
  bench->volume = memory_zeroed(batch, sizeof *bench->volume);
  bench->centroid = memory_zeroed(3 * batch, sizeof *bench->centroid);
  bench->gradient = memory_zeroed(batch * pair, sizeof *bench->gradient);
  bench->hessian =
      memory_zeroed(options->wants_quantity[HESSIAN] ? batch * pair * pair : 0, sizeof *bench->hessian);
  if (!bench->contestants || !bench->cases || !bench->volume || !bench->centroid || !bench->gradient ||
      !bench->hessian)
    return status_no_memory("the batch (--batch)");
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) {
    if (!options->wants_set[set]) continue;
    if (!(bench->pairs[set] = memory_zeroed(batch * pair, sizeof *bench->pairs[set])))
      return status_no_memory("the batch (--batch)");
    TRY(app_bench_pairs_fill(app_bench_sets[set], most, SEED, bench->pairs[set]));
    TRY(app_bench_truth_create(&bench->truths[set], most < MOST_ERRORS ? most : MOST_ERRORS,
                               bench->pairs[set]));
  }
  return STATUS_OK;
}

typedef struct Row {
  const char *model, *family, *set, *quantity, *reference;
  long long batch, threads, parameters, frontier;
  double rate, cpu_rate, rate_min, rate_max; // pairs a second
  double spread;
  double ratio, ratio_min, ratio_max, cpu_ratio; // speed over the reference's
  double thread_gain;                            // speed over that on the first number of threads
  AppBenchErrors errors;
} Row;

static const AppTableColumn columns[] = {
    {"model", APP_TABLE_TEXT, offsetof(Row, model), "model", "overlap model"},
    {"set", APP_TABLE_TEXT, offsetof(Row, set), "set", "set of pairs: near, uniform, disjoint"},
    {"quantity", APP_TABLE_TEXT, offsetof(Row, quantity), "quantity", "V, V+centroid, V+grad or V+grad+hess"},
    {"batch", APP_TABLE_INTEGER, offsetof(Row, batch), "batch", "pairs a call"},
    {"threads", APP_TABLE_INTEGER, offsetof(Row, threads), "threads", "threads"},
    {"pairs_per_second", APP_TABLE_NUMBER, offsetof(Row, rate), "pairs/s", "of wall time"},
    {"pairs_per_cpu_second", APP_TABLE_NUMBER, offsetof(Row, cpu_rate), "pairs/cpu s", "of processor time"},
    {"pairs_per_second_min", APP_TABLE_NUMBER, offsetof(Row, rate_min), NULL, "slowest round"},
    {"pairs_per_second_max", APP_TABLE_NUMBER, offsetof(Row, rate_max), NULL, "fastest round"},
    {"spread", APP_TABLE_NUMBER, offsetof(Row, spread), "spread", "(max − min) / median"},
    {"ratio", APP_TABLE_NUMBER, offsetof(Row, ratio), "ratio",
     "speed over that of `reference` in the same round, median of the rounds"},
    {"ratio_min", APP_TABLE_NUMBER, offsetof(Row, ratio_min), NULL, "smallest of the rounds"},
    {"ratio_max", APP_TABLE_NUMBER, offsetof(Row, ratio_max), NULL, "largest of the rounds"},
    {"cpu_ratio", APP_TABLE_NUMBER, offsetof(Row, cpu_ratio), NULL,
     "the same of processor times, median of the rounds"},
    {"reference", APP_TABLE_TEXT, offsetof(Row, reference), NULL,
     "the first model, same set, quantity, threads"},
    {"thread_gain", APP_TABLE_NUMBER, offsetof(Row, thread_gain), "× threads",
     "speed over that of the same row on the first number of threads, median of the rounds"},
    {"error", APP_TABLE_NUMBER, offsetof(Row, errors.error), "error",
     "against the exact model, of V: Σ|ΔV|/ΣV; of V+grad: Σ‖Δ∇V‖/Σ‖∇V‖"},
    {"error_median", APP_TABLE_NUMBER, offsetof(Row, errors.median), NULL, "of the pairs' relative errors"},
    {"error_p90", APP_TABLE_NUMBER, offsetof(Row, errors.p90), NULL, "90th percentile of the same"},
    {"samples", APP_TABLE_INTEGER, offsetof(Row, errors.samples), NULL, "pairs that errors are taken over"},
    {"fallback_share", APP_TABLE_NUMBER, offsetof(Row, errors.fallbacks), NULL,
     "of these pairs, answered by a more careful model"},
    {"frontier", APP_TABLE_INTEGER, offsetof(Row, frontier), "frontier",
     "1: no other row of this set, quantity and number of threads is as fast and as accurate, and better in "
     "one of both; by processor time"},
    {"family", APP_TABLE_TEXT, offsetof(Row, family), NULL, "geo, tpn, or the model's own name"},
    {"parameters", APP_TABLE_INTEGER, offsetof(Row, parameters), NULL, "of the network, 0: none"},
};
static const AppBenchReport report = {"overlap", columns, sizeof columns / sizeof *columns, sizeof(Row),
                                      .has_own_threads = true};

// The contestant that differs in the one thing: −1 if there is none.
static int find(const Bench *bench, Case what) {
  for (int c = 0; c < bench->count; c++) {
    const Case *other = &bench->cases[c];
    if (other->model == what.model && other->set == what.set && other->quantity == what.quantity &&
        other->batch == what.batch && other->threads == what.threads)
      return c;
  }
  return -1;
}

static int find_reference(const Bench *bench, Case what) {
  int found = -1;
  for (what.model = 0; what.model < bench->model_count && found < 0; what.model++) found = find(bench, what);
  return found;
}

static bool has_error(int quantity) {
  return quantity == VOLUME || quantity == GRADIENT;
}

static Status measure_errors(const Bench *bench, int c, AppBenchErrors *errors) {
  const Contestant *contestant = &bench->contestants[c];
  const Case *what = &bench->cases[c];
  const AppBenchTruth *truth = &bench->truths[what->set];
  int count = contestant->batch.pair_count < truth->count ? contestant->batch.pair_count : truth->count;
  *errors = (AppBenchErrors){NAN, NAN, NAN, NAN, 0};
  if (!has_error(what->quantity)) return STATUS_OK;
  return app_bench_errors_measure(truth, contestant->model, count, what->quantity == GRADIENT, errors);
}

static Row row_of(const Bench *bench, int c) {
  const Contestant *contestant = &bench->contestants[c];
  const Case *what = &bench->cases[c];
  int rounds = bench->options->common.repeats;
  Case single = *what;
  single.threads = bench->options->common.thread_list.numbers[0];
  const int first = find_reference(bench, *what);
  const Contestant *reference = &bench->contestants[first],
                   *narrow = &bench->contestants[find(bench, single)];
  AppBenchTime time = app_bench_timer_time(&contestant->timer, rounds);
  AppBenchRatio ratio = app_bench_timer_ratio(&contestant->timer, &reference->timer, rounds);
  double cpu_ratio = app_bench_timer_cpu_ratio(&contestant->timer, &reference->timer, rounds).median;
  const AppModelCard *card = &bench->cards[what->model];
  return (Row){.model = bench->names[what->model],
               .family = card->family,
               .parameters = card->parameters,
               .set = app_bench_sets[what->set],
               .quantity = quantities[what->quantity],
               .reference = bench->names[bench->cases[first].model],
               .batch = contestant->batch.pair_count,
               .threads = what->threads,
               .rate = 1 / time.wall,
               .cpu_rate = 1 / time.cpu,
               .rate_min = 1 / time.wall_max,
               .rate_max = 1 / time.wall_min,
               .spread = time.wall / time.wall_min - time.wall / time.wall_max,
               .ratio = ratio.median,
               .ratio_min = ratio.min,
               .ratio_max = ratio.max,
               .cpu_ratio = cpu_ratio,
               .thread_gain = app_bench_timer_ratio(&contestant->timer, &narrow->timer, rounds).median};
}

static bool beats(const Row *a, const Row *b) {
  bool is_peer = a->set == b->set && a->quantity == b->quantity && a->threads == b->threads;
  return is_peer && a->cpu_rate >= b->cpu_rate && a->errors.error <= b->errors.error &&
         (a->cpu_rate > b->cpu_rate || a->errors.error < b->errors.error);
}

static void mark_frontier(Row *rows, int count) {
  for (int r = 0; r < count; r++) {
    rows[r].frontier = isfinite(rows[r].errors.error);
    for (int other = 0; other < count; other++)
      if (beats(&rows[other], &rows[r])) rows[r].frontier = 0;
  }
}

static Status fill_rows(const Bench *bench, Row *rows) {
  for (int c = 0; c < bench->count; c++) {
    rows[c] = row_of(bench, c);
    TRY(measure_errors(bench, c, &rows[c].errors));
  }
  mark_frontier(rows, bench->count);
  return STATUS_OK;
}

static Status print(const Bench *bench) {
  Row *rows = memory_zeroed((size_t)bench->count, sizeof *rows);
  if (!rows) return status_no_memory("the rows");
  Status status = fill_rows(bench, rows);
  if (!status) status = app_bench_report_print(&report, &bench->options->common, rows, bench->count);
  memory_free(rows);
  return status;
}

static void destroy(Bench *bench) {
  for (int m = 0; m < bench->model_count; m++) overlap_model_destroy(&bench->models[m]);
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) {
    memory_free(bench->pairs[set]);
    app_bench_truth_destroy(&bench->truths[set]);
  }
  memory_free(bench->contestants), memory_free(bench->cases), memory_free(bench->volume);
  memory_free(bench->centroid);
  memory_free(bench->gradient), memory_free(bench->hessian);
  memory_free(bench);
}

static Status measure(Bench *bench) {
  const AppBenchOptions *common = &bench->options->common;
  // what models keep for every thread is made for the largest number of them
  omp_set_num_threads(app_bench_list_largest(&common->thread_list));
  TRY(open_models(bench));
  TRY(make_inputs(bench));
  TRY(add_contestants(bench));
  TRY(app_bench_timer_take_turns(bench->contestants, sizeof *bench->contestants, bench->count,
                                 common->repeats, take_turn));
  return print(bench);
}

static Status run(const Options *options) {
  Bench *bench = memory_zeroed(1, sizeof *bench);
  if (!bench) return status_no_memory("the bench");
  bench->options = options;
  Status status = measure(bench);
  destroy(bench);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = app_bench_options_default(), .batches = {{4096}, 1}};
  options.common.takes_thread_list = true;
  options.model_count = list_models(options.models);
  for (int i = 0; i < APP_BENCH_SET_COUNT; i++) options.wants_set[i] = true;
  for (int i = 0; i < QUANTITY_COUNT; i++) options.wants_quantity[i] = true;
  app_cli_parse(&app_bench_overlap, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand app_bench_overlap = {
    .name = "overlap",
    .help = "overlap models: pairs of tetrahedra a second",
    .options = option_table,
    .doc = "Measure how many pairs of tetrahedra a second the overlap models answer, and how accurately.",
    .run = run_command,
    .has_threads = true,
    .rows = &report,
    .describe_rows = app_bench_report_describe};

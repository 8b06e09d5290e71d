// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench.h"

#include <argp.h>
#include <limits.h>
#include <omp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/bench_pairs.h"
#include "base/clock.h"
#include "base/cpu.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/record.h"
#include "base/status.h"
#include "contact/overlap.h"

enum { MAX_REPEATS = 1000, MAX_MODELS = 16, QUANTITY_COUNT = 3 };
static const char *const quantities[QUANTITY_COUNT] = {"V", "V+grad", "V+grad+hess"};

static const double ROUND_S = 0.05,
                    CALL_S = 0.25; // what a round and a call may take, by the model's own guess
static const uint64_t SEED = 1;

typedef enum Format { FORMAT_TABLE, FORMAT_JSON, FORMAT_CSV } Format;

typedef struct Options {
  bool wants_model[MAX_MODELS], wants_set[APP_BENCH_SET_COUNT], wants_quantity[QUANTITY_COUNT];
  int threads, batch, repeats;
  Format format;
  bool has_subject;
} Options;

static const struct argp_option option_table[] = {
    {"model", 'm', "NAME,…", 0, "Overlap models to measure (default: all)", 0},
    {"set", 's', "NAME,…", 0, "Sets of pairs: near, uniform, disjoint (default: all)", 0},
    {"quantity", 'Q', "NAME,…", 0, "V, V+grad, V+grad+hess (default: all that a model has)", 0},
    {"threads", 't', "N", 0, "Threads (default: 1)", 0},
    {"batch", 'b', "N", 0, "Pairs a call (default: 4096, fewer for slow models)", 0},
    {"repeat", 'r', "N", 0, "Rounds; the median is reported (default: 9)", 0},
    {"json", 'j', NULL, 0, "Print one JSON object a row", 0},
    {"csv", 'c', NULL, 0, "Print comma-separated values", 0},
    {0},
};

// Marks each name of a comma-separated list in `wanted`, or ends with what the names are.
static void choose(struct argp_state *state, const char *option, const char *text, const char *const *names,
                   int count, bool *wanted) {
  char known[256] = "";
  for (int i = 0; i < count; i++) {
    size_t used = strlen(known);
    snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", names[i]);
    wanted[i] = false;
  }
  while (true) {
    size_t length = strcspn(text, ",");
    int found = 0;
    while (found < count && !(strlen(names[found]) == length && strncmp(names[found], text, length) == 0))
      found++;
    if (found == count) {
      argp_error(state, "--%s has '%.*s'; give some of: %s", option, (int)length, text, known);
      return;
    }
    wanted[found] = true;
    if (!text[length]) return;
    text += length + 1;
  }
}

static int count_of(struct argp_state *state, const char *option, const char *text, int largest) {
  char *end;
  long value = strtol(text, &end, 10);
  if (end == text || *end || value < 1 || value > largest)
    argp_error(state, "--%s is '%s'; give a number from 1 to %d", option, text, largest);
  return (int)value;
}

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
  case 'm':
    choose(state, "model", text, models, list_models(models), options->wants_model);
    return 0;
  case 's':
    choose(state, "set", text, app_bench_sets, APP_BENCH_SET_COUNT, options->wants_set);
    return 0;
  case 'Q':
    choose(state, "quantity", text, quantities, QUANTITY_COUNT, options->wants_quantity);
    return 0;
  case 't':
    options->threads = count_of(state, "threads", text, 4096);
    return 0;
  case 'b':
    options->batch = count_of(state, "batch", text, 10000000);
    return 0;
  case 'r':
    options->repeats = count_of(state, "repeat", text, MAX_REPEATS);
    return 0;
  case 'j':
    options->format = FORMAT_JSON;
    return 0;
  case 'c':
    options->format = FORMAT_CSV;
    return 0;
  case ARGP_KEY_ARG:
    if (options->has_subject || strcmp(text, "overlap") != 0)
      argp_error(state, "cannot measure '%s'; there is: overlap", text);
    options->has_subject = true;
    return 0;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "measure what? There is: overlap");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

// One line of the result and what it takes to measure it.
typedef struct Row {
  ContactOverlapModel model; // owned
  const char *set, *quantity;
  ContactOverlapBatch batch; // volume, gradient and hessian are shared by all rows
  int calls;                 // a round
  double wall[MAX_REPEATS];  // seconds a pair, by round
  double cpu[MAX_REPEATS];
} Row;

typedef struct Bench {
  const Options *options;
  double *pairs[APP_BENCH_SET_COUNT]; // NULL: not wanted
  double *volume, *gradient, *hessian;
  Row *rows;
  int row_count;
} Bench;

static int limited(double value, int largest) {
  return value < 1 ? 1 : value < largest ? (int)value : largest;
}

// Sizes the batch and the number of calls by what the model says that a pair costs.
static Status add_row(Bench *bench, const ContactOverlapOps *ops, int set, int quantity) {
  Row *row = &bench->rows[bench->row_count];
  TRY(contact_overlap_create(&row->model, ops->name));
  bench->row_count++;
  double per_pair = ops->seconds_per_pair * (quantity == 2 ? 4 : 1);
  int batch = limited(CALL_S * bench->options->threads / per_pair, bench->options->batch);
  row->set = app_bench_sets[set], row->quantity = quantities[quantity];
  row->calls = limited(ROUND_S * bench->options->threads / (per_pair * batch), INT_MAX);
  row->batch = (ContactOverlapBatch){.pair_count = batch,
                                     .pairs = bench->pairs[set],
                                     .volume = bench->volume,
                                     .gradient = quantity >= 1 ? bench->gradient : NULL,
                                     .hessian = quantity >= 2 ? bench->hessian : NULL};
  return STATUS_OK;
}

static Status add_rows(Bench *bench) {
  int model_count;
  const ContactOverlapOps *const *models = contact_overlap_list(&model_count);
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++)
    for (int quantity = 0; quantity < QUANTITY_COUNT; quantity++)
      for (int m = 0; m < model_count && m < MAX_MODELS; m++) {
        const Options *options = bench->options;
        if (!options->wants_set[set] || !options->wants_quantity[quantity] || !options->wants_model[m])
          continue;
        if (quantity == 2 && !models[m]->has_hessian) continue;
        TRY(add_row(bench, models[m], set, quantity));
      }
  if (bench->row_count == 0)
    return status_fail(STATUS_USAGE, "none of the chosen models has a Hessian: nothing to measure");
  return STATUS_OK;
}

static Status make_inputs(Bench *bench) {
  const Options *options = bench->options;
  size_t batch = (size_t)options->batch, pair = CONTACT_PAIR_SIZE;
  bench->rows = memory_zeroed((size_t)APP_BENCH_SET_COUNT * QUANTITY_COUNT * MAX_MODELS, sizeof *bench->rows);
  bench->volume = memory_zeroed(batch, sizeof *bench->volume);
  bench->gradient = memory_zeroed(batch * pair, sizeof *bench->gradient);
  bench->hessian =
      memory_zeroed(options->wants_quantity[2] ? batch * pair * pair : 0, sizeof *bench->hessian);
  if (!bench->rows || !bench->volume || !bench->gradient || !bench->hessian)
    return status_no_memory("the batch (--batch)");
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) {
    if (!options->wants_set[set]) continue;
    if (!(bench->pairs[set] = memory_zeroed(batch * pair, sizeof *bench->pairs[set])))
      return status_no_memory("the batch (--batch)");
    TRY(app_bench_pairs_make(app_bench_sets[set], options->batch, SEED, bench->pairs[set]));
  }
  return STATUS_OK;
}

static Status measure_round(Row *row, int round) {
  double wall = clock_wall_s(), cpu = clock_cpu_s();
  for (int call = 0; call < row->calls; call++) TRY(contact_overlap_eval(&row->model, &row->batch));
  double pairs = (double)row->calls * row->batch.pair_count;
  row->wall[round] = (clock_wall_s() - wall) / pairs;
  row->cpu[round] = (clock_cpu_s() - cpu) / pairs;
  return STATUS_OK;
}

static Status measure(Bench *bench) {
  for (int r = 0; r < bench->row_count; r++)
    TRY(measure_round(&bench->rows[r], 0)); // warm-up, measured again
  for (int round = 0; round < bench->options->repeats; round++) {
    log_progress("round %d of %d", round + 1, bench->options->repeats);
    for (int r = 0; r < bench->row_count; r++) TRY(measure_round(&bench->rows[r], round));
  }
  log_progress_end();
  return STATUS_OK;
}

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

typedef struct Rates {
  double median, min, max, cpu_median; // pairs a second
} Rates;

static double median_of(const double *sorted, int count) {
  return (sorted[(count - 1) / 2] + sorted[count / 2]) / 2;
}

static Rates rates_of(Row *row, int repeats) {
  qsort(row->wall, (size_t)repeats, sizeof *row->wall, compare);
  qsort(row->cpu, (size_t)repeats, sizeof *row->cpu, compare);
  return (Rates){.median = 1 / median_of(row->wall, repeats),
                 .min = 1 / row->wall[repeats - 1],
                 .max = 1 / row->wall[0],
                 .cpu_median = 1 / median_of(row->cpu, repeats)};
}

static Status print_json(const Row *row, Rates rates, const Options *options) {
  Record *record = record_new();
  record_text(record, "bench", "overlap");
  record_text(record, "model", row->model.ops->name);
  record_text(record, "set", row->set);
  record_text(record, "quantity", row->quantity);
  record_integer(record, "threads", options->threads);
  record_integer(record, "batch", row->batch.pair_count);
  record_number(record, "pairs_per_second", rates.median);
  record_number(record, "pairs_per_cpu_second", rates.cpu_median);
  record_number(record, "pairs_per_second_min", rates.min);
  record_number(record, "pairs_per_second_max", rates.max);
  record_number(record, "spread", (rates.max - rates.min) / rates.median);
  record_integer(record, "repeats", options->repeats);
  record_text(record, "processor", cpu_name());
  Status status = record ? record_print_line(record, stdout) : status_no_memory("a row");
  record_destroy(record);
  return status;
}

static void print_head(Format format) {
  if (format == FORMAT_CSV)
    puts("bench,model,set,quantity,threads,batch,pairs_per_second,pairs_per_cpu_second,pairs_per_second_min,"
         "pairs_per_second_max,spread,repeats,processor");
  if (format == FORMAT_TABLE)
    printf("%s\n%-8s %-9s %-12s %7s %7s %12s %12s %7s\n", cpu_name(), "model", "set", "quantity", "threads",
           "batch", "pairs/s", "pairs/cpu s", "spread");
}

static Status print_row(const Row *row, Rates rates, const Options *options) {
  const char *model = row->model.ops->name;
  double spread = (rates.max - rates.min) / rates.median;
  int batch = row->batch.pair_count;
  if (options->format == FORMAT_JSON) return print_json(row, rates, options);
  if (options->format == FORMAT_CSV)
    printf("overlap,%s,%s,%s,%d,%d,%.6g,%.6g,%.6g,%.6g,%.3g,%d,\"%s\"\n", model, row->set, row->quantity,
           options->threads, batch, rates.median, rates.cpu_median, rates.min, rates.max, spread,
           options->repeats, cpu_name());
  else
    printf("%-8s %-9s %-12s %7d %7d %12.4g %12.4g %6.0f%%\n", model, row->set, row->quantity,
           options->threads, batch, rates.median, rates.cpu_median, 100 * spread);
  return STATUS_OK;
}

static Status print_rows(Bench *bench) {
  print_head(bench->options->format);
  for (int r = 0; r < bench->row_count; r++)
    TRY(print_row(&bench->rows[r], rates_of(&bench->rows[r], bench->options->repeats), bench->options));
  return fflush(stdout) == 0 ? STATUS_OK : status_fail(STATUS_IO, "standard output cannot be written");
}

static void destroy(Bench *bench) {
  for (int r = 0; r < bench->row_count; r++) contact_overlap_destroy(&bench->rows[r].model);
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) memory_free(bench->pairs[set]);
  memory_free(bench->rows), memory_free(bench->volume);
  memory_free(bench->gradient), memory_free(bench->hessian);
}

static Status run(const Options *options) {
  Bench bench = {.options = options};
  int threads_before = omp_get_max_threads();
  omp_set_num_threads(options->threads);
  Status status = make_inputs(&bench);
  if (status == STATUS_OK) status = add_rows(&bench);
  if (status == STATUS_OK) status = measure(&bench);
  if (status == STATUS_OK) status = print_rows(&bench);
  omp_set_num_threads(threads_before);
  destroy(&bench);
  return status;
}

int app_bench_run(int argument_count, char **arguments) {
  static const struct argp argp = {
      .options = option_table,
      .parser = parse,
      .args_doc = "overlap",
      .doc =
          "Measure how many pairs of tetrahedra a second the overlap models answer. The models take turns in "
          "every round."};
  Options options = {.threads = 1, .batch = 4096, .repeats = 9};
  for (int i = 0; i < MAX_MODELS; i++) options.wants_model[i] = true;
  for (int i = 0; i < APP_BENCH_SET_COUNT; i++) options.wants_set[i] = true;
  for (int i = 0; i < QUANTITY_COUNT; i++) options.wants_quantity[i] = true;
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  Status status = run(&options);
  if (status != STATUS_OK) log_error("%s", status_message());
  return status_exit_code(status);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/overlap/datagen.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/bench/command.h"
#include "app/bench/report.h"
#include "app/bench/timer.h"
#include "app/cli/argument.h"
#include "base/files/temporary.h"
#include "base/memory.h"
#include "datagen/generate.h"
#include "datagen/run.h"

enum { MAX_LAWS = 8, KIND_COUNT = 3 };

// What is made: V only, as the paper's 12 million pairs; with ∇V; V and a whole file.
static const char *const products[KIND_COUNT] = {"V", "V+grad", "V, file"};

typedef struct Options {
  AppBenchOptions common;
  bool wants_law[MAX_LAWS];
  int count;
  double planned; // pairs whose time is told
} Options;

enum { KEY_PLANNED = 256 };

static const struct argp_option option_table[] = {
    {"law", 'l', "NAME,...", 0, "Laws, as of `tetlap datagen --list` (default: paper-train)", 1},
    {"count", 'n', "N", 0, "Pairs a round (default: 20000)", 1},
    {"planned", KEY_PLANNED, "N", 0, "Tell how long so many pairs would take (default: 1.2e7, the paper's)",
     1},
    {0},
};

static int list_laws(const char *names[MAX_LAWS]) {
  int count;
  const DatagenLaw *laws = datagen_law_list(&count);
  if (count > MAX_LAWS) count = MAX_LAWS;
  for (int l = 0; l < count; l++) names[l] = laws[l].name;
  return count;
}

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  const char *names[MAX_LAWS];
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->common;
    return 0;
  case 'l':
    app_bench_options_choose(state, "law", text, names, list_laws(names), options->wants_law);
    return 0;
  case 'n':
    options->count = (int)app_argument_integer(state, "count", text, 1, 100000000);
    return 0;
  case KEY_PLANNED:
    options->planned = app_argument_number(state, "planned", text, 1, 1e15);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

typedef struct Contestant {
  DatagenPlan plan;
  int product, threads, count;
  DatagenPairs *pairs; // shared by all, borrowed
  long long first;     // a round goes on where the last one ended: no round repeats another's pairs
  AppBenchTimer timer; // of a pair
} Contestant;

static Status write_file(Contestant *contestant) {
  char *path;
  TRY(temporary_file("bench", ".h5", &path));
  DatagenRunOptions run = {
      .path = path, .program = "tetlap-lab", .first = contestant->first, .count = contestant->count};
  Status status = datagen_run(&contestant->plan, &run);
  temporary_remove(path);
  return status;
}

static Status take_turn(void *self, int round) {
  Contestant *contestant = self;
  long long attempts[DATAGEN_KIND_COUNT] = {0};
  DatagenPairs pairs = *contestant->pairs;
  if (contestant->product != 1) pairs.gradient = NULL;
  omp_set_num_threads(contestant->threads);
  app_bench_timer_start(&contestant->timer);
  Status status = contestant->product == 2 ? write_file(contestant)
                                           : datagen_generate(&contestant->plan, contestant->first,
                                                              contestant->count, &pairs, attempts);
  app_bench_timer_stop(&contestant->timer, round, contestant->count);
  contestant->first += contestant->count;
  return status;
}

typedef struct Row {
  const char *law, *product;
  long long count, threads;
  double rate, cpu_rate, spread, thread_gain, planned, planned_s;
} Row;

static const AppBenchColumn columns[] = {
    {"law", APP_BENCH_TEXT, offsetof(Row, law), "law", "law of the pairs"},
    {"product", APP_BENCH_TEXT, offsetof(Row, product), "product",
     "V; V+grad; or V, written to a file as `tetlap datagen` does"},
    {"count", APP_BENCH_INTEGER, offsetof(Row, count), "pairs", "pairs a round"},
    {"threads", APP_BENCH_INTEGER, offsetof(Row, threads), "threads", "threads"},
    {"pairs_per_second", APP_BENCH_NUMBER, offsetof(Row, rate), "pairs/s", "of wall time"},
    {"pairs_per_cpu_second", APP_BENCH_NUMBER, offsetof(Row, cpu_rate), "pairs/cpu s", "of processor time"},
    {"spread", APP_BENCH_NUMBER, offsetof(Row, spread), "spread", "(max − min) / median"},
    {"thread_gain", APP_BENCH_NUMBER, offsetof(Row, thread_gain), "× threads",
     "speed over that on the first number of threads, median of the rounds"},
    {"planned", APP_BENCH_NUMBER, offsetof(Row, planned), "so many", "pairs (--planned)"},
    {"planned_s", APP_BENCH_NUMBER, offsetof(Row, planned_s), "would take s", "at this rate [s]"},
};
static const AppBenchReport report = {"datagen", columns, sizeof columns / sizeof *columns, sizeof(Row),
                                      true};

typedef struct Bench {
  const Options *options;
  Contestant *contestants;
  int count;
  DatagenPairs pairs;
} Bench;

// Threads are innermost: the first of a group is what the others are held against.
static Status add_contestants(Bench *bench) {
  int law_count;
  const Options *options = bench->options;
  const DatagenLaw *laws = datagen_law_list(&law_count);
  for (int l = 0; l < law_count && l < MAX_LAWS; l++)
    for (int p = 0; p < KIND_COUNT && options->wants_law[l]; p++)
      for (int t = 0; t < options->common.thread_list_count; t++) {
        Contestant *contestant = &bench->contestants[bench->count++];
        long long needed = (long long)options->count * (options->common.repeats + 1);
        TRY(datagen_plan_make(&contestant->plan, &laws[l], 1, needed));
        contestant->plan.label = DATAGEN_LABEL_CLIP;
        contestant->plan.wants_gradient = p == 1;
        contestant->product = p, contestant->count = options->count, contestant->pairs = &bench->pairs;
        contestant->threads = options->common.thread_list[t];
      }
  return STATUS_OK;
}

static Row row_of(const Bench *bench, int c) {
  const Contestant *contestant = &bench->contestants[c];
  const Options *options = bench->options;
  int rounds = options->common.repeats;
  const Contestant *first = contestant - c % options->common.thread_list_count;
  AppBenchTime time = app_bench_timer_time(&contestant->timer, rounds);
  return (Row){.law = contestant->plan.law.name,
               .product = products[contestant->product],
               .count = contestant->count,
               .threads = contestant->threads,
               .rate = 1 / time.wall,
               .cpu_rate = 1 / time.cpu,
               .spread = (time.wall_max - time.wall_min) / time.wall,
               .thread_gain = app_bench_timer_ratio(&contestant->timer, &first->timer, rounds).median,
               .planned = options->planned,
               .planned_s = options->planned * time.wall};
}

static Status measure(Bench *bench) {
  const AppBenchOptions *common = &bench->options->common;
  size_t places = (size_t)(MAX_LAWS * KIND_COUNT * common->thread_list_count);
  bench->contestants = memory_zeroed(places, sizeof *bench->contestants);
  if (!bench->contestants) return status_no_memory("the contestants");
  TRY(datagen_pairs_create(&bench->pairs, (size_t)bench->options->count, true));
  TRY(add_contestants(bench));
  TRY(app_bench_timer_take_turns(bench->contestants, sizeof *bench->contestants, bench->count,
                                 common->repeats, true, take_turn));
  Row rows[MAX_LAWS * KIND_COUNT * APP_BENCH_MAX_LIST];
  for (int c = 0; c < bench->count; c++) rows[c] = row_of(bench, c);
  return app_bench_report_print(&report, common, rows, bench->count);
}

static Status run(const Options *options) {
  Bench bench = {.options = options};
  Status status = measure(&bench);
  datagen_pairs_destroy(&bench.pairs);
  memory_free(bench.contestants);
  return status;
}

static const struct argp argp = {.options = option_table,
                                 .parser = parse,
                                 .doc = "Measure how many labelled pairs a second data sets are made of.",
                                 .children = app_bench_command_children,
                                 .help_filter = app_bench_command_help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = app_bench_options_default(3), .count = 20000, .planned = 1.2e7};
  const char *names[MAX_LAWS];
  int laws = list_laws(names);
  for (int l = 0; l < laws; l++) options.wants_law[l] = strcmp(names[l], "paper-train") == 0;
  options.common.takes_thread_list = true;
  app_bench_command_read(&lab_datagen, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_datagen = {.name = "datagen",
                                .help = "labelled pairs a second",
                                .argp = &argp,
                                .run = run_command,
                                .has_threads = true,
                                .rows = &report,
                                .describe_rows = app_bench_command_rows};

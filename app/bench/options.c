// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/options.h"

#include <math.h>
#include <string.h>

#include "app/cli/argument.h"
#include "app/evaluation/model.h"

enum { MOST_BATCH = 10000000 };

AppBenchOptions app_bench_options_default(void) {
  return (AppBenchOptions){.threads = 1, .repeats = 9, .thread_list = {{1}, 1}};
}

int app_bench_list_largest(const AppBenchList *list) {
  int largest = list->numbers[0];
  for (int i = 1; i < list->count; i++) largest = list->numbers[i] > largest ? list->numbers[i] : largest;
  return largest;
}

static void read_list(struct argp_state *state, const char *option, char *text, int largest,
                      AppBenchList *list) {
  const char *words[APP_BENCH_MAX_LIST];
  list->count = app_argument_list(state, option, text, "1,2", APP_BENCH_MAX_LIST, words);
  for (int w = 0; w < list->count; w++) {
    double number = app_argument_number(state, option, words[w], 1, largest);
    if (number != floor(number))
      argp_error(state, "--%s has %g; give whole numbers from 1 to %d", option, number, largest);
    list->numbers[w] = (int)number;
  }
}

void app_bench_options_read_batches(struct argp_state *state, void *list, char *text) {
  read_list(state, "batch", text, MOST_BATCH, list);
}

static void read_threads(struct argp_state *state, void *member, char *text) {
  AppBenchOptions *options = member;
  if (strchr(text, ',') && !options->takes_thread_list)
    argp_error(state, "--threads is '%s'; this bench takes one number", text);
  read_list(state, "threads", text, APP_CLI_MOST_THREADS, &options->thread_list);
  options->threads = options->thread_list.numbers[0];
}

const AppOption app_bench_options[] = {
    {"threads", 't', "N", "Threads (default: 1); some benches take a list, as in 1,2", 2, CLI_OWN,
     .size = sizeof(AppBenchOptions), .read = read_threads},
    {"repeat", 'r', "N", "Rounds; the median is reported", 2, CLI_INTEGER, CLI_TO(AppBenchOptions, repeats),
     1, APP_BENCH_MAX_REPEATS},
    {"json", 'j', NULL, "Print one JSON object a row", 3, CLI_VALUE, CLI_TO(AppBenchOptions, format),
     APP_TABLE_JSON},
    {"csv", 'c', NULL, "Print comma-separated values", 3, CLI_VALUE, CLI_TO(AppBenchOptions, format),
     APP_TABLE_CSV},
    {"markdown", 'M', NULL, "Print a Markdown table", 3, CLI_VALUE, CLI_TO(AppBenchOptions, format),
     APP_TABLE_MARKDOWN},
    {0},
};

Status app_bench_options_open(const char *source, OverlapModel *model) {
  Status status = app_evaluation_model_open(model, source);
  return status == STATUS_INPUT ? status_prefix(STATUS_USAGE, "--model") : status;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/cli/argument.h"
#include "app/evaluation/model.h"
#include "base/text.h"

AppBenchOptions app_bench_options_default(int repeats) {
  return (AppBenchOptions){.threads = 1, .repeats = repeats, .thread_list = {1}, .thread_list_count = 1};
}

static const struct argp_option option_table[] = {
    {"threads", 't', "N", 0, "Threads (default: 1); some benches take a list, as in 1,2", 2},
    {"repeat", 'r', "N", 0, "Rounds; the median is reported", 2},
    {"json", 'j', NULL, 0, "Print one JSON object a row", 3},
    {"csv", 'c', NULL, 0, "Print comma-separated values", 3},
    {"markdown", 'M', NULL, 0, "Print a Markdown table", 3},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  AppBenchOptions *options = state->input;
  switch (key) {
  case 't':
    if (strchr(text, ',') && !options->takes_thread_list)
      argp_error(state, "--threads is '%s'; this bench takes one number", text);
    options->thread_list_count = app_bench_options_counts(state, "threads", text, 1024, options->thread_list);
    options->threads = options->thread_list[0];
    return 0;
  case 'r':
    options->repeats = (int)app_argument_integer(state, "repeat", text, 1, APP_BENCH_MAX_REPEATS);
    return 0;
  case 'j':
    options->format = APP_TABLE_JSON;
    return 0;
  case 'c':
    options->format = APP_TABLE_CSV;
    return 0;
  case 'M':
    options->format = APP_TABLE_MARKDOWN;
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

const struct argp app_bench_options_argp = {.options = option_table, .parser = parse};

static int find(const char *word, const char *const *names, int count) {
  int found = 0;
  while (found < count && strcmp(names[found], word) != 0) found++;
  return found;
}

void app_bench_options_choose(struct argp_state *state, const char *option, char *text,
                              const char *const *names, int count, bool *wanted) {
  char known[256] = "";
  size_t used = 0;
  for (int i = 0; i < count; i++) {
    text_append(known, sizeof known, &used, "%s%s", i ? ", " : "", names[i]);
    wanted[i] = false;
  }
  enum { MOST_CHOICES = 64 };
  const char *words[MOST_CHOICES];
  int word_count = app_argument_list(state, option, text, names[0], MOST_CHOICES, words);
  for (int w = 0; w < word_count; w++) {
    int found = find(words[w], names, count);
    if (found == count)
      argp_error(state, "--%s has '%s'; give some of: %s", option, words[w], known);
    else
      wanted[found] = true;
  }
}

int app_bench_options_counts(struct argp_state *state, const char *option, char *text, int largest,
                             int *counts) {
  const char *words[APP_BENCH_MAX_LIST];
  int count = app_argument_list(state, option, text, "1,2", APP_BENCH_MAX_LIST, words);
  for (int w = 0; w < count; w++) {
    double number = app_argument_number(state, option, words[w], 1, largest);
    if (number != floor(number))
      argp_error(state, "--%s has %g; give whole numbers from 1 to %d", option, number, largest);
    counts[w] = (int)number;
  }
  return count;
}

Status app_bench_options_open(const char *source, OverlapModel *model) {
  Status status = app_evaluation_model_open(model, source);
  return status == STATUS_INPUT ? status_prefix(STATUS_USAGE, "--model") : status;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What all benches take on the command line, and how they read lists.
#ifndef TETLAP_APP_BENCH_OPTIONS_H
#define TETLAP_APP_BENCH_OPTIONS_H

#include <argp.h>
#include <stdbool.h>

#include "app/table/table.h"
#include "overlap/model.h"

enum { APP_BENCH_MAX_REPEATS = 1000, APP_BENCH_MAX_LIST = 16 };

typedef struct AppBenchOptions {
  int threads;            // of OpenMP and the solvers; the first, where a bench takes a list of them
  int repeats;            // rounds
  bool takes_thread_list; // the bench measures several numbers of threads
  int thread_list[APP_BENCH_MAX_LIST]; // (thread_list_count)
  int thread_list_count;
  AppTableFormat format;
  const struct AppBenchReport *report; // of the bench (app/bench/report.h)
} AppBenchOptions;

// One thread, `repeats` rounds, a table.
AppBenchOptions app_bench_options_default(int repeats);

// --threads, --repeat, --json, --csv and --markdown as an argp child; its input is AppBenchOptions, which
// holds the bench's own defaults before.
extern const struct argp app_bench_options_argp;

// Readers of an option's text. Each ends the program with what would be right (argp_error) if it is wrong.
// Marks each name of a comma-separated list in `wanted` (count), the others not.
void app_bench_options_choose(struct argp_state *state, const char *option, char *text,
                              const char *const *names, int count, bool *wanted);
// Opens a model that --model names. STATUS_USAGE: there is none of that name.
Status app_bench_options_open(const char *source, OverlapModel *model);

// Fills `counts` (APP_BENCH_MAX_LIST) with whole numbers from 1 from a comma-separated list; returns how
// many. 1e6 is one.
int app_bench_options_counts(struct argp_state *state, const char *option, char *text, int largest,
                             int *counts);

#endif

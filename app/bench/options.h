// SPDX-License-Identifier: GPL-3.0-or-later
// What all benches take on the command line, and how they read lists.
#ifndef TETLAP_APP_BENCH_OPTIONS_H
#define TETLAP_APP_BENCH_OPTIONS_H

#include <stdbool.h>

#include "app/cli/option.h"
#include "app/table/table.h"
#include "overlap/model.h"

enum { APP_BENCH_MAX_REPEATS = 1000, APP_BENCH_MAX_LIST = 16 };

// Whole numbers from 1, as in --threads 1,2.
typedef struct AppBenchList {
  int numbers[APP_BENCH_MAX_LIST]; // (count)
  int count;
} AppBenchList;

int app_bench_list_largest(const AppBenchList *list);

typedef struct AppBenchOptions {
  int threads;              // of OpenMP and the solvers; the first, where a bench takes a list of them
  int repeats;              // rounds
  bool takes_thread_list;   // the bench measures several numbers of threads
  AppBenchList thread_list; // these
  AppTableFormat format;
} AppBenchOptions;

// One thread, nine rounds, a table.
AppBenchOptions app_bench_options_default(void);

// --threads, --repeat, --json, --csv and --markdown, for the table of a bench; AppBenchOptions holds the
// bench's own defaults before.
extern const AppOption app_bench_options[];

// Of --batch, an AppBenchList; 1e6 is a number, too. Ends the program if the text is wrong.
void app_bench_options_read_batches(struct argp_state *state, void *list, char *text);

// Opens a model that --model names. STATUS_USAGE: there is none of that name.
Status app_bench_options_open(const char *source, OverlapModel *model);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The rows that a bench prints. Beside its own columns every row has `bench`
// (first), `threads`, `repeats`, `processor`, `simd` and `versions` (last).
#ifndef TETLAP_APP_BENCH_REPORT_H
#define TETLAP_APP_BENCH_REPORT_H

#include <stdbool.h>

#include "app/bench/options.h"

typedef struct AppBenchReport {
  const char *bench;
  const AppTableColumn *columns; // (column_count)
  int column_count;
  size_t row_size;      // of the row's struct
  bool has_own_threads; // a column of its own has `threads`
} AppBenchReport;

// Prints rows, elements of row_size bytes, to standard output. STATUS_IO, STATUS_MEMORY.
Status app_bench_report_print(const AppBenchReport *report, const AppBenchOptions *options, const void *rows,
                              int row_count);

// The keys of a row, of the bench's `rows` (AppBenchReport); owned by the caller (free). NULL: no memory.
char *app_bench_report_describe(const void *rows);

#endif

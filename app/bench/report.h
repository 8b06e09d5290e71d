// SPDX-License-Identifier: GPL-3.0-or-later
// The rows that a bench prints: a struct a row, a table of columns that tells their keys, in one of four
// formats. Every row also tells `bench` (first), `threads`, `repeats`, `processor`, `simd` and
// `versions` (last).
#ifndef TETLAP_APP_BENCH_REPORT_H
#define TETLAP_APP_BENCH_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "app/bench/options.h"
#include "base/files/record.h"
#include "base/status.h"

typedef enum AppBenchKind {
  APP_BENCH_TEXT,    // const char *; NULL: empty
  APP_BENCH_INTEGER, // long long
  APP_BENCH_NUMBER,  // double; NaN: not measured (null in JSON)
  APP_BENCH_COUNT,   // likewise, a whole number
} AppBenchKind;

typedef struct AppBenchColumn {
  const char *key; // in JSON and CSV
  AppBenchKind kind;
  size_t offset;    // in the row's struct
  const char *head; // above the column of a table; NULL: JSON and CSV only
  const char *help; // what it is, with its unit
} AppBenchColumn;

typedef struct AppBenchReport {
  const char *bench;
  const AppBenchColumn *columns; // (column_count)
  int column_count;
  size_t row_size;      // of the row's struct
  bool has_own_threads; // a column of its own tells `threads`
} AppBenchReport;

// Prints rows, elements of row_size bytes, to standard output. STATUS_IO, STATUS_MEMORY.
Status app_bench_report_print(const AppBenchReport *report, const AppBenchOptions *options, const void *rows,
                              int row_count);

// The same rows as CSV; an error is found when the stream is closed.
void app_bench_report_write_csv(const AppBenchReport *report, const AppBenchOptions *options,
                                const void *rows, int row_count, FILE *stream);

// A row's own columns as keys of a JSON object.
void app_bench_report_record(const AppBenchReport *report, const void *row, Record *record);

// Text for argp's help filter: after the options the keys of a row. Others are handed back as they are.
char *app_bench_report_help(const AppBenchReport *report, int argp_key, const char *text);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// A bench as a command line, and the rows that it prints. Beside its own columns every row tells `bench`
// (first), `threads`, `repeats`, `processor`, `simd` and `versions` (last).
#ifndef TETLAP_APP_BENCH_REPORT_H
#define TETLAP_APP_BENCH_REPORT_H

#include <stdbool.h>

#include "app/bench/options.h"
#include "app/cli/command.h"

typedef struct AppBenchReport {
  const char *bench;
  const AppTableColumn *columns; // (column_count)
  int column_count;
  size_t row_size;      // of the row's struct
  bool has_own_threads; // a column of its own tells `threads`
} AppBenchReport;

// Prints rows, elements of row_size bytes, to standard output. STATUS_IO, STATUS_MEMORY.
Status app_bench_report_print(const AppBenchReport *report, const AppBenchOptions *options, const void *rows,
                              int row_count);

// Of a bench's `struct argp`: the options that all benches take, whose input its parser hands on as
// child_inputs[0], and a help that ends with the keys of a row.
extern const struct argp_child app_bench_report_children[];
char *app_bench_report_help(int key, const char *text, void *options);

// The keys of a row, of the bench's `rows` (AppBenchReport); owned by the caller (free). NULL: no memory.
char *app_bench_report_describe(const void *rows);

// Reads the command line into `options`, a struct whose first member is its AppBenchOptions `common` and that
// holds the defaults. A wrong line, or --help, ends the program.
void app_bench_report_read(const AppCommand *command, int argument_count, char **arguments, void *options);

#endif

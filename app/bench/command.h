// SPDX-License-Identifier: GPL-3.0-or-later
// A bench as a command line: its own options beside those that all take, and a help that tells the columns of
// its rows.
#ifndef TETLAP_APP_BENCH_COMMAND_H
#define TETLAP_APP_BENCH_COMMAND_H

#include "app/bench/options.h"
#include "app/bench/report.h"
#include "app/cli/command.h"
#include "base/status.h"

// Of a bench's `struct argp`: the options that all benches take, whose input its parser hands on as
// child_inputs[0], and a help that ends with the keys of a row.
extern const struct argp_child app_bench_command_children[];
char *app_bench_command_help(int key, const char *text, void *options);

// The keys of a row, of the bench's `rows` (AppBenchReport); owned by the caller (free). NULL: no memory.
char *app_bench_command_rows(const void *rows);

// Reads the command line into `options`, a struct whose first member is its AppBenchOptions `common` and that
// holds the defaults. A wrong line, or --help, ends the program.
void app_bench_command_read(const AppCommand *command, int argument_count, char **arguments, void *options);

#endif

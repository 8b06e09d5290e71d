// SPDX-License-Identifier: GPL-3.0-or-later
// A bench as a command line: its own options beside those that all take, and a help that tells the columns of
// its rows.
#ifndef TETLAP_APP_BENCH_COMMAND_H
#define TETLAP_APP_BENCH_COMMAND_H

#include <argp.h>

#include "app/bench/options.h"
#include "app/bench/report.h"
#include "base/status.h"

typedef struct AppBenchCommand {
  const AppBenchReport *report;      // of the rows that it prints
  const struct argp_option *options; // its own; ended by zeros
  argp_parser_t parse;               // of them; hands `common` on as child_inputs[0]
  const char *arguments, *doc;       // for the help; `arguments` NULL: it takes none
} AppBenchCommand;

// Reads the command line into `options`, a struct whose first member is its AppBenchOptions `common` and that
// holds the defaults. A wrong line, or --help, ends the program.
void app_bench_command_read(const AppBenchCommand *command, int argument_count, char **arguments,
                            void *options);

// Says what went wrong, if anything did, and gives the program's exit code.
int app_bench_command_end(Status status);

#endif

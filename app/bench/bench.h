// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench NAME`: what is measured, one file a NAME (app/bench/NAME.c).
#ifndef TETLAP_APP_BENCH_BENCH_H
#define TETLAP_APP_BENCH_BENCH_H

// Runs the subcommand; arguments[0] is what the usage line begins with. Returns the exit code.
int app_bench_run(int argument_count, char **arguments);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench overlap`: how many pairs of tetrahedra a second the overlap models answer.
//
// All models take turns in every round, so that a machine that changes its pace changes it for all. A row's
// figure is the median over the rounds; a round of a row takes about 50 ms, a call at most a quarter of a
// second: slow models get smaller batches, and the row says how large.
#ifndef TETLAP_APP_BENCH_H
#define TETLAP_APP_BENCH_H

// Runs the subcommand; arguments[0] is what the usage line begins with. Returns the exit code.
int app_bench_run(int argument_count, char **arguments);

#endif

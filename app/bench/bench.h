// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench NAME`: the table of benches.
#ifndef TETLAP_APP_BENCH_BENCH_H
#define TETLAP_APP_BENCH_BENCH_H

#include "app/cli/command.h"

extern const AppCommand app_bench_bench;

// app/bench/overlap: how many pairs of tetrahedra a second the models answer; app/bench/unseen: how right
// they are on bodies that no training has seen.
extern const AppCommand app_bench_overlap, app_bench_unseen;

#endif

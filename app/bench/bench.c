// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/bench.h"

static const AppCommand *const benches[] = {&app_bench_overlap, &app_bench_unseen, NULL};

const AppCommand app_bench_bench = {
    .name = "bench",
    .help = "measure overlap models",
    .children = benches,
    .child_word = "bench",
    .doc = "Measures how fast overlap models are, and how right on bodies that no training has seen.",
    .ending = "`tetlap bench BENCH --help` lists the options and the columns of a row.",
};

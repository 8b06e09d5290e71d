// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench overlap`: how many pairs of tetrahedra a second the overlap models answer.
//
// A round of a model on a set takes about 50 ms, a call at most a quarter of a second: slow models get
// smaller batches, and the row says how large.
#ifndef TETLAP_APP_BENCH_OVERLAP_H
#define TETLAP_APP_BENCH_OVERLAP_H

#include "app/cli/command.h"

extern const AppCommand app_bench_overlap;

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench drop`: a block that falls onto the ground, for every contact stiffness and tolerance of a
// list: how much energy the run gains at most, and what keeping it low costs.
#ifndef TETLAP_APP_BENCH_DROP_H
#define TETLAP_APP_BENCH_DROP_H

#include "app/cli/command.h"

extern const AppCommand app_bench_drop;

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench ranks SCENE`: one run on several numbers of processes: work, memory, balance, what is sent.
#ifndef TETLAP_APP_BENCH_SCENE_RANKS_H
#define TETLAP_APP_BENCH_SCENE_RANKS_H

#include "app/cli/command.h"

extern const AppCommand app_bench_ranks;

#endif

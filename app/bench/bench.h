// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench NAME`: what is measured, one file a NAME (app/bench/NAME.c).
#ifndef TETLAP_APP_BENCH_BENCH_H
#define TETLAP_APP_BENCH_BENCH_H

#include "app/cli/command.h"

extern const AppCommand app_bench_bench;

#endif

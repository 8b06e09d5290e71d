// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench NAME`: the table of benches.
#ifndef TETLAP_APP_BENCH_BENCH_H
#define TETLAP_APP_BENCH_BENCH_H

#include "app/cli/command.h"

extern const AppCommand app_bench_bench;

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench net`: networks alone, without geometry: our kernels beside PyTorch with the same weights and
// inputs, in the same run, and how near each comes to what a core can do.
#ifndef TETLAP_APP_BENCH_NET_H
#define TETLAP_APP_BENCH_NET_H

#include "app/cli/command.h"

extern const AppCommand app_bench_net;

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef TETLAP_APP_BENCH_UNSEEN_H
#define TETLAP_APP_BENCH_UNSEEN_H

#include "app/cli/command.h"

extern const AppCommand app_bench_unseen;

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench step SCENE`: where the time of a run goes, one row a phase.
#ifndef TETLAP_APP_BENCH_STEP_H
#define TETLAP_APP_BENCH_STEP_H

#include "app/cli/command.h"

extern const AppCommand app_bench_step;

#endif

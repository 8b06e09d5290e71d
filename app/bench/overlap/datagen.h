// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench datagen`: labelled pairs a second, in memory and into a file.
#ifndef TETLAP_APP_BENCH_DATAGEN_H
#define TETLAP_APP_BENCH_DATAGEN_H

#include "app/cli/command.h"

extern const AppCommand app_bench_datagen;

#endif

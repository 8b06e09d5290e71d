// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench train CONFIG…`: samples a second of a training's steps, beside PyTorch's for the networks
// whose loss it shares.
#ifndef TETLAP_APP_BENCH_TRAIN_H
#define TETLAP_APP_BENCH_TRAIN_H

#include "app/cli/command.h"

extern const AppCommand app_bench_train;

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench train CONFIG…`: samples a second of a training's steps, beside PyTorch's for the networks
// whose loss it shares.
#ifndef TETLAP_APP_BENCH_TRAIN_H
#define TETLAP_APP_BENCH_TRAIN_H

// Runs the bench; arguments[0] is what the usage line begins with. Returns the exit code.
int app_bench_train_run(int argument_count, char **arguments);

#endif

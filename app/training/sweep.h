// SPDX-License-Identifier: GPL-3.0-or-later
// Many small trainings that differ in the network's size. A sweep is a directory with training configurations
// and a file `sizes`, a training a line:
//
//     geo.yaml  name=geo-36-8x1  model.features=36 model.width=8 model.depth=1
//
// the configuration's file and what is set in it; # begins a comment. Names must differ.
#ifndef TETLAP_APP_TRAINING_SWEEP_H
#define TETLAP_APP_TRAINING_SWEEP_H

#include <signal.h>

#include "base/status.h"

enum { APP_SWEEP_MAX = 64 };

typedef struct AppSweep {
  int count;
  char *weights[APP_SWEEP_MAX]; // paths of the weights files, owned
} AppSweep;

// Trains what has no weights in the directory yet, `weights`/NAME/NAME.safetensors, and lists all weights.
// STATUS_INPUT names the line that is wrong. STATUS_INTERRUPTED: the stop flag was raised; what is trained
// stays.
Status app_sweep_train(AppSweep *sweep, const char *directory, const char *weights, int threads,
                       const volatile sig_atomic_t *stop);
void app_sweep_destroy(AppSweep *sweep); // a zeroed one is accepted

#endif

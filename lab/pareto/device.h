// SPDX-License-Identifier: GPL-3.0-or-later
// A model's kernels on a device: its answers to a batch, and the time of them while pairs and answers lie
// there.
#ifndef TETLAP_LAB_PARETO_DEVICE_H
#define TETLAP_LAB_PARETO_DEVICE_H

#include "app/bench/timer.h"
#include "device/overlap/overlap.h"

// Whether the model of that name, with the weights that ship, has kernels.
bool lab_pareto_device_knows(const char *model);

// Fills the batch, which has volume, gradient and flags, and times V and V+grad: `timers`, by DeviceQuantity.
Status lab_pareto_device_measure(const Device *device, const char *model, const OverlapBatch *batch,
                                 int rounds, AppBenchTimer timers[2]);

#endif

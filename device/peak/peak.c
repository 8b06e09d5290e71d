// SPDX-License-Identifier: Apache-2.0
#include "device/peak/peak.h"

#include <math.h>

// Chains of an item and items of a group, as in kernels/peak.inc. So many groups fill every multiprocessor.
enum {
  CHAINS = 8,
  ITEMS = 64,
  GROUPS_OF_A_UNIT = 64,
  MOST_GROUPS = 1 << 16,
  MOST_ROUNDS = 1 << 16,
  RUNS = 5
};
static const double ROUND_S = 1e-3;

typedef struct Work {
  const Device *device;       // borrowed
  const DeviceKernel *kernel; // borrowed
  const DeviceMemory *sums;   // borrowed
  int groups;
} Work;

static Status launch(const Work *work, int rounds, double *seconds) {
  const DeviceOps *ops = work->device->ops;
  void *self = work->device->self;
  const DeviceArgument arguments[] = {device_int(rounds), device_double(.5), device_double(1),
                                      device_memory(work->sums)};
  TRY(ops->mark(self, DEVICE_BEGIN));
  TRY(device_launch(work->device, work->kernel, work->groups * ITEMS, arguments, 4));
  TRY(ops->mark(self, DEVICE_END));
  return ops->elapsed(self, seconds);
}

// As many rounds as take ROUND_S, then the best of RUNS launches; 0: the device's clock stands still.
static Status measure(const Work *work, double *peak) {
  int rounds = 64;
  double seconds = 0;
  TRY(launch(work, rounds, &seconds)); // loads code
  TRY(launch(work, rounds, &seconds));
  while (!(seconds >= ROUND_S) && rounds < MOST_ROUNDS) TRY(launch(work, rounds *= 2, &seconds));
  *peak = 0;
  for (int k = 0; k < RUNS; k++) {
    TRY(launch(work, rounds, &seconds));
    if (seconds > 0) *peak = fmax(*peak, 2.0 * CHAINS * ITEMS * work->groups * rounds / seconds);
  }
  return STATUS_OK;
}

Status device_peak_measure(const Device *device, double peak[DEVICE_ARITHMETIC_COUNT]) {
  void *module = NULL;
  DeviceKernel kernels[DEVICE_MAX_KERNELS];
  DeviceMemory sums = {0};
  const int units = device->info.units > 0 ? device->info.units : 1;
  const int groups = units < MOST_GROUPS / GROUPS_OF_A_UNIT ? GROUPS_OF_A_UNIT * units : MOST_GROUPS;
  for (int k = 0; k < DEVICE_ARITHMETIC_COUNT; k++) peak[k] = 0;
  Status status = device_build(device, &device_program_peak, &module, kernels);
  if (!status) status = device_take(device, (size_t)groups * ITEMS, sizeof(double), NULL, &sums);
  for (int k = 0; k < 2 && !status; k++) {
    const Work work = {.device = device, .kernel = &kernels[k], .sums = &sums, .groups = groups};
    status = measure(&work, &peak[k == 0 ? DEVICE_IN_FLOAT : DEVICE_IN_DOUBLE]);
  }
  device->ops->release(device->self, &sums);
  if (module) device->ops->discard(device->self, module);
  return status;
}

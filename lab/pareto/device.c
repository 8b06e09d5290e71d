// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/pareto/device.h"

#include <string.h>

#include "base/clock.h"
#include "base/memory.h"

static const double ROUND_S = 0.05; // what a round shall take

bool lab_pareto_device_knows(const char *model) {
  for (int k = 0; k < DEVICE_OVERLAP_MODELS; k++)
    if (strcmp(device_overlap_models[k], model) == 0) return true;
  return false;
}

// One column a coordinate, as kernels like to read.
static Status put_columns(DeviceOverlap *overlap, const OverlapBatch *batch) {
  const size_t n = (size_t)batch->pair_count;
  double *columns = memory_zeroed(n * OVERLAP_PAIR_SIZE, sizeof *columns);
  if (!columns) return status_no_memory("the pairs for a device");
  for (size_t i = 0; i < n; i++)
    for (size_t c = 0; c < OVERLAP_PAIR_SIZE; c++)
      columns[c * n + i] = batch->pairs[OVERLAP_PAIR_SIZE * i + c];
  Status status = device_overlap_put_columns(overlap, batch->pair_count, columns);
  memory_free(columns);
  return status;
}

static Status run(const Device *device, DeviceOverlap *overlap, DeviceQuantity quantity, int calls) {
  for (int k = 0; k < calls; k++) TRY(device_overlap_run(overlap, quantity));
  return device->ops->wait(device->self);
}

static Status take_time(const Device *device, DeviceOverlap *overlap, DeviceQuantity quantity, int rounds,
                        AppBenchTimer *timer) {
  TRY(run(device, overlap, quantity, 1)); // takes memory, loads code
  const double began = clock_wall_s();
  TRY(run(device, overlap, quantity, 1));
  const double fitting = ROUND_S / (clock_wall_s() - began + 1e-9);
  const int calls = fitting < 1 ? 1 : fitting < 1e6 ? (int)fitting : 1000000;
  for (int round = 0; round < rounds; round++) {
    app_bench_timer_start(timer);
    TRY(run(device, overlap, quantity, calls));
    app_bench_timer_stop(timer, round, (double)calls * overlap->count);
  }
  return STATUS_OK;
}

static Status measure(const Device *device, DeviceOverlap *overlap, const OverlapBatch *batch, int rounds,
                      AppBenchTimer timers[2]) {
  TRY(device_overlap_eval(overlap, batch));
  TRY(put_columns(overlap, batch));
  for (int q = 0; q < 2; q++)
    TRY(take_time(device, overlap, q == 0 ? DEVICE_VOLUME : DEVICE_GRADIENT, rounds, &timers[q]));
  return STATUS_OK;
}

Status lab_pareto_device_measure(const Device *device, const char *model, const OverlapBatch *batch,
                                 int rounds, AppBenchTimer timers[2]) {
  DeviceOverlap overlap;
  Status status = device_overlap_create(&overlap, device, model);
  if (!status) status = measure(device, &overlap, batch, rounds, timers);
  device_overlap_destroy(&overlap);
  return status;
}

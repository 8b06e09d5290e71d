// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench overlap --device`: the models that a device has kernels for, by where the pairs lie.
//
//   device   numbers by column, there already; the answers stay there
//   indices  positions and tetrahedra, there already; a pair is two indices; the answers stay there
//   host     sent from the host as the models take them, and all answers fetched
//
// With `wants_torch` PyTorch evaluates networks beside, on the same device: the network alone, whose inputs
// are there, without the gate before it and the frame around it (torch.h).
//
// A rate is of complete answers: with the pairs that one kernel hands on to the next, and to the host.
#ifndef TETLAP_APP_BENCH_OVERLAP_DEVICE_H
#define TETLAP_APP_BENCH_OVERLAP_DEVICE_H

#include "app/bench/options.h"
#include "app/bench/overlap/pairs.h"
#include "base/status.h"
#include "device/overlap/overlap.h"

enum { APP_BENCH_RESIDENCES = 3 };
extern const char *const app_bench_residences[APP_BENCH_RESIDENCES]; // "device", "indices", "host"

typedef struct AppBenchDeviceDef {
  const AppBenchOptions *common;
  const char *device; // as device_open takes it
  bool wants_model[DEVICE_OVERLAP_MODELS], wants_set[APP_BENCH_SET_COUNT];
  bool wants_quantity[3]; // of DeviceQuantity
  bool wants_residence[APP_BENCH_RESIDENCES];
  bool wants_torch;
  const int *batches; // (batch_count)
  int batch_count;
} AppBenchDeviceDef;

Status app_bench_overlap_device_run(const AppBenchDeviceDef *def);

#endif

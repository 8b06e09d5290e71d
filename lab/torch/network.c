// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/torch/network.h"

#include <stdio.h>

#include "base/memory.h"
#include "base/random.h"
#include "overlap/weights.h"

enum { TPN_INPUTS = 24, SEED = 1 };

static const char *const quantities[] = {"V", "V+grad"}; // of DeviceQuantity

// Inputs as a network takes them, in ±1.
static void *make_inputs(size_t count, bool is_float) {
  Random random = random_seeded(SEED, 0);
  float *narrow = is_float ? memory_zeroed(count, sizeof *narrow) : NULL;
  double *wide = is_float ? NULL : memory_zeroed(count, sizeof *wide);
  for (size_t i = 0; i < count && (narrow || wide); i++) {
    const double x = random_between(&random, -1, 1);
    if (narrow)
      narrow[i] = (float)x;
    else
      wide[i] = x;
  }
  return is_float ? (void *)narrow : (void *)wide;
}

Status lab_torch_network_start(LabTorchNetwork *torch, const DeviceOverlap *overlap, DeviceQuantity quantity,
                               int batch, int threads) {
  static const LabTorchPrecision precisions[] = {[DEVICE_IN_FLOAT] = LAB_TORCH_FLOAT,
                                                 [DEVICE_IN_DOUBLE] = LAB_TORCH_DOUBLE,
                                                 [DEVICE_IN_BF16] = LAB_TORCH_BF16};
  static const char *const words[] = {"float", "double", "bf16"};
  const DeviceArithmetic arithmetic = device_overlap_arithmetic(overlap);
  const bool is_float = arithmetic != DEVICE_IN_DOUBLE;
  const size_t width = overlap->geo.feature_count > 0 ? (size_t)overlap->geo.feature_count : TPN_INPUTS;
  char path[4096];
  *torch = (LabTorchNetwork){.quantity = quantity, .batch = batch};
  TRY(overlap_weights_find(device_overlap_weights(overlap), path, sizeof path));
  void *inputs = make_inputs((size_t)batch * width, is_float);
  if (!inputs) return status_no_memory("PyTorch's inputs (--batch)");
  const LabTorchDef def = {.weights = path,
                           .precision = precisions[arithmetic],
                           .device = overlap->device->ops == &device_cuda ? "cuda" : "cpu",
                           .inputs = inputs,
                           .size = (size_t)batch * width * (is_float ? sizeof(float) : sizeof(double)),
                           .threads = threads};
  Status status = lab_torch_peer_start(&torch->peer, &def);
  memory_free(inputs);
  snprintf(torch->name, sizeof torch->name, "%s, %s, %s", torch->peer.name, words[arithmetic], def.device);
  return status;
}

void lab_torch_network_stop(LabTorchNetwork *torch) {
  lab_torch_peer_stop(&torch->peer);
}

Status lab_torch_network_take_turn(LabTorchNetwork *torch, int round, double round_s) {
  const char *what = quantities[torch->quantity];
  LabTorchTime time;
  for (int k = 0; k < 2 && torch->calls == 0; k++) { // a warm-up, then how long it takes
    TRY(lab_torch_peer_time(&torch->peer, what, torch->batch, 1, &time));
    if (k == 0) continue;
    const double calls = round_s / (time.wall_s + 1e-9);
    torch->calls = calls < 1 ? 1 : calls < 1e6 ? (int)calls : 1000000;
  }
  TRY(lab_torch_peer_time(&torch->peer, what, torch->batch, torch->calls, &time));
  const double samples = (double)torch->calls * torch->batch;
  torch->timer.wall[round] = time.wall_s / samples;
  torch->timer.cpu[round] = time.cpu_s / samples;
  return STATUS_OK;
}

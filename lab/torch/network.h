// SPDX-License-Identifier: GPL-3.0-or-later
// PyTorch beside the kernels of a device: a network's outputs, or with them the derivative of V by its
// inputs, of random inputs that are there.
#ifndef TETLAP_LAB_TORCH_NETWORK_H
#define TETLAP_LAB_TORCH_NETWORK_H

#include "app/bench/timer.h"
#include "device/overlap/overlap.h"
#include "lab/torch/peer.h"

typedef struct LabTorchNetwork {
  LabTorchPeer peer;
  const char *model; // whose network it is
  char name[128];    // PyTorch's, its precision and device
  int batch, calls;
  DeviceQuantity quantity; // V, V+grad
  AppBenchTimer timer;
} LabTorchNetwork;

// For a model with a network. STATUS_IO: PyTorch or its device is not there. A zeroed one, and one that
// failed to start, can be stopped.
Status lab_torch_network_start(LabTorchNetwork *torch, const DeviceOverlap *overlap, DeviceQuantity quantity,
                               int batch, int threads);
void lab_torch_network_stop(LabTorchNetwork *torch);

// A round, of what fills `round_s` seconds.
Status lab_torch_network_take_turn(LabTorchNetwork *torch, int round, double round_s);

#endif

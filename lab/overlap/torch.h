// SPDX-License-Identifier: GPL-3.0-or-later
// PyTorch beside the kernels of a device: a network's outputs, or with them the derivative of V by its
// inputs, of random inputs that are there.
#ifndef TETLAP_LAB_OVERLAP_TORCH_H
#define TETLAP_LAB_OVERLAP_TORCH_H

#include "app/bench/timer.h"
#include "device/overlap/overlap.h"
#include "lab/net/torch_peer.h"

typedef struct LabOverlapTorch {
  LabTorchPeer peer;
  const char *model; // whose network it is
  char name[128];    // PyTorch's, its precision and device
  int batch, calls;
  DeviceQuantity quantity; // V, V+grad
  AppBenchTimer timer;
} LabOverlapTorch;

// For a model with a network. STATUS_IO: PyTorch or its device is not there. A zeroed one, and one that
// failed to start, can be stopped.
Status lab_overlap_torch_start(LabOverlapTorch *torch, const DeviceOverlap *overlap, DeviceQuantity quantity,
                               int batch, int threads);
void lab_overlap_torch_stop(LabOverlapTorch *torch);

// A round, of what fills `round_s` seconds.
Status lab_overlap_torch_take_turn(LabOverlapTorch *torch, int round, double round_s);

#endif

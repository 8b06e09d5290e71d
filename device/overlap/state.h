// SPDX-License-Identifier: Apache-2.0
// What an overlap model on a device consists of (overlap.h), and what it is asked.
#ifndef TETLAP_DEVICE_OVERLAP_STATE_H
#define TETLAP_DEVICE_OVERLAP_STATE_H

#include "device/device.h"
#include "device/network/geo.h"
#include "device/network/tpn.h"
#include "overlap/ops.h"

// Where a batch's numbers lie; as PAIRS_… in kernels/pairs.inc.
typedef enum DevicePairs {
  DEVICE_PAIRS_ROWS,    // (count, 24), gradients likewise
  DEVICE_PAIRS_COLUMNS, // (24, count), gradients likewise
  DEVICE_PAIRS_INDICES, // positions, tetrahedra, and two tetrahedra a pair; gradients (24, count)
} DevicePairs;

enum { DEVICE_OVERLAP_STAGES = 3 };

// What is wanted of a batch; as the kernels of a program are listed.
typedef enum DeviceQuantity { DEVICE_VOLUME, DEVICE_GRADIENT, DEVICE_CENTROID } DeviceQuantity;

typedef struct DeviceOverlapStage {
  void *module; // owned
  DeviceKernel kernels[DEVICE_MAX_KERNELS];
} DeviceOverlapStage;

typedef struct DeviceOverlap {
  const Device *device;                   // borrowed
  const struct DeviceOverlapChain *chain; // borrowed
  int stage_count;
  DeviceTpn tpn;     // the network, where there is one
  DeviceGeo geo;     // likewise
  OverlapModel host; // answers on the host what is left; self borrowed
  DeviceOverlapStage stages[DEVICE_OVERLAP_STAGES], gather;
  DevicePairs kind;
  DeviceQuantity last; // what was evaluated last
  int count, capacity; // pairs: of the batch, and the most there may be
  DeviceMemory numbers, tets, pairs;
  DeviceMemory volume, more, flags;                   // answers; more: ∇V or x̄; flags are one byte each
  DeviceMemory lists[2], list_count;                  // doubtful pairs
  DeviceMemory rows, row_volume, row_more, row_flags; // what the host answers
  int row_capacity;
  double kernel_s;                      // of the last batch: what the stages' kernels took [s]
  long long flop_pairs;                 // of that batch: pairs that took device_overlap_flops
  double gate_s;                        // of that, of a network: the gate, which says whom it is asked
  int handed_on[DEVICE_OVERLAP_STAGES]; // of the last batch: pairs that stage k left to the next, or the host
} DeviceOverlap;

#endif

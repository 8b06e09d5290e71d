// SPDX-License-Identifier: Apache-2.0
// Steps of a chain of kernels. Private to device/.
#ifndef TETLAP_DEVICE_OVERLAP_STAGE_H
#define TETLAP_DEVICE_OVERLAP_STAGE_H

#include "device/overlap/state.h"

// Writes the arguments that all kernels on pairs begin with; how many. `list`: NULL for all pairs.
int device_overlap_pairs(const DeviceOverlap *overlap, int count, const DeviceMemory *list,
                         DeviceArgument *arguments);

// Where a stage of clipping puts its answers, and the pairs that it does not answer.
typedef struct DeviceOverlapAnswers {
  const DeviceMemory *volume, *flags, *more;
  const DeviceMemory *doubtful, *doubtful_count;
} DeviceOverlapAnswers;

// Stage k over the pairs of `list`, `count` of them; how many it leaves.
Status device_overlap_stage(DeviceOverlap *overlap, int k, int count, const DeviceMemory *list,
                            DeviceQuantity quantity, const DeviceOverlapAnswers *answers, int *left);

// Sets a counter to 0; reads it.
Status device_overlap_reset(const DeviceOverlap *overlap, const DeviceMemory *counter);
Status device_overlap_count(const DeviceOverlap *overlap, const DeviceMemory *counter, int *count);

// Around kernels: adds the time between to kernel_s.
Status device_overlap_begin(const DeviceOverlap *overlap);
Status device_overlap_end(DeviceOverlap *overlap);
// Likewise, and to gate_s.
Status device_overlap_end_gate(DeviceOverlap *overlap);

#endif

// SPDX-License-Identifier: Apache-2.0
#include "device/overlap/tpn.h"

#include "device/overlap/stage.h"

enum { GATE, VOLUME, GRADIENT, ANSWER, PULL_BACK }; // kernels of the program

static const DeviceKernel *kernel_of(const DeviceOverlap *overlap, int which) {
  return &overlap->stages[0].kernels[which];
}

// Which pairs the network is asked, as it sees them.
static Status run_gate(DeviceOverlap *overlap, int *left) {
  const DeviceTpn *tpn = &overlap->tpn;
  DeviceArgument arguments[DEVICE_MAX_ARGUMENTS];
  int n = device_overlap_pairs(overlap, overlap->count, NULL, arguments);
  arguments[n++] = device_memory(&overlap->lists[0]);
  arguments[n++] = device_memory(&overlap->list_count);
  n += device_tpn_table(tpn, arguments + n);
  TRY(device_overlap_reset(overlap, &overlap->list_count));
  TRY(device_overlap_begin(overlap));
  TRY(device_launch(overlap->device, kernel_of(overlap, GATE), overlap->count, arguments, n));
  TRY(device_overlap_end_gate(overlap));
  return device_overlap_count(overlap, &overlap->list_count, left);
}

static Status run_network(const DeviceOverlap *overlap, bool has_gradient) {
  const Device *device = overlap->device;
  DeviceArgument arguments[DEVICE_MAX_ARGUMENTS];
  const int n = device_tpn_arguments(&overlap->tpn, has_gradient, overlap->count, arguments);
  return device->ops->launch(device->self, kernel_of(overlap, has_gradient ? GRADIENT : VOLUME),
                             device_tpn_groups(has_gradient, overlap->count), arguments, n);
}

static Status write_answers(const DeviceOverlap *overlap, bool has_gradient) {
  DeviceArgument arguments[DEVICE_MAX_ARGUMENTS];
  int n = device_overlap_pairs(overlap, overlap->count, NULL, arguments);
  arguments[n++] = device_memory(&overlap->volume);
  arguments[n++] = device_memory(&overlap->flags);
  n += device_tpn_table(&overlap->tpn, arguments + n);
  arguments[n++] = device_double(overlap->tpn.scale);
  if (has_gradient) arguments[n++] = device_memory(&overlap->more);
  return device_launch(overlap->device, kernel_of(overlap, has_gradient ? PULL_BACK : ANSWER), overlap->count,
                       arguments, n);
}

Status device_overlap_tpn_run(DeviceOverlap *overlap, DeviceQuantity quantity, int *left) {
  const bool has_gradient = quantity == DEVICE_GRADIENT;
  TRY(device_tpn_make_room(&overlap->tpn, overlap->device, overlap->capacity));
  TRY(run_gate(overlap, left));
  TRY(device_overlap_begin(overlap));
  TRY(run_network(overlap, has_gradient));
  TRY(write_answers(overlap, has_gradient));
  TRY(device_overlap_end(overlap));
  overlap->handed_on[0] = *left;
  overlap->flop_pairs = overlap->count - *left;
  return STATUS_OK;
}

// SPDX-License-Identifier: Apache-2.0
#include "device/overlap/stage.h"

#include <string.h>

#include "device/network/tpn.h"

int device_overlap_pairs(const DeviceOverlap *overlap, int count, const DeviceMemory *list,
                         DeviceArgument *arguments) {
  static const DeviceMemory none = {0};
  const DeviceArgument given[] = {device_int((int)overlap->kind), device_int(count),
                                  device_int(overlap->count),     device_memory(&overlap->numbers),
                                  device_memory(&overlap->tets),  device_memory(&overlap->pairs),
                                  device_int(list != NULL),       device_memory(list ? list : &none)};
  memcpy(arguments, given, sizeof given);
  return sizeof given / sizeof *given;
}

Status device_overlap_reset(const DeviceOverlap *overlap, const DeviceMemory *counter) {
  const Device *device = overlap->device;
  const int none = 0;
  return device->ops->put(device->self, counter, 0, sizeof none, &none);
}

Status device_overlap_count(const DeviceOverlap *overlap, const DeviceMemory *counter, int *count) {
  const Device *device = overlap->device;
  return device->ops->get(device->self, counter, 0, sizeof *count, count);
}

Status device_overlap_begin(const DeviceOverlap *overlap) {
  return overlap->device->ops->mark(overlap->device->self, DEVICE_BEGIN);
}

Status device_overlap_end(DeviceOverlap *overlap) {
  const Device *device = overlap->device;
  double seconds = 0;
  TRY(device->ops->mark(device->self, DEVICE_END));
  TRY(device->ops->elapsed(device->self, &seconds));
  overlap->kernel_s += seconds;
  return STATUS_OK;
}

// Starts the kernel of a stage.
static Status launch(const DeviceOverlap *overlap, int k, int count, DeviceQuantity quantity,
                     DeviceArgument *arguments, int n) {
  const Device *device = overlap->device;
  const DeviceKernel *kernel = &overlap->stages[k].kernels[quantity];
  if (!overlap->tpn.parameters.at) return device_launch(device, kernel, count, arguments, n);
  const bool has_gradient = quantity == DEVICE_GRADIENT;
  n += device_tpn_arguments(&overlap->tpn, has_gradient, arguments + n);
  return device->ops->launch(device->self, kernel, device_tpn_groups(has_gradient, count), arguments, n);
}

Status device_overlap_stage(DeviceOverlap *overlap, int k, int count, const DeviceMemory *list,
                            DeviceQuantity quantity, const DeviceOverlapAnswers *answers, int *left) {
  DeviceArgument arguments[DEVICE_MAX_ARGUMENTS];
  int n = device_overlap_pairs(overlap, count, list, arguments);
  arguments[n++] = device_memory(answers->volume);
  arguments[n++] = device_memory(answers->flags);
  arguments[n++] = device_memory(answers->doubtful);
  arguments[n++] = device_memory(answers->doubtful_count);
  if (quantity != DEVICE_VOLUME) arguments[n++] = device_memory(answers->more);
  TRY(device_overlap_reset(overlap, answers->doubtful_count));
  TRY(device_overlap_begin(overlap));
  TRY(launch(overlap, k, count, quantity, arguments, n));
  TRY(device_overlap_end(overlap));
  return device_overlap_count(overlap, answers->doubtful_count, left);
}

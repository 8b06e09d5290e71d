// SPDX-License-Identifier: Apache-2.0
#include "device/overlap/stage.h"

#include <string.h>

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

Status device_overlap_end_gate(DeviceOverlap *overlap) {
  const double before = overlap->kernel_s;
  TRY(device_overlap_end(overlap));
  overlap->gate_s += overlap->kernel_s - before;
  return STATUS_OK;
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
  TRY(device_launch(overlap->device, &overlap->stages[k].kernels[quantity], count, arguments, n));
  TRY(device_overlap_end(overlap));
  return device_overlap_count(overlap, answers->doubtful_count, left);
}

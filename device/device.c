// SPDX-License-Identifier: Apache-2.0
#include "device/device.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const DeviceOps *const implementations[] = {&device_cuda, &device_opencl, &device_host};
enum { IMPLEMENTATION_COUNT = sizeof implementations / sizeof *implementations };

const DeviceOps *const *device_list(int *count) {
  *count = IMPLEMENTATION_COUNT;
  return implementations;
}

// The first usable device, a GPU if that is asked, or the one of that index; NULL: there is none, and
// `reason` says why.
static const DeviceInfo *choose(const DeviceOps *ops, int index, bool wants_gpu,
                                DeviceInfo infos[DEVICE_MAX_FOUND], char reason[DEVICE_TEXT]) {
  int count = ops->find(infos, reason);
  for (int i = 0; i < count; i++) {
    if (index >= 0 && infos[i].index != index) continue;
    if (infos[i].reason[0])
      memcpy(reason, infos[i].reason, DEVICE_TEXT);
    else if (!wants_gpu || infos[i].is_gpu)
      return &infos[i];
    else
      strcpy(reason, "no GPU among its devices");
  }
  if (count > 0 && !reason[0]) strcpy(reason, "there is none of that number");
  return NULL;
}

static Status open_chosen(Device *device, const DeviceOps *ops, const DeviceInfo *info) {
  *device = (Device){.ops = ops, .info = *info};
  return ops->open(info, &device->self);
}

static Status open_auto(Device *device) {
  DeviceInfo infos[DEVICE_MAX_FOUND];
  char reason[IMPLEMENTATION_COUNT][DEVICE_TEXT] = {{0}};
  for (int k = 0; k < IMPLEMENTATION_COUNT; k++) {
    if (implementations[k] == &device_host) continue;
    const DeviceInfo *info = choose(implementations[k], -1, true, infos, reason[k]);
    if (info) return open_chosen(device, implementations[k], info);
  }
  return status_fail(STATUS_DEVICE, "no GPU: cuda: %s; opencl: %s (see `tetlap devices`)", reason[0],
                     reason[1]);
}

// "opencl:1" is opencl and 1; without a number −1.
static bool parse(const char *name, const DeviceOps **ops, int *index) {
  const char *colon = strchr(name, ':');
  size_t length = colon ? (size_t)(colon - name) : strlen(name);
  char *end = NULL;
  long number = colon ? strtol(colon + 1, &end, 10) : -1;
  if (colon && (end == colon + 1 || *end || number < 0 || number > INT16_MAX)) return false;
  *index = (int)number;
  for (int k = 0; k < IMPLEMENTATION_COUNT; k++) {
    *ops = implementations[k];
    if (strlen((*ops)->name) == length && strncmp((*ops)->name, name, length) == 0) return true;
  }
  return false;
}

Status device_open(Device *device, const char *name) {
  *device = (Device){0};
  const DeviceOps *ops;
  int index;
  if (strcmp(name, "auto") == 0) return open_auto(device);
  if (!parse(name, &ops, &index))
    return status_fail(STATUS_USAGE,
                       "no device '%s': it must be host, opencl, cuda or auto, or with a number (opencl:1)",
                       name);
  DeviceInfo infos[DEVICE_MAX_FOUND];
  char reason[DEVICE_TEXT] = "";
  const DeviceInfo *info = choose(ops, index, false, infos, reason);
  if (!info) return status_fail(STATUS_DEVICE, "device '%s': %s (see `tetlap devices`)", name, reason);
  return open_chosen(device, ops, info);
}

void device_close(Device *device) {
  if (device->self) device->ops->close(device->self);
  *device = (Device){0};
}

Status device_take(const Device *device, size_t count, size_t size, const void *from, DeviceMemory *memory) {
  *memory = (DeviceMemory){0};
  if (size > 0 && count > SIZE_MAX / size) return status_no_memory("an array on the device");
  TRY(device->ops->take(device->self, count * size, memory));
  return from ? device->ops->put(device->self, memory, 0, count * size, from) : STATUS_OK;
}

Status device_build(const Device *device, const DeviceProgram *program, void **module,
                    DeviceKernel kernels[DEVICE_MAX_KERNELS]) {
  *module = NULL;
  TRY(device->ops->build(device->self, program, module));
  for (int k = 0; k < DEVICE_MAX_KERNELS && program->kernels[k]; k++) {
    TRY(device->ops->kernel(device->self, *module, program->kernels[k], &kernels[k]));
    kernels[k].items = program->items;
  }
  return STATUS_OK;
}

Status device_launch(const Device *device, const DeviceKernel *kernel, int count,
                     const DeviceArgument *arguments, int argument_count) {
  int groups = count / kernel->items + (count % kernel->items > 0);
  return groups > 0 ? device->ops->launch(device->self, kernel, groups, arguments, argument_count)
                    : STATUS_OK;
}

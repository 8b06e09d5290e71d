// SPDX-License-Identifier: Apache-2.0
#include "device/host/kernel.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "base/machine/clock.h"
#include "base/memory.h"

typedef struct Host {
  double marks[DEVICE_MARK_COUNT]; // [s]
} Host;

static int find(DeviceInfo *infos, char reason[DEVICE_TEXT]) {
  reason[0] = 0;
  infos[0] = (DeviceInfo){.units = omp_get_max_threads()};
  snprintf(infos[0].name, DEVICE_TEXT, "this processor");
  snprintf(infos[0].driver, DEVICE_TEXT, "part of the program");
  return 1;
}

static Status open(const DeviceInfo *info, void **self) {
  (void)info;
  *self = memory_zeroed(1, sizeof(Host));
  return *self ? STATUS_OK : status_no_memory("device 'host'");
}

static void close(void *self) {
  memory_free(self);
}

// A module is the program's list of kernels.
static Status build(void *self, const DeviceProgram *program, void **module) {
  (void)self;
  const struct {
    const DeviceProgram *program;
    const DeviceHostKernel *kernels;
  } known[] = {
      {&device_program_clip, device_host_clip},     {&device_program_clip32, device_host_clip32},
      {&device_program_gather, device_host_gather}, {&device_program_poses, device_host_poses},
      {&device_program_tpn, device_host_tpn},       {&device_program_tpn_bf16, device_host_tpn_bf16},
      {&device_program_scalar, device_host_scalar}, {&device_program_geo_small, device_host_geo_small},
      {&device_program_geo, device_host_geo},       {&device_program_peak, device_host_peak}};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    if (known[k].program == program) {
      *module = (void *)(size_t)known[k].kernels;
      return STATUS_OK;
    }
  return status_fail(STATUS_DEVICE, "device 'host': there is no program '%s'", program->name);
}

static void discard(void *self, void *module) {
  (void)self, (void)module;
}

static Status kernel(void *self, void *module, const char *name, DeviceKernel *found) {
  (void)self;
  for (const DeviceHostKernel *k = module; k->name; k++)
    if (strcmp(k->name, name) == 0) {
      *found = (DeviceKernel){.at = (void *)(size_t)k, .name = k->name};
      return STATUS_OK;
    }
  return status_fail(STATUS_DEVICE, "device 'host': there is no kernel '%s'", name);
}

static Status take(void *self, size_t bytes, DeviceMemory *memory) {
  (void)self;
  *memory = (DeviceMemory){.at = memory_zeroed(bytes, 1), .bytes = bytes};
  if (memory->at) return STATUS_OK;
  *memory = (DeviceMemory){0};
  return status_fail(STATUS_MEMORY, "device 'host': no memory for %zu bytes", bytes);
}

static void release(void *self, DeviceMemory *memory) {
  (void)self;
  memory_free(memory->at);
  *memory = (DeviceMemory){0};
}

static Status put(void *self, const DeviceMemory *to, size_t at, size_t bytes, const void *from) {
  (void)self;
  memcpy((char *)to->at + at, from, bytes);
  return STATUS_OK;
}

static Status get(void *self, const DeviceMemory *from, size_t at, size_t bytes, void *to) {
  (void)self;
  memcpy(to, (const char *)from->at + at, bytes);
  return STATUS_OK;
}

static Status launch(void *self, const DeviceKernel *kernel, int groups, const DeviceArgument *arguments,
                     int count) {
  (void)self, (void)count;
  const DeviceHostKernel *found = kernel->at;
#pragma omp parallel for schedule(dynamic) if (groups > 8)
  for (int group = 0; group < groups; group++) found->run(group, arguments);
  return STATUS_OK;
}

static Status wait(void *self) {
  (void)self;
  return STATUS_OK;
}

static Status mark(void *self, DeviceMark which) {
  ((Host *)self)->marks[which] = clock_wall_s();
  return STATUS_OK;
}

static Status elapsed(void *self, double *seconds) {
  const Host *host = self;
  *seconds = host->marks[DEVICE_END] - host->marks[DEVICE_BEGIN];
  return STATUS_OK;
}

const DeviceOps device_host = {
    .name = "host",
    .help = "kernels as plain C on this processor: the referee",
    .looked_for = "nothing: part of the program",
    .find = find,
    .open = open,
    .close = close,
    .build = build,
    .discard = discard,
    .kernel = kernel,
    .take = take,
    .release = release,
    .put = put,
    .get = get,
    .launch = launch,
    .wait = wait,
    .mark = mark,
    .elapsed = elapsed,
};

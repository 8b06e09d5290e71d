// SPDX-License-Identifier: GPL-3.0-or-later
// A driver for tests in place of libcuda.so.1: one device that takes everything and computes nothing, but for
// what FAKE_CUDA tells it to refuse: start, device, old, memory, load, launch or lost (a launch is taken,
// what waits for it fails; with FAKE_AFTER=N, of the launch after so many). What is still there when the
// device is given back is told on standard error.
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OUT_OF_MEMORY = 2, NOT_INITIALIZED = 3, INVALID_IMAGE = 200, LAUNCH_FAILED = 719, TOO_MUCH = 701 };

static int is_told(const char *what) {
  const char *told = getenv("FAKE_CUDA");
  return told && strcmp(told, what) == 0;
}

static int is_lost, launches, memories, modules, events;

int cuInit(unsigned flags);
int cuInit(unsigned flags) {
  (void)flags;
  return is_told("start") ? NOT_INITIALIZED : 0;
}

#define FUNCTION(name, ...)                                                                                  \
  int name(__VA_ARGS__);                                                                                     \
  int name(__VA_ARGS__)

FUNCTION(cuDriverGetVersion, int *version) {
  *version = 13000;
  return 0;
}
FUNCTION(cuDeviceGetCount, int *count) {
  *count = !is_told("device");
  return 0;
}
FUNCTION(cuDeviceGet, int *device, int index) {
  *device = index;
  return 0;
}
FUNCTION(cuDeviceGetName, char *name, int size, int device) {
  (void)device;
  strncpy(name, "a device of tests", (size_t)size);
  return 0;
}
FUNCTION(cuDeviceTotalMem_v2, size_t *bytes, int device) {
  (void)device;
  *bytes = (size_t)1 << 30;
  return 0;
}
FUNCTION(cuDeviceGetAttribute, int *value, int which, int device) {
  (void)device;
  *value = which == 75 ? (is_told("old") ? 5 : 9) : which == 76 ? 0 : which == 13 ? 1000000 : 1;
  return 0;
}
FUNCTION(cuDevicePrimaryCtxRetain, void **context, int device) {
  (void)device;
  *context = &is_lost;
  return 0;
}
FUNCTION(cuDevicePrimaryCtxRelease_v2, int device) {
  (void)device;
  if (memories || modules || events)
    fprintf(stderr, "fake driver: %d memories, %d modules, %d events are kept\n", memories, modules, events);
  return 0;
}
FUNCTION(cuCtxSetCurrent, void *context) {
  (void)context;
  return 0;
}
FUNCTION(cuModuleLoadData, void **module, const void *code) {
  *module = &is_lost;
  // what NVRTC makes is an ELF file
  if (is_told("load") || memcmp(code, "\177ELF", 4) != 0) return INVALID_IMAGE;
  modules++;
  return 0;
}
FUNCTION(cuModuleUnload, void *module) {
  (void)module;
  modules--;
  return 0;
}
FUNCTION(cuModuleGetFunction, void **function, void *module, const char *name) {
  (void)module, (void)name;
  *function = &is_lost;
  return 0;
}
FUNCTION(cuMemAlloc_v2, uint64_t *address, size_t bytes) {
  if (is_told("memory") && bytes > 1000) return OUT_OF_MEMORY;
  *address = (uint64_t)(uintptr_t)calloc(bytes, 1);
  memories++;
  return 0;
}
FUNCTION(cuMemFree_v2, uint64_t address) {
  memories--;
  free((void *)(uintptr_t)address);
  return 0;
}
FUNCTION(cuMemcpyHtoD_v2, uint64_t to, const void *from, size_t bytes) {
  memcpy((void *)(uintptr_t)to, from, bytes);
  return is_lost ? LAUNCH_FAILED : 0;
}
FUNCTION(cuMemcpyDtoH_v2, void *to, uint64_t from, size_t bytes) {
  memcpy(to, (const void *)(uintptr_t)from, bytes);
  return is_lost ? LAUNCH_FAILED : 0;
}
FUNCTION(cuLaunchKernel, void *function, unsigned gx, unsigned gy, unsigned gz, unsigned bx, unsigned by,
         unsigned bz, unsigned shared, void *stream, void **parameters, void **extra) {
  (void)function, (void)gx, (void)gy, (void)gz, (void)bx, (void)by, (void)bz, (void)shared;
  (void)stream, (void)parameters, (void)extra;
  const char *after = getenv("FAKE_AFTER");
  is_lost = is_told("lost") && launches++ >= (after ? atoi(after) : 0);
  return is_told("launch") ? TOO_MUCH : 0;
}
FUNCTION(cuCtxSynchronize, void) {
  return is_lost ? LAUNCH_FAILED : 0;
}
FUNCTION(cuEventCreate, void **event, unsigned flags) {
  (void)flags;
  *event = &is_lost;
  events++;
  return 0;
}
FUNCTION(cuEventRecord, void *event, void *stream) {
  (void)event, (void)stream;
  return 0;
}
FUNCTION(cuEventSynchronize, void *event) {
  (void)event;
  return is_lost ? LAUNCH_FAILED : 0;
}
FUNCTION(cuEventElapsedTime, float *milliseconds, void *begin, void *end) {
  (void)begin, (void)end;
  *milliseconds = 1;
  return 0;
}
FUNCTION(cuEventDestroy_v2, void *event) {
  (void)event;
  events--;
  return 0;
}
FUNCTION(cuGetErrorName, int code, const char **name) {
  *name = code == OUT_OF_MEMORY     ? "CUDA_ERROR_OUT_OF_MEMORY"
          : code == NOT_INITIALIZED ? "CUDA_ERROR_NOT_INITIALIZED"
          : code == INVALID_IMAGE   ? "CUDA_ERROR_INVALID_IMAGE"
          : code == TOO_MUCH        ? "CUDA_ERROR_LAUNCH_OUT_OF_RESOURCES"
                                    : "CUDA_ERROR_LAUNCH_FAILED";
  return 0;
}

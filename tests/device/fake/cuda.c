// SPDX-License-Identifier: GPL-3.0-or-later
// A driver for tests in place of libcuda.so.1: one device, which runs what the compiler of tests
// (nvrtc.c) made as plain C. FAKE_CUDA=device: there is none; FAKE_CUDA=old: one too old. Which call
// fails: faults.h.
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "faults.h"
#include "kernels.h"

enum { INVALID_VALUE = 1, INVALID_IMAGE = 200, NOT_FOUND = 500 };
enum { MOST_KERNELS = 16, MOST_FILLED = 1 << 16 }; // bytes of memory whose content is made strange

typedef struct Module {
  char *text; // owned
  const DeviceProgram *known;
  FakeKernel kernels[MOST_KERNELS]; // (kernel_count)
  int kernel_count;
} Module;

typedef struct Memory {
  uint64_t address; // owned
  size_t bytes;
  struct Memory *next; // of all
} Memory;

static Memory *memories;
static int context, event;

static int is_told(const char *what) {
  const char *told = getenv("FAKE_CUDA");
  return told && strcmp(told, what) == 0;
}

static int give_back(const char *function) {
  fake_keep(-1);
  return fake_ask(function);
}

FAKE(int, cuInit, unsigned flags) {
  (void)flags;
  FAKE_ASK;
  return 0;
}

FAKE(int, cuDriverGetVersion, int *version) {
  FAKE_ASK;
  *version = 13000;
  return 0;
}

FAKE(int, cuDeviceGetCount, int *count) {
  FAKE_ASK;
  *count = !is_told("device");
  return 0;
}

FAKE(int, cuDeviceGet, int *device, int index) {
  FAKE_ASK;
  *device = index;
  return 0;
}

FAKE(int, cuDeviceGetName, char *name, int size, int device) {
  (void)device;
  FAKE_ASK;
  strncpy(name, "a device of tests", (size_t)size);
  return 0;
}

FAKE(int, cuDeviceTotalMem_v2, size_t *bytes, int device) {
  (void)device;
  FAKE_ASK;
  *bytes = (size_t)1 << 30;
  return 0;
}

FAKE(int, cuDeviceGetAttribute, int *value, int which, int device) {
  (void)device;
  FAKE_ASK;
  *value = which == 75 ? (is_told("old") ? 5 : 9) : which == 76 ? 0 : which == 13 ? 1000000 : 1;
  return 0;
}

FAKE(int, cuDevicePrimaryCtxRetain, void **retained, int device) {
  (void)device;
  FAKE_ASK;
  *retained = &context;
  fake_keep(1);
  return 0;
}

FAKE(int, cuDevicePrimaryCtxRelease_v2, int device) {
  (void)device;
  return give_back(__func__);
}

FAKE(int, cuCtxSetCurrent, void *which) {
  (void)which;
  FAKE_ASK;
  return 0;
}

// What NVRTC makes is an ELF file; that of tests, a program's text behind its first four letters.
FAKE(int, cuModuleLoadData, void **module, const void *code) {
  FAKE_ASK;
  if (memcmp(code, "\177ELF", 4) != 0) return INVALID_IMAGE;
  const char *text = (const char *)code + 4;
  const DeviceProgram *known = fake_kernels_program(text, DEVICE_CUDA_CPP);
  if (!known) return INVALID_IMAGE;
  Module *made = calloc(1, sizeof *made);
  made->text = calloc(strlen(text) + 1, 1);
  strcpy(made->text, text);
  made->known = known;
  *module = made;
  fake_keep(1);
  return 0;
}

FAKE(int, cuModuleUnload, void *which) {
  Module *module = which;
  free(module->text), free(module);
  return give_back(__func__);
}

FAKE(int, cuModuleGetFunction, void **function, void *of, const char *name) {
  Module *module = of;
  FAKE_ASK;
  if (module->kernel_count == MOST_KERNELS) abort();
  FakeKernel *kernel = &module->kernels[module->kernel_count];
  if (!fake_kernels_find(module->known, module->text, name, kernel)) return NOT_FOUND;
  module->kernel_count++;
  *function = kernel;
  return 0;
}

FAKE(int, cuMemAlloc_v2, uint64_t *address, size_t bytes) {
  FAKE_ASK;
  if (bytes == 0) return INVALID_VALUE;
  void *at = malloc(bytes);
  memset(at, 0x55, bytes < MOST_FILLED ? bytes : MOST_FILLED); // nobody says that it is 0
  Memory *memory = calloc(1, sizeof *memory);
  *memory = (Memory){.address = (uint64_t)(uintptr_t)at, .bytes = bytes, .next = memories};
  memories = memory;
  *address = memory->address;
  fake_keep(1);
  return 0;
}

FAKE(int, cuMemFree_v2, uint64_t address) {
  Memory **at = &memories;
  while (*at && (*at)->address != address) at = &(*at)->next;
  if (!*at) abort();
  Memory *memory = *at;
  *at = memory->next;
  free((void *)(uintptr_t)address), free(memory);
  return give_back(__func__);
}

static int is_within(uint64_t address, size_t bytes) {
  for (const Memory *memory = memories; memory; memory = memory->next)
    if (address >= memory->address && address - memory->address <= memory->bytes &&
        bytes <= memory->bytes - (address - memory->address))
      return 1;
  return 0;
}

FAKE(int, cuMemcpyHtoD_v2, uint64_t to, const void *from, size_t bytes) {
  FAKE_ASK;
  if (!is_within(to, bytes)) return INVALID_VALUE;
  memcpy((void *)(uintptr_t)to, from, bytes);
  return 0;
}

FAKE(int, cuMemcpyDtoH_v2, void *to, uint64_t from, size_t bytes) {
  FAKE_ASK;
  if (!is_within(from, bytes)) return INVALID_VALUE;
  memcpy(to, (const void *)(uintptr_t)from, bytes);
  return 0;
}

FAKE(int, cuLaunchKernel, void *function, unsigned gx, unsigned gy, unsigned gz, unsigned bx, unsigned by,
     unsigned bz, unsigned shared, void *stream, void **parameters, void **extra) {
  const FakeKernel *kernel = function;
  DeviceArgument arguments[DEVICE_MAX_ARGUMENTS];
  DeviceMemory given[DEVICE_MAX_ARGUMENTS];
  FAKE_ASK;
  if (gx == 0 || gy != 1 || gz != 1 || bx != (unsigned)kernel->host.items || by != 1 || bz != 1 || shared ||
      stream || extra)
    return INVALID_VALUE;
  for (int k = 0; k < kernel->argument_count; k++) {
    uint64_t address = 0;
    arguments[k] = (DeviceArgument){.kind = kernel->kinds[k], .memory = &given[k]};
    if (kernel->kinds[k] == DEVICE_MEMORY) memcpy(&address, parameters[k], sizeof address);
    if (kernel->kinds[k] == DEVICE_INT) memcpy(&arguments[k].integer, parameters[k], sizeof(int));
    if (kernel->kinds[k] == DEVICE_DOUBLE) memcpy(&arguments[k].number, parameters[k], sizeof(double));
    if (address && !is_within(address, 1)) return INVALID_VALUE;
    given[k] = (DeviceMemory){.at = (void *)(uintptr_t)address};
  }
  fake_kernels_run(kernel, (int)gx, arguments);
  return 0;
}

FAKE(int, cuCtxSynchronize, void) {
  FAKE_ASK;
  return 0;
}

FAKE(int, cuEventCreate, void **made, unsigned flags) {
  (void)flags;
  FAKE_ASK;
  *made = &event;
  fake_keep(1);
  return 0;
}

FAKE(int, cuEventRecord, void *which, void *stream) {
  (void)which, (void)stream;
  FAKE_ASK;
  return 0;
}

FAKE(int, cuEventSynchronize, void *which) {
  (void)which;
  FAKE_ASK;
  return 0;
}

FAKE(int, cuEventElapsedTime, float *milliseconds, void *begin, void *end) {
  (void)begin, (void)end;
  FAKE_ASK;
  *milliseconds = 1;
  return 0;
}

FAKE(int, cuEventDestroy_v2, void *which) {
  (void)which;
  return give_back(__func__);
}

FAKE(int, cuGetErrorName, int code, const char **name) {
  static const struct {
    int code;
    const char *name;
  } names[] = {{1, "CUDA_ERROR_INVALID_VALUE"},   {2, "CUDA_ERROR_OUT_OF_MEMORY"},
               {3, "CUDA_ERROR_NOT_INITIALIZED"}, {200, "CUDA_ERROR_INVALID_IMAGE"},
               {500, "CUDA_ERROR_NOT_FOUND"},     {701, "CUDA_ERROR_LAUNCH_OUT_OF_RESOURCES"},
               {719, "CUDA_ERROR_LAUNCH_FAILED"}};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    if (names[k].code == code) {
      *name = names[k].name;
      return 0;
    }
  return INVALID_VALUE;
}

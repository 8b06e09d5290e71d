// SPDX-License-Identifier: Apache-2.0
// CUDA by its driver's interface and NVRTC (NVIDIA, CUDA Driver API and NVRTC reference manuals, 12 and 13;
// the numbers are those of cuda.h).
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "device/backend/cache.h"
#include "device/backend/cuda.h"
#include "device/backend/library.h"
#include "device/device.h"

typedef struct Context *ContextId;
typedef struct Module *ModuleId;
typedef struct Function *FunctionId;
typedef struct Event *EventId;
typedef struct Stream *StreamId;
typedef uint64_t Address;

enum {
  SUCCESS = 0,
  OUT_OF_MEMORY = 2,
  ATTRIBUTE_CLOCK = 13, // [kHz]
  ATTRIBUTE_UNITS = 16,
  ATTRIBUTE_MAJOR = 75,
  ATTRIBUTE_MINOR = 76,
  LEAST_MAJOR = 7, // what kernels/ are tested to compile for begins at 8.0; 7.0 has all they use
};

static struct {
  int (*init)(unsigned);
  int (*driver_version)(int *);
  int (*count)(int *);
  int (*get)(int *, int);
  int (*name)(char *, int, int);
  int (*total_memory)(size_t *, int);
  int (*attribute)(int *, int, int);
  int (*retain)(ContextId *, int);
  int (*release)(int);
  int (*set_current)(ContextId);
  int (*load)(ModuleId *, const void *);
  int (*unload)(ModuleId);
  int (*function)(FunctionId *, ModuleId, const char *);
  int (*take)(Address *, size_t);
  int (*free)(Address);
  int (*put)(Address, const void *, size_t);
  int (*fetch)(void *, Address, size_t);
  int (*launch)(FunctionId, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, StreamId,
                void **, void **);
  int (*synchronize)(void);
  int (*event)(EventId *, unsigned);
  int (*record)(EventId, StreamId);
  int (*event_wait)(EventId);
  int (*event_elapsed)(float *, EventId, EventId);
  int (*event_destroy)(EventId);
  int (*error_name)(int, const char **);
} cu;

static const DeviceSymbol symbols[] = {
    {"cuInit", &cu.init},
    {"cuDriverGetVersion", &cu.driver_version},
    {"cuDeviceGetCount", &cu.count},
    {"cuDeviceGet", &cu.get},
    {"cuDeviceGetName", &cu.name},
    {"cuDeviceTotalMem_v2", &cu.total_memory},
    {"cuDeviceGetAttribute", &cu.attribute},
    {"cuDevicePrimaryCtxRetain", &cu.retain},
    {"cuDevicePrimaryCtxRelease_v2", &cu.release},
    {"cuCtxSetCurrent", &cu.set_current},
    {"cuModuleLoadData", &cu.load},
    {"cuModuleUnload", &cu.unload},
    {"cuModuleGetFunction", &cu.function},
    {"cuMemAlloc_v2", &cu.take},
    {"cuMemFree_v2", &cu.free},
    {"cuMemcpyHtoD_v2", &cu.put},
    {"cuMemcpyDtoH_v2", &cu.fetch},
    {"cuLaunchKernel", &cu.launch},
    {"cuCtxSynchronize", &cu.synchronize},
    {"cuEventCreate", &cu.event},
    {"cuEventRecord", &cu.record},
    {"cuEventSynchronize", &cu.event_wait},
    {"cuEventElapsedTime", &cu.event_elapsed},
    {"cuEventDestroy_v2", &cu.event_destroy},
    {"cuGetErrorName", &cu.error_name},
};

static pthread_once_t once = PTHREAD_ONCE_INIT;
static void *library;
static char library_reason[DEVICE_TEXT];

static const char *name_of(int code) {
  const char *name = NULL;
  return cu.error_name(code, &name) == SUCCESS && name ? name : "an unknown error";
}

static void load_library(void) {
  static const char *const names[] = {"libcuda.so.1", NULL};
  library =
      device_library_open("TETLAP_CUDA", names, symbols, sizeof symbols / sizeof *symbols, library_reason);
  if (!library) return;
  int code = cu.init(0);
  if (code == SUCCESS) return;
  snprintf(library_reason, DEVICE_TEXT, "the driver does not start: %s", name_of(code));
  library = NULL;
}

// 0 where it fails, which `code` keeps.
static int attribute(int device, int which, int *code) {
  int value = 0;
  const int failure = cu.attribute(&value, which, device);
  if (failure != SUCCESS) *code = failure;
  return failure == SUCCESS ? value : 0;
}

// Fused multiply-adds of a multiprocessor in a cycle: CUDA C++ Programming Guide, "Arithmetic instructions";
// of dense matrices in bf16 from the makers' figures for the A100 and the H100 (312 and 989 Tflop/s). Others
// are not known here.
// Instructions: from 7.0 on a multiprocessor has four schedulers, each of which issues one instruction of a
// warp, 32 items, in a cycle (the Guide, "Compute capabilities", 7.x to 9.0).
static void find_peak(int major, int minor, DeviceInfo *info) {
  static const struct {
    int capability;
    double fused[DEVICE_ARITHMETIC_COUNT];
  } known[] = {{70, {64, 32, 0}}, {75, {64, 2, 0}},  {80, {64, 32, 1024}},
               {86, {128, 2, 0}}, {89, {128, 2, 0}}, {90, {128, 64, 2048}}};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    if (known[k].capability == 10 * major + minor) {
      const double cycles = info->units * 1e6 * info->clock_mhz;
      for (int a = 0; a < DEVICE_ARITHMETIC_COUNT; a++) info->peak[a] = 2 * known[k].fused[a] * cycles;
      info->issue = 4 * 32 * cycles;
    }
}

static void describe(int index, DeviceInfo *info) {
  int device = 0, version = 0;
  size_t bytes = 0;
  char reason[DEVICE_TEXT];
  *info = (DeviceInfo){.index = index, .is_gpu = true};
  int code = cu.get(&device, index);
  if (code == SUCCESS) code = cu.name(info->name, sizeof info->name, device);
  if (code == SUCCESS) code = cu.total_memory(&bytes, device);
  if (code == SUCCESS) code = cu.driver_version(&version);
  int major = attribute(device, ATTRIBUTE_MAJOR, &code), minor = attribute(device, ATTRIBUTE_MINOR, &code);
  snprintf(info->driver, DEVICE_TEXT, "CUDA %d.%d, sm_%d%d", version / 1000, version % 1000 / 10, major,
           minor);
  info->memory_bytes = (double)bytes;
  info->units = attribute(device, ATTRIBUTE_UNITS, &code);
  info->clock_mhz = attribute(device, ATTRIBUTE_CLOCK, &code) / 1000;
  find_peak(major, minor, info);
  if (code != SUCCESS)
    snprintf(info->reason, DEVICE_TEXT, "its driver does not describe it: %s", name_of(code));
  else if (major < LEAST_MAJOR)
    snprintf(info->reason, DEVICE_TEXT, "it is of compute capability %d.%d, %d.0 is needed", major, minor,
             LEAST_MAJOR);
  else if (!device_cuda_compiler(reason))
    memcpy(info->reason, reason, DEVICE_TEXT);
}

static int find(DeviceInfo *infos, char reason[DEVICE_TEXT]) {
  int count = 0;
  reason[0] = 0;
  pthread_once(&once, load_library);
  if (!library) {
    memcpy(reason, library_reason, DEVICE_TEXT);
    return 0;
  }
  const int code = cu.count(&count);
  if (code != SUCCESS) count = 0;
  if (count > DEVICE_MAX_FOUND) count = DEVICE_MAX_FOUND;
  for (int i = 0; i < count; i++) describe(i, &infos[i]);
  if (code != SUCCESS)
    snprintf(reason, DEVICE_TEXT, "the driver does not count its devices: %s", name_of(code));
  else if (count == 0)
    snprintf(reason, DEVICE_TEXT, "the driver is there, but no device");
  return count;
}

typedef struct Cuda {
  DeviceInfo info;
  int device, major, minor;
  ContextId context; // retained
  EventId marks[DEVICE_MARK_COUNT];
} Cuda;

static Status fail(const Cuda *cuda, int code, const char *what) {
  return status_fail(code == OUT_OF_MEMORY ? STATUS_MEMORY : STATUS_DEVICE,
                     "device 'cuda:%d' (%s): %s: error %d, %s", cuda->info.index, cuda->info.name, what, code,
                     name_of(code));
}

static void close(void *self) {
  Cuda *cuda = self;
  for (int k = 0; k < DEVICE_MARK_COUNT; k++)
    if (cuda->marks[k]) cu.event_destroy(cuda->marks[k]);
  if (cuda->context) cu.release(cuda->device);
  memory_free(cuda);
}

static Status begin(Cuda *cuda) {
  int code = cu.get(&cuda->device, cuda->info.index);
  if (code == SUCCESS) code = cu.retain(&cuda->context, cuda->device);
  if (code == SUCCESS) code = cu.set_current(cuda->context);
  for (int k = 0; k < DEVICE_MARK_COUNT && code == SUCCESS; k++) code = cu.event(&cuda->marks[k], 0);
  if (code == SUCCESS) cuda->major = attribute(cuda->device, ATTRIBUTE_MAJOR, &code);
  if (code == SUCCESS) cuda->minor = attribute(cuda->device, ATTRIBUTE_MINOR, &code);
  return code == SUCCESS ? STATUS_OK : fail(cuda, code, "opening it");
}

static Status open(const DeviceInfo *info, void **self) {
  Cuda *cuda = memory_zeroed(1, sizeof *cuda);
  if (!cuda) return status_no_memory("a CUDA device");
  cuda->info = *info;
  Status status = begin(cuda);
  if (status == STATUS_OK)
    *self = cuda;
  else
    close(cuda);
  return status;
}

static Status build(void *self, const DeviceProgram *program, void **module) {
  Cuda *cuda = self;
  char target[32], *code = NULL, *text = NULL;
  size_t size;
  snprintf(target, sizeof target, "sm_%d%d", cuda->major, cuda->minor);
  TRY(device_source_text(program, DEVICE_CUDA_CPP, &text));
  uint64_t key =
      device_cache_key(5, (const char *[]){text, target, cuda->info.name, cuda->info.driver, "cubin"});
  memory_free(text);
  if (!device_cache_read(key, &code, &size)) {
    TRY(device_cuda_compile(program, target, false, &code, &size, NULL));
    device_cache_write(key, code, size);
  }
  ModuleId loaded;
  int error = cu.load(&loaded, code);
  memory_free(code);
  if (error != SUCCESS) return fail(cuda, error, "loading a program");
  *module = loaded;
  return STATUS_OK;
}

static void discard(void *self, void *module) {
  (void)self;
  if (module) cu.unload(module);
}

static Status kernel(void *self, void *module, const char *name, DeviceKernel *found) {
  FunctionId function;
  int code = cu.function(&function, module, name);
  if (code != SUCCESS) return fail(self, code, name);
  *found = (DeviceKernel){.at = function, .name = name};
  return STATUS_OK;
}

static Status take(void *self, size_t bytes, DeviceMemory *memory) {
  Address address;
  char what[64];
  int code = cu.take(&address, bytes > 0 ? bytes : 1);
  snprintf(what, sizeof what, "taking %.4g GB", 1e-9 * (double)bytes);
  if (code != SUCCESS) return fail(self, code, what);
  *memory = (DeviceMemory){.at = (void *)(uintptr_t)address, .bytes = bytes};
  return STATUS_OK;
}

static void release(void *self, DeviceMemory *memory) {
  (void)self;
  if (memory->at) cu.free((Address)(uintptr_t)memory->at);
  *memory = (DeviceMemory){0};
}

static Address address_of(const DeviceMemory *memory, size_t at) {
  return (Address)(uintptr_t)memory->at + at;
}

static Status put(void *self, const DeviceMemory *to, size_t at, size_t bytes, const void *from) {
  int code = bytes > 0 ? cu.put(address_of(to, at), from, bytes) : SUCCESS;
  return code == SUCCESS ? STATUS_OK : fail(self, code, "sending");
}

static Status get(void *self, const DeviceMemory *from, size_t at, size_t bytes, void *to) {
  int code = bytes > 0 ? cu.fetch(to, address_of(from, at), bytes) : SUCCESS;
  return code == SUCCESS ? STATUS_OK : fail(self, code, "fetching");
}

static Status launch(void *self, const DeviceKernel *kernel, int groups, const DeviceArgument *arguments,
                     int count) {
  Address addresses[DEVICE_MAX_ARGUMENTS];
  void *pointers[DEVICE_MAX_ARGUMENTS];
  int integers[DEVICE_MAX_ARGUMENTS];
  double numbers[DEVICE_MAX_ARGUMENTS];
  for (int k = 0; k < count; k++) {
    const DeviceArgument *argument = &arguments[k];
    addresses[k] = argument->kind == DEVICE_MEMORY ? address_of(argument->memory, 0) : 0;
    integers[k] = argument->integer;
    numbers[k] = argument->number;
    pointers[k] = argument->kind == DEVICE_MEMORY ? (void *)&addresses[k]
                  : argument->kind == DEVICE_INT  ? (void *)&integers[k]
                                                  : (void *)&numbers[k];
  }
  if (groups == 0) return STATUS_OK;
  int code =
      cu.launch(kernel->at, (unsigned)groups, 1, 1, (unsigned)kernel->items, 1, 1, 0, NULL, pointers, NULL);
  return code == SUCCESS ? STATUS_OK : fail(self, code, kernel->name);
}

static Status wait(void *self) {
  int code = cu.synchronize();
  return code == SUCCESS ? STATUS_OK : fail(self, code, "waiting");
}

static Status mark(void *self, DeviceMark which) {
  int code = cu.record(((Cuda *)self)->marks[which], NULL);
  return code == SUCCESS ? STATUS_OK : fail(self, code, "noting the time");
}

static Status elapsed(void *self, double *seconds) {
  const Cuda *cuda = self;
  float milliseconds = 0;
  int code = cu.event_wait(cuda->marks[DEVICE_END]);
  if (code == SUCCESS)
    code = cu.event_elapsed(&milliseconds, cuda->marks[DEVICE_BEGIN], cuda->marks[DEVICE_END]);
  if (code != SUCCESS) return fail(cuda, code, "reading the time");
  *seconds = 1e-3 * (double)milliseconds;
  return STATUS_OK;
}

const DeviceOps device_cuda = {
    .name = "cuda",
    .help = "NVIDIA GPUs: tensor cores, more memory a group",
    .looked_for = "libcuda.so.1 (or what TETLAP_CUDA names) and libnvrtc.so (or what TETLAP_NVRTC names)",
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

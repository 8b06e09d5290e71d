// SPDX-License-Identifier: Apache-2.0
// OpenCL 1.2 and later (Khronos, The OpenCL Specification; the numbers are those of its header cl.h).
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "device/backend/cache.h"
#include "device/backend/library.h"
#include "device/device.h"

typedef struct Platform *PlatformId;
typedef struct DeviceObject *DeviceId;
typedef struct Context *ContextId;
typedef struct Queue *QueueId;
typedef struct Program *ProgramId;
typedef struct Kernel *KernelId;
typedef struct Buffer *BufferId;

enum {
  SUCCESS = 0,
  DEVICE_NOT_FOUND = -1,
  MEM_OBJECT_ALLOCATION_FAILURE = -4,
  OUT_OF_RESOURCES = -5,
  OUT_OF_HOST_MEMORY = -6,
  BUILD_PROGRAM_FAILURE = -11,
  INVALID_VALUE = -30,
  INVALID_BUFFER_SIZE = -61,
  NO_PLATFORM = -1001,
  TYPE_GPU = 1 << 2,
  PROFILING = 0,
  READ_WRITE = 1 << 0,
  ROUNDS_DIVISIONS = 1 << 7, // of single precision, correctly
  CL_PLATFORM_NAME = 0x0902,
  CL_DEVICE_TYPE = 0x1000,
  CL_DEVICE_UNITS = 0x1002,
  CL_DEVICE_GROUP_SIZE = 0x1004,
  CL_DEVICE_CLOCK = 0x100C,
  CL_DEVICE_FLOAT = 0x101B,
  CL_DEVICE_GLOBAL_BYTES = 0x101F,
  CL_DEVICE_LOCAL_BYTES = 0x1023,
  CL_DEVICE_NAME = 0x102B,
  CL_DRIVER_VERSION = 0x102D,
  CL_DEVICE_DOUBLE = 0x1032,
  CL_PROGRAM_SIZES = 0x1165,
  CL_PROGRAM_BINARIES = 0x1166,
  CL_BUILD_LOG = 0x1183,
};
static const uint64_t TYPE_ALL = 0xFFFFFFFF;
enum { LEAST_LOCAL_BYTES = 48 << 10, LEAST_GROUP = 64 }; // what kernels/ want

static struct {
  int (*platforms)(unsigned, PlatformId *, unsigned *);
  int (*platform_info)(PlatformId, unsigned, size_t, void *, size_t *);
  int (*devices)(PlatformId, uint64_t, unsigned, DeviceId *, unsigned *);
  int (*device_info)(DeviceId, unsigned, size_t, void *, size_t *);
  ContextId (*create_context)(const intptr_t *, unsigned, const DeviceId *,
                              void (*)(const char *, const void *, size_t, void *), void *, int *);
  QueueId (*create_queue)(ContextId, DeviceId, uint64_t, int *);
  ProgramId (*create_program)(ContextId, unsigned, const char **, const size_t *, int *);
  ProgramId (*create_program_binary)(ContextId, unsigned, const DeviceId *, const size_t *,
                                     const unsigned char **, int *, int *);
  int (*build_program)(ProgramId, unsigned, const DeviceId *, const char *, void (*)(ProgramId, void *),
                       void *);
  int (*build_info)(ProgramId, DeviceId, unsigned, size_t, void *, size_t *);
  int (*program_info)(ProgramId, unsigned, size_t, void *, size_t *);
  KernelId (*create_kernel)(ProgramId, const char *, int *);
  BufferId (*create_buffer)(ContextId, uint64_t, size_t, void *, int *);
  int (*set_argument)(KernelId, unsigned, size_t, const void *);
  int (*enqueue_kernel)(QueueId, KernelId, unsigned, const size_t *, const size_t *, const size_t *, unsigned,
                        const void *, void *);
  int (*enqueue_write)(QueueId, BufferId, unsigned, size_t, size_t, const void *, unsigned, const void *,
                       void *);
  int (*enqueue_read)(QueueId, BufferId, unsigned, size_t, size_t, void *, unsigned, const void *, void *);
  int (*finish)(QueueId);
  int (*release_buffer)(BufferId);
  int (*release_kernel)(KernelId);
  int (*release_program)(ProgramId);
  int (*release_queue)(QueueId);
  int (*release_context)(ContextId);
} cl;

static const DeviceSymbol symbols[] = {
    {"clGetPlatformIDs", &cl.platforms},
    {"clGetPlatformInfo", &cl.platform_info},
    {"clGetDeviceIDs", &cl.devices},
    {"clGetDeviceInfo", &cl.device_info},
    {"clCreateContext", &cl.create_context},
    {"clCreateCommandQueue", &cl.create_queue},
    {"clCreateProgramWithSource", &cl.create_program},
    {"clCreateProgramWithBinary", &cl.create_program_binary},
    {"clBuildProgram", &cl.build_program},
    {"clGetProgramBuildInfo", &cl.build_info},
    {"clGetProgramInfo", &cl.program_info},
    {"clCreateKernel", &cl.create_kernel},
    {"clCreateBuffer", &cl.create_buffer},
    {"clSetKernelArg", &cl.set_argument},
    {"clEnqueueNDRangeKernel", &cl.enqueue_kernel},
    {"clEnqueueWriteBuffer", &cl.enqueue_write},
    {"clEnqueueReadBuffer", &cl.enqueue_read},
    {"clFinish", &cl.finish},
    {"clReleaseMemObject", &cl.release_buffer},
    {"clReleaseKernel", &cl.release_kernel},
    {"clReleaseProgram", &cl.release_program},
    {"clReleaseCommandQueue", &cl.release_queue},
    {"clReleaseContext", &cl.release_context},
};

static pthread_once_t once = PTHREAD_ONCE_INIT;
static void *library;
static char library_reason[DEVICE_TEXT];

static void load(void) {
  static const char *const names[] = {"libOpenCL.so.1", NULL};
  library =
      device_library_open("TETLAP_OPENCL", names, symbols, sizeof symbols / sizeof *symbols, library_reason);
}

typedef struct Word {
  int code;
  const char *text;
} Word;

static const char *word_of(int code) {
  static const Word words[] = {
      {-1, "device not found"},           {-2, "device not available"},
      {-4, "no memory for the object"},   {-5, "out of resources, or the device is lost"},
      {-6, "out of the host's memory"},   {-11, "the build failed"},
      {-14, "an earlier command failed"}, {-36, "invalid command queue"},
      {-46, "invalid kernel name"},       {-54, "invalid work-group size"},
      {-61, "invalid buffer size"}};
  for (size_t k = 0; k < sizeof words / sizeof *words; k++)
    if (words[k].code == code) return words[k].text;
  return "see cl.h";
}

// Every device of every platform, in their order. A platform without devices is passed over; what else fails
// is kept in `code`.
static int list(DeviceId devices[DEVICE_MAX_FOUND], PlatformId platforms[DEVICE_MAX_FOUND], int *code) {
  PlatformId found[DEVICE_MAX_FOUND];
  unsigned platform_count = 0;
  int count = 0;
  *code = cl.platforms(DEVICE_MAX_FOUND, found, &platform_count);
  if (*code != SUCCESS) platform_count = 0;
  for (unsigned p = 0; p < platform_count && p < DEVICE_MAX_FOUND && count < DEVICE_MAX_FOUND; p++) {
    unsigned device_count = 0, room = (unsigned)(DEVICE_MAX_FOUND - count);
    const int failure = cl.devices(found[p], TYPE_ALL, room, devices + count, &device_count);
    if (failure != SUCCESS && failure != DEVICE_NOT_FOUND) *code = failure;
    for (unsigned d = 0; d < device_count && d < room && failure == SUCCESS; d++)
      platforms[count++] = found[p];
  }
  return count;
}

// 0 where the driver does not know the question; if it fails otherwise, `code` keeps that.
static uint64_t number(DeviceId device, unsigned what, int *code) {
  uint64_t value = 0; // little-endian: 32 bits fit, too
  const int failure = cl.device_info(device, what, sizeof value, &value, NULL);
  if (failure != SUCCESS && failure != INVALID_VALUE) *code = failure;
  return failure == SUCCESS ? value : 0;
}

static int text(DeviceId device, unsigned what, size_t size, char *answer) {
  return cl.device_info(device, what, size, answer, NULL);
}

static void describe(DeviceId device, PlatformId platform, int index, DeviceInfo *info) {
  char platform_name[64] = "", driver[64] = "";
  *info = (DeviceInfo){.index = index};
  int code = text(device, CL_DEVICE_NAME, sizeof info->name, info->name);
  if (code == SUCCESS) code = text(device, CL_DRIVER_VERSION, sizeof driver, driver);
  if (code == SUCCESS)
    code = cl.platform_info(platform, CL_PLATFORM_NAME, sizeof platform_name, platform_name, NULL);
  snprintf(info->driver, DEVICE_TEXT, "%s, driver %s", platform_name, driver);
  info->memory_bytes = (double)number(device, CL_DEVICE_GLOBAL_BYTES, &code);
  info->units = (int)number(device, CL_DEVICE_UNITS, &code);
  info->clock_mhz = (int)number(device, CL_DEVICE_CLOCK, &code);
  info->is_gpu = (number(device, CL_DEVICE_TYPE, &code) & TYPE_GPU) != 0;
  const uint64_t has_double = number(device, CL_DEVICE_DOUBLE, &code),
                 local_bytes = number(device, CL_DEVICE_LOCAL_BYTES, &code),
                 group_size = number(device, CL_DEVICE_GROUP_SIZE, &code);
  if (code != SUCCESS)
    snprintf(info->reason, DEVICE_TEXT, "its driver does not describe it: error %d, %s", code, word_of(code));
  else if (has_double == 0)
    snprintf(info->reason, DEVICE_TEXT, "it has no double precision");
  else if (local_bytes < LEAST_LOCAL_BYTES)
    snprintf(info->reason, DEVICE_TEXT, "a group has %d KiB of memory, %d are needed",
             (int)(local_bytes >> 10), LEAST_LOCAL_BYTES >> 10);
  else if (group_size < LEAST_GROUP)
    snprintf(info->reason, DEVICE_TEXT, "a group has %d items, %d are needed", (int)group_size, LEAST_GROUP);
}

static int find(DeviceInfo *infos, char reason[DEVICE_TEXT]) {
  DeviceId devices[DEVICE_MAX_FOUND];
  PlatformId platforms[DEVICE_MAX_FOUND];
  int code;
  reason[0] = 0;
  pthread_once(&once, load);
  if (!library) {
    memcpy(reason, library_reason, DEVICE_TEXT);
    return 0;
  }
  int count = list(devices, platforms, &code);
  for (int i = 0; i < count; i++) describe(devices[i], platforms[i], i, &infos[i]);
  if (count == 0 && (code == SUCCESS || code == NO_PLATFORM))
    snprintf(reason, DEVICE_TEXT, "OpenCL is there, but no driver offers it a device");
  else if (count == 0)
    snprintf(reason, DEVICE_TEXT, "OpenCL is there, but lists no device: error %d, %s", code, word_of(code));
  return count;
}

// A program with its kernels.
typedef struct Built {
  ProgramId program;
  KernelId kernels[DEVICE_MAX_KERNELS]; // owned                  (kernel_count)
  int kernel_count;
} Built;

typedef struct OpenCl {
  DeviceInfo info;
  DeviceId device;
  ContextId context;
  QueueId queue;
  double marks[DEVICE_MARK_COUNT]; // [s]
} OpenCl;

static Status fail_as(Status status, const OpenCl *opencl, int code, const char *what) {
  return status_fail(status, "device 'opencl:%d' (%s): %s: error %d, %s", opencl->info.index,
                     opencl->info.name, what, code, word_of(code));
}

static Status fail(const OpenCl *opencl, int code, const char *what) {
  const bool is_memory = code == MEM_OBJECT_ALLOCATION_FAILURE || code == OUT_OF_HOST_MEMORY;
  return fail_as(is_memory ? STATUS_MEMORY : STATUS_DEVICE, opencl, code, what);
}

static void close(void *self) {
  OpenCl *opencl = self;
  if (opencl->queue) cl.finish(opencl->queue);
  if (opencl->queue) cl.release_queue(opencl->queue);
  if (opencl->context) cl.release_context(opencl->context);
  memory_free(opencl);
}

static Status begin(OpenCl *opencl) {
  DeviceId devices[DEVICE_MAX_FOUND];
  PlatformId platforms[DEVICE_MAX_FOUND];
  int code, count = list(devices, platforms, &code);
  if (opencl->info.index >= count)
    return fail(opencl, code != SUCCESS ? code : DEVICE_NOT_FOUND, "opening it");
  opencl->device = devices[opencl->info.index];
  opencl->context = cl.create_context(NULL, 1, &opencl->device, NULL, NULL, &code);
  if (code != SUCCESS) return fail(opencl, code, "making a context");
  opencl->queue = cl.create_queue(opencl->context, opencl->device, PROFILING, &code);
  return code == SUCCESS ? STATUS_OK : fail(opencl, code, "making a queue");
}

static Status open(const DeviceInfo *info, void **self) {
  OpenCl *opencl = memory_zeroed(1, sizeof *opencl);
  if (!opencl) return status_no_memory("an OpenCL device");
  opencl->info = *info;
  Status status = begin(opencl);
  if (status == STATUS_OK)
    *self = opencl;
  else
    close(opencl);
  return status;
}

// The log's first lines.
static Status fail_build(const OpenCl *opencl, ProgramId program, const DeviceProgram *what) {
  char log[1200] = "";
  char *whole;
  size_t size = 0;
  cl.build_info(program, opencl->device, CL_BUILD_LOG, 0, NULL, &size);
  if (size > 0 && (whole = memory_zeroed(size + 1, 1))) {
    cl.build_info(program, opencl->device, CL_BUILD_LOG, size, whole, NULL);
    snprintf(log, sizeof log, "%s", whole);
    memory_free(whole);
  }
  return status_fail(STATUS_DEVICE,
                     "device 'opencl:%d' (%s): the driver's compiler rejected program '%s': %s",
                     opencl->info.index, opencl->info.name, what->name, log[0] ? log : "no reason given");
}

static Status compile(OpenCl *opencl, const DeviceProgram *what, const char *text, const char *options,
                      ProgramId *program) {
  int code;
  *program = cl.create_program(opencl->context, 1, &text, NULL, &code);
  if (code != SUCCESS) return fail(opencl, code, "handing it a program");
  code = cl.build_program(*program, 1, &opencl->device, options, NULL, NULL);
  if (code == SUCCESS) return STATUS_OK;
  Status status = code == BUILD_PROGRAM_FAILURE ? fail_build(opencl, *program, what)
                                                : fail(opencl, code, "compiling a program");
  cl.release_program(*program);
  *program = NULL;
  return status;
}

// What the driver makes of code kept earlier; false: nothing.
static bool recall(OpenCl *opencl, uint64_t key, const char *options, ProgramId *program) {
  char *code;
  size_t size;
  int binary = SUCCESS, error = SUCCESS;
  if (!device_cache_read(key, &code, &size)) return false;
  const unsigned char *bytes = (const unsigned char *)code;
  *program = cl.create_program_binary(opencl->context, 1, &opencl->device, &size, &bytes, &binary, &error);
  memory_free(code);
  if (error != SUCCESS) return false;
  if (binary == SUCCESS && cl.build_program(*program, 1, &opencl->device, options, NULL, NULL) == SUCCESS)
    return true;
  cl.release_program(*program);
  *program = NULL;
  return false;
}

static void keep(ProgramId program, uint64_t key) {
  size_t size = 0;
  if (cl.program_info(program, CL_PROGRAM_SIZES, sizeof size, &size, NULL) != SUCCESS || size == 0) return;
  unsigned char *code = memory_zeroed(size, 1);
  if (code && cl.program_info(program, CL_PROGRAM_BINARIES, sizeof code, &code, NULL) == SUCCESS)
    device_cache_write(key, code, size);
  memory_free(code);
}

static void discard(void *self, void *module) {
  (void)self;
  Built *built = module;
  if (!built) return;
  for (int k = 0; k < built->kernel_count; k++) cl.release_kernel(built->kernels[k]);
  if (built->program) cl.release_program(built->program);
  memory_free(built);
}

static Status compile_or_recall(OpenCl *opencl, const DeviceProgram *what, const char *text, Built *built) {
  int code = SUCCESS;
  const bool rounds = (number(opencl->device, CL_DEVICE_FLOAT, &code) & ROUNDS_DIVISIONS) != 0;
  if (code != SUCCESS) return fail(opencl, code, "asking how it rounds");
  const char *options = rounds ? "-cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt" : "-cl-std=CL1.2";
  const uint64_t key =
      device_cache_key(4, (const char *[]){text, options, opencl->info.name, opencl->info.driver});
  if (recall(opencl, key, options, &built->program)) return STATUS_OK;
  built->program = NULL;
  TRY(compile(opencl, what, text, options, &built->program));
  keep(built->program, key);
  return STATUS_OK;
}

static Status build(void *self, const DeviceProgram *what, void **module) {
  char *text;
  Built *built = memory_zeroed(1, sizeof *built);
  if (!built) return status_no_memory("an OpenCL program");
  Status status = device_source_text(what, DEVICE_OPENCL_C, &text);
  if (status == STATUS_OK) {
    status = compile_or_recall(self, what, text, built);
    memory_free(text);
  }
  if (status == STATUS_OK)
    *module = built;
  else
    discard(self, built);
  return status;
}

static Status kernel(void *self, void *module, const char *name, DeviceKernel *found) {
  Built *built = module;
  int code;
  if (built->kernel_count == DEVICE_MAX_KERNELS)
    return status_fail(STATUS_DEVICE, "device 'opencl': a program has more than %d kernels",
                       DEVICE_MAX_KERNELS);
  KernelId made = cl.create_kernel(built->program, name, &code);
  if (code != SUCCESS) return fail(self, code, name);
  built->kernels[built->kernel_count++] = made;
  *found = (DeviceKernel){.at = made, .name = name};
  return STATUS_OK;
}

static Status take(void *self, size_t bytes, DeviceMemory *memory) {
  OpenCl *opencl = self;
  int code;
  char what[64];
  BufferId buffer = cl.create_buffer(opencl->context, READ_WRITE, bytes > 0 ? bytes : 1, NULL, &code);
  snprintf(what, sizeof what, "taking %.4g GB", 1e-9 * (double)bytes);
  // Elsewhere that code is what drivers call a device that they lost.
  const bool is_memory = code == OUT_OF_RESOURCES || code == INVALID_BUFFER_SIZE;
  if (is_memory) return fail_as(STATUS_MEMORY, opencl, code, what);
  if (code != SUCCESS) return fail(opencl, code, what);
  *memory = (DeviceMemory){.at = buffer, .bytes = bytes};
  return STATUS_OK;
}

static void release(void *self, DeviceMemory *memory) {
  (void)self;
  if (memory->at) cl.release_buffer(memory->at);
  *memory = (DeviceMemory){0};
}

static Status put(void *self, const DeviceMemory *to, size_t at, size_t bytes, const void *from) {
  OpenCl *opencl = self;
  if (bytes == 0) return STATUS_OK;
  int code = cl.enqueue_write(opencl->queue, to->at, true, at, bytes, from, 0, NULL, NULL);
  return code == SUCCESS ? STATUS_OK : fail(opencl, code, "sending");
}

static Status get(void *self, const DeviceMemory *from, size_t at, size_t bytes, void *to) {
  OpenCl *opencl = self;
  if (bytes == 0) return STATUS_OK;
  int code = cl.enqueue_read(opencl->queue, from->at, true, at, bytes, to, 0, NULL, NULL);
  return code == SUCCESS ? STATUS_OK : fail(opencl, code, "fetching");
}

static int set_argument(KernelId kernel, unsigned k, const DeviceArgument *argument) {
  switch (argument->kind) {
  case DEVICE_MEMORY:
    return cl.set_argument(kernel, k, sizeof(BufferId), &argument->memory->at);
  case DEVICE_INT:
    return cl.set_argument(kernel, k, sizeof(int), &argument->integer);
  default:
    return cl.set_argument(kernel, k, sizeof(double), &argument->number);
  }
}

static Status launch(void *self, const DeviceKernel *kernel, int groups, const DeviceArgument *arguments,
                     int count) {
  OpenCl *opencl = self;
  int code = SUCCESS;
  for (int k = 0; k < count && code == SUCCESS; k++)
    code = set_argument(kernel->at, (unsigned)k, &arguments[k]);
  const size_t items = (size_t)kernel->items, all = items * (size_t)groups;
  if (code == SUCCESS && groups > 0)
    code = cl.enqueue_kernel(opencl->queue, kernel->at, 1, NULL, &all, &items, 0, NULL, NULL);
  return code == SUCCESS ? STATUS_OK : fail(opencl, code, kernel->name);
}

static Status wait(void *self) {
  OpenCl *opencl = self;
  int code = cl.finish(opencl->queue);
  return code == SUCCESS ? STATUS_OK : fail(opencl, code, "waiting");
}

static Status mark(void *self, DeviceMark which) {
  TRY(wait(self));
  ((OpenCl *)self)->marks[which] = clock_wall_s();
  return STATUS_OK;
}

static Status elapsed(void *self, double *seconds) {
  const OpenCl *opencl = self;
  *seconds = opencl->marks[DEVICE_END] - opencl->marks[DEVICE_BEGIN];
  return STATUS_OK;
}

const DeviceOps device_opencl = {
    .name = "opencl",
    .help = "any GPU through its OpenCL driver; a processor through pocl",
    .looked_for = "libOpenCL.so.1 (or what TETLAP_OPENCL names), and drivers in /etc/OpenCL/vendors or "
                  "OCL_ICD_VENDORS",
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

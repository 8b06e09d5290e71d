// SPDX-License-Identifier: GPL-3.0-or-later
// An OpenCL for tests in place of libOpenCL.so.1: one device, which calls itself a GPU and runs kernels as
// plain C. What is passed to it is checked as the specification says (Khronos, The OpenCL Specification 1.2;
// the numbers are those of its header cl.h). Which call fails: faults.h.
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "faults.h"
#include "kernels.h"

enum {
  INVALID_VALUE = -30,
  INVALID_BINARY = -42,
  INVALID_KERNEL_NAME = -46,
  INVALID_ARG_INDEX = -49,
  INVALID_ARG_SIZE = -51,
  INVALID_KERNEL_ARGS = -52,
  INVALID_WORK_GROUP_SIZE = -54,
  BUILD_PROGRAM_FAILURE = -11,
};

enum { MOST_FILLED = 1 << 16 }; // bytes of memory whose content is made strange

typedef struct Buffer {
  DeviceMemory memory; // owned
  struct Buffer *next; // of all
} Buffer;

typedef struct Program {
  char *text; // owned
  const DeviceProgram *known;
} Program;

typedef struct Kernel {
  FakeKernel found;
  DeviceArgument arguments[DEVICE_MAX_ARGUMENTS];
  bool is_set[DEVICE_MAX_ARGUMENTS];
} Kernel;

static const char build_log[] = "kernel.cl:1: error: the compiler of tests refuses", magic[] = "tests";
static Buffer *buffers;
static int platform, device, context, queue; // there is one of each

static int answer(size_t size, void *at, size_t *size_wanted, const void *value, size_t length) {
  if (size_wanted) *size_wanted = length;
  if (at && size < length) return INVALID_VALUE;
  if (at) memcpy(at, value, length);
  return 0;
}

FAKE(int, clGetPlatformIDs, unsigned room, void **platforms, unsigned *count) {
  FAKE_ASK;
  if (room > 0 && platforms) platforms[0] = &platform;
  *count = 1;
  return 0;
}

FAKE(int, clGetPlatformInfo, void *which, unsigned what, size_t size, void *at, size_t *size_wanted) {
  (void)which;
  FAKE_ASK;
  return what == 0x0902 ? answer(size, at, size_wanted, magic, sizeof magic) : INVALID_VALUE;
}

FAKE(int, clGetDeviceIDs, void *which, uint64_t type, unsigned room, void **devices, unsigned *count) {
  (void)which, (void)type;
  FAKE_ASK;
  if (room > 0 && devices) devices[0] = &device;
  *count = 1;
  return 0;
}

FAKE(int, clGetDeviceInfo, void *which, unsigned what, size_t size, void *at, size_t *size_wanted) {
  static const struct {
    unsigned what, size;
    uint64_t value;
  } numbers[] = {{0x1000, 8, 1 << 2}, {0x1002, 4, 2},       {0x1004, 8, 256},      {0x100C, 4, 1000},
                 {0x101B, 8, 1 << 7}, {0x101F, 8, 1 << 30}, {0x1023, 8, 48 << 10}, {0x1032, 8, 63}};
  static const char name[] = "a device of tests", version[] = "1.0";
  (void)which;
  FAKE_ASK;
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
    if (numbers[k].what == what) return answer(size, at, size_wanted, &numbers[k].value, numbers[k].size);
  return what == 0x102B   ? answer(size, at, size_wanted, name, sizeof name)
         : what == 0x102D ? answer(size, at, size_wanted, version, sizeof version)
                          : INVALID_VALUE;
}

// Makes one of the objects of which there is one.
static void *make(const char *function, void *object, int *code) {
  if ((*code = fake_ask(function)) != 0) return NULL;
  fake_keep(1);
  return object;
}

static int give_back(const char *function) {
  fake_keep(-1);
  return fake_ask(function);
}

FAKE(void *, clCreateContext, const intptr_t *properties, unsigned count, void *const *devices,
     void (*notify)(const char *, const void *, size_t, void *), void *data, int *code) {
  (void)properties, (void)count, (void)devices, (void)notify, (void)data;
  return make(__func__, &context, code);
}

FAKE(void *, clCreateCommandQueue, void *in, void *of, uint64_t properties, int *code) {
  (void)in, (void)of, (void)properties;
  return make(__func__, &queue, code);
}

FAKE(int, clReleaseContext, void *which) {
  (void)which;
  return give_back(__func__);
}

FAKE(int, clReleaseCommandQueue, void *which) {
  (void)which;
  return give_back(__func__);
}

static Program *make_program(const char *text, size_t length) {
  Program *program = calloc(1, sizeof *program);
  program->text = calloc(length + 1, 1);
  memcpy(program->text, text, length);
  program->known = fake_kernels_program(program->text, DEVICE_OPENCL_C);
  fake_keep(1);
  return program;
}

FAKE(void *, clCreateProgramWithSource, void *in, unsigned count, const char **texts, const size_t *lengths,
     int *code) {
  (void)in;
  if ((*code = fake_ask(__func__)) != 0) return NULL;
  if (count != 1 || lengths) abort();
  return make_program(texts[0], strlen(texts[0]));
}

// A program's code is its text behind a word.
FAKE(void *, clCreateProgramWithBinary, void *in, unsigned count, void *const *devices, const size_t *sizes,
     const unsigned char **binaries, int *statuses, int *code) {
  (void)in, (void)devices;
  if ((*code = fake_ask(__func__)) != 0) return NULL;
  if (count != 1 || sizes[0] <= sizeof magic || memcmp(binaries[0], magic, sizeof magic) != 0) {
    *code = statuses[0] = INVALID_BINARY;
    return NULL;
  }
  return make_program((const char *)binaries[0] + sizeof magic, sizes[0] - sizeof magic);
}

FAKE(int, clBuildProgram, void *which, unsigned count, void *const *devices, const char *options,
     void (*notify)(void *, void *), void *data) {
  (void)count, (void)devices, (void)options, (void)notify, (void)data;
  FAKE_ASK;
  return ((const Program *)which)->known ? 0 : BUILD_PROGRAM_FAILURE;
}

FAKE(int, clGetProgramBuildInfo, void *which, void *of, unsigned what, size_t size, void *at,
     size_t *size_wanted) {
  (void)which, (void)of;
  FAKE_ASK;
  return what == 0x1183 ? answer(size, at, size_wanted, build_log, sizeof build_log) : INVALID_VALUE;
}

FAKE(int, clGetProgramInfo, void *which, unsigned what, size_t size, void *at, size_t *size_wanted) {
  const Program *program = which;
  const size_t length = sizeof magic + strlen(program->text);
  FAKE_ASK;
  if (what == 0x1165) return answer(size, at, size_wanted, &length, sizeof length);
  if (what != 0x1166 || size < sizeof(char *)) return INVALID_VALUE;
  unsigned char *code = *(unsigned char **)at;
  memcpy(code, magic, sizeof magic);
  memcpy(code + sizeof magic, program->text, length - sizeof magic);
  return 0;
}

FAKE(int, clReleaseProgram, void *which) {
  Program *program = which;
  free(program->text), free(program);
  return give_back(__func__);
}

FAKE(void *, clCreateKernel, void *of, const char *name, int *code) {
  const Program *program = of;
  if ((*code = fake_ask(__func__)) != 0) return NULL;
  Kernel *kernel = calloc(1, sizeof *kernel);
  if (!fake_kernels_find(program->known, program->text, name, &kernel->found)) {
    free(kernel);
    *code = INVALID_KERNEL_NAME;
    return NULL;
  }
  fake_keep(1);
  return kernel;
}

FAKE(int, clReleaseKernel, void *which) {
  free(which);
  return give_back(__func__);
}

FAKE(void *, clCreateBuffer, void *in, uint64_t flags, size_t size, void *host, int *code) {
  (void)in, (void)flags, (void)host;
  if ((*code = fake_ask(__func__)) != 0) return NULL;
  Buffer *buffer = calloc(1, sizeof *buffer);
  *buffer = (Buffer){.memory = {malloc(size), size}, .next = buffers};
  memset(buffer->memory.at, 0x55, size < MOST_FILLED ? size : MOST_FILLED); // nobody says that it is 0
  buffers = buffer;
  fake_keep(1);
  return buffer;
}

FAKE(int, clReleaseMemObject, void *which) {
  Buffer **at = &buffers;
  while (*at && *at != which) at = &(*at)->next;
  if (!*at) abort();
  Buffer *buffer = *at;
  *at = buffer->next;
  free(buffer->memory.at), free(buffer);
  return give_back(__func__);
}

FAKE(int, clSetKernelArg, void *of, unsigned index, size_t size, const void *value) {
  static const DeviceMemory none;
  Kernel *kernel = of;
  FAKE_ASK;
  if (index >= (unsigned)kernel->found.argument_count) return INVALID_ARG_INDEX;
  DeviceArgument *argument = &kernel->arguments[index];
  argument->kind = kernel->found.kinds[index];
  if (size != (argument->kind == DEVICE_INT ? sizeof(int) : 8)) return INVALID_ARG_SIZE;
  if (argument->kind == DEVICE_INT) memcpy(&argument->integer, value, size);
  if (argument->kind == DEVICE_DOUBLE) memcpy(&argument->number, value, size);
  if (argument->kind == DEVICE_MEMORY) {
    const Buffer *buffer;
    memcpy(&buffer, value, size);
    argument->memory = buffer ? &buffer->memory : &none;
  }
  kernel->is_set[index] = true;
  return 0;
}

FAKE(int, clEnqueueNDRangeKernel, void *on, void *what, unsigned dimensions, const size_t *offset,
     const size_t *all, const size_t *items, unsigned wait_count, const void *wait_for, void *event) {
  const Kernel *kernel = what;
  (void)on, (void)wait_count, (void)wait_for, (void)event;
  FAKE_ASK;
  if (dimensions != 1 || offset) return INVALID_VALUE;
  if (*items != (size_t)kernel->found.host.items || *all % *items != 0 || *all == 0)
    return INVALID_WORK_GROUP_SIZE;
  for (int k = 0; k < kernel->found.argument_count; k++)
    if (!kernel->is_set[k]) return INVALID_KERNEL_ARGS;
  fake_kernels_run(&kernel->found, (int)(*all / *items), kernel->arguments);
  return 0;
}

FAKE(int, clEnqueueWriteBuffer, void *on, void *to, unsigned is_blocking, size_t at, size_t size,
     const void *from, unsigned wait_count, const void *wait_for, void *event) {
  const Buffer *buffer = to;
  (void)on, (void)is_blocking, (void)wait_count, (void)wait_for, (void)event;
  FAKE_ASK;
  if (size == 0 || at > buffer->memory.bytes || size > buffer->memory.bytes - at) return INVALID_VALUE;
  memcpy((char *)buffer->memory.at + at, from, size);
  return 0;
}

FAKE(int, clEnqueueReadBuffer, void *on, void *from, unsigned is_blocking, size_t at, size_t size, void *to,
     unsigned wait_count, const void *wait_for, void *event) {
  const Buffer *buffer = from;
  (void)on, (void)is_blocking, (void)wait_count, (void)wait_for, (void)event;
  FAKE_ASK;
  if (size == 0 || at > buffer->memory.bytes || size > buffer->memory.bytes - at) return INVALID_VALUE;
  memcpy(to, (const char *)buffer->memory.at + at, size);
  return 0;
}

FAKE(int, clFinish, void *which) {
  (void)which;
  FAKE_ASK;
  return 0;
}

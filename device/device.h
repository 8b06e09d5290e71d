// SPDX-License-Identifier: Apache-2.0
// Accelerators, and the processor in their place: one table of operations, of which nothing is linked.
//
//   host    always there: kernels as plain C (kernels/), for tests and as a referee; not for speed
//   opencl  libOpenCL.so.1, looked for at run time: any GPU that has its driver; pocl on a processor
//   cuda    libcuda.so.1 and libnvrtc.so, looked for at run time
//
// Kernels are text in one dialect that C, OpenCL C and CUDA C++ share (kernels/source.h), compiled where they
// run; the machine code is kept (backend/cache.h). A kernel works in groups of items; an item of one group
// sees only its group's memory and the device's. Everything is done in the order in which it is asked for. A
// device belongs to one thread at a time.
//
// Failures are STATUS_DEVICE (no library, no device, a refused build, a device lost), STATUS_MEMORY, or
// STATUS_USAGE for a name that is none; the message names the device and the driver's own word.
#ifndef TETLAP_DEVICE_DEVICE_H
#define TETLAP_DEVICE_DEVICE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "device/kernels/source.h"

enum { DEVICE_TEXT = 160, DEVICE_MAX_FOUND = 16, DEVICE_MAX_ARGUMENTS = 24 };

// Kinds of multiplications and additions, by their factors; sums of bf16 are floats.
typedef enum DeviceArithmetic {
  DEVICE_IN_FLOAT,
  DEVICE_IN_DOUBLE,
  DEVICE_IN_BF16,
  DEVICE_ARITHMETIC_COUNT
} DeviceArithmetic;

// What is known of a device before it is opened.
typedef struct DeviceInfo {
  int index;                // among those of its kind
  char name[DEVICE_TEXT];   // the maker's
  char driver[DEVICE_TEXT]; // platform and version of the driver
  double memory_bytes;
  int units;                            // multiprocessors, or cores
  int clock_mhz;                        // the highest that the driver tells; 0: it does not
  double peak[DEVICE_ARITHMETIC_COUNT]; // multiplications and additions at most [1/s]; 0: not known
  double issue;                         // instructions at most, of items [1/s]; 0: not known
  bool is_gpu;
  char reason[DEVICE_TEXT]; // why it is not usable; "": it is
} DeviceInfo;

// Memory of a device. Zeroed: none.
typedef struct DeviceMemory {
  void *at; // the implementation's
  size_t bytes;
} DeviceMemory;

typedef struct DeviceKernel {
  void *at; // the implementation's
  int items;
  const char *name;
} DeviceKernel;

typedef enum DeviceArgumentKind { DEVICE_MEMORY, DEVICE_INT, DEVICE_DOUBLE } DeviceArgumentKind;

// What a kernel is called with. A memory of no bytes is a null pointer.
typedef struct DeviceArgument {
  DeviceArgumentKind kind;
  const DeviceMemory *memory; // borrowed
  int integer;
  double number;
} DeviceArgument;

// Moments of a device's own clock.
typedef enum DeviceMark { DEVICE_BEGIN, DEVICE_END, DEVICE_MARK_COUNT } DeviceMark;

// Implementations; `self` is what open made.
typedef struct DeviceOps {
  const char *name, *help;
  const char *looked_for; // what find looks for
  // Devices of this kind, at most DEVICE_MAX_FOUND. With none, `reason` says why.
  int (*find)(DeviceInfo *infos, char reason[DEVICE_TEXT]);
  Status (*open)(const DeviceInfo *info, void **self);
  void (*close)(void *self);
  // Compiles a program. Kernels are found in it by name, which must be one of the program's.
  Status (*build)(void *self, const DeviceProgram *program, void **module);
  void (*discard)(void *self, void *module);
  Status (*kernel)(void *self, void *module, const char *name, DeviceKernel *kernel);
  Status (*take)(void *self, size_t bytes, DeviceMemory *memory);
  void (*release)(void *self, DeviceMemory *memory); // zeroed memory is accepted
  // `at`: bytes from the memory's beginning. The host's memory may be changed, or is there, on return.
  Status (*put)(void *self, const DeviceMemory *to, size_t at, size_t bytes, const void *from);
  Status (*get)(void *self, const DeviceMemory *from, size_t at, size_t bytes, void *to);
  Status (*launch)(void *self, const DeviceKernel *kernel, int groups, const DeviceArgument *arguments,
                   int count);
  Status (*wait)(void *self); // until all that was asked for is done
  Status (*mark)(void *self, DeviceMark mark);
  Status (*elapsed)(void *self, double *seconds); // from BEGIN to END; waits for both
} DeviceOps;

typedef struct Device {
  const DeviceOps *ops;
  void *self; // owned
  DeviceInfo info;
} Device;

extern const DeviceOps device_host, device_opencl, device_cuda;

// The implementations there are, in the order in which `auto` prefers them but for host, which it never
// takes.
const DeviceOps *const *device_list(int *count);

// `name`: host, opencl, cuda, with ":INDEX" for another than the first usable one; auto: the first GPU found
// by cuda, then by opencl. STATUS_USAGE: no such name. STATUS_DEVICE: not there, and why.
Status device_open(Device *device, const char *name);
void device_close(Device *device); // a zeroed one is accepted

// Compiles a program, and finds all its kernels in their order. `*module` is to be discarded.
Status device_build(const Device *device, const DeviceProgram *program, void **module,
                    DeviceKernel kernels[DEVICE_MAX_KERNELS]);

// Starts a kernel over as many groups as `count` items take.
Status device_launch(const Device *device, const DeviceKernel *kernel, int count,
                     const DeviceArgument *arguments, int argument_count);

// An array of the device's, filled from the host's if `from` is not NULL.
Status device_take(const Device *device, size_t count, size_t size, const void *from, DeviceMemory *memory);

static inline DeviceArgument device_memory(const DeviceMemory *memory) {
  return (DeviceArgument){.kind = DEVICE_MEMORY, .memory = memory};
}
static inline DeviceArgument device_int(int value) {
  return (DeviceArgument){.kind = DEVICE_INT, .integer = value};
}
static inline DeviceArgument device_double(double value) {
  return (DeviceArgument){.kind = DEVICE_DOUBLE, .number = value};
}

#endif

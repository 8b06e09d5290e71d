// SPDX-License-Identifier: Apache-2.0
// Kernels as plain C, by the names of their programs. Private to device/.
#ifndef TETLAP_DEVICE_HOST_KERNEL_H
#define TETLAP_DEVICE_HOST_KERNEL_H

#include "device/device.h"

// One group of a kernel; arguments as the kernel declares them, memory as pointers.
typedef void DeviceHostRun(int group, const DeviceArgument *arguments);

typedef struct DeviceHostKernel {
  const char *name;
  DeviceHostRun *run;
} DeviceHostKernel;

// Ends with a name that is NULL.
extern const DeviceHostKernel device_host_clip[], device_host_clip32[], device_host_gather[],
    device_host_poses[], device_host_tpn[], device_host_tpn_bf16[], device_host_scalar[],
    device_host_geo_small[], device_host_geo[], device_host_peak[];

static inline void *device_host_at(const DeviceArgument *argument) {
  return argument->memory->at;
}

#endif

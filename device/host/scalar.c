// SPDX-License-Identifier: Apache-2.0
#include "device/host/kernel.h"
#include "device/host/pairs.h"
#include "device/kernels/language_host.h"

#include "overlap/clip/constants.h"

#include "device/kernels/one.inc"

#include "device/kernels/pairs.inc"

#include "device/kernels/vec3.inc"

#include "overlap/clip/polytope_types.h"

#include "overlap/clip/polytope.inc"

#include "overlap/clip/sums.inc"

#include "device/kernels/clip/scalar.inc"

static void run_volume(int group, const DeviceArgument *a) {
  scalar_volume(group, HOST_PAIRS(a), device_host_at(a + 8), device_host_at(a + 9), device_host_at(a + 10),
                device_host_at(a + 11));
}

static void run_gradient(int group, const DeviceArgument *a) {
  scalar_gradient(group, HOST_PAIRS(a), device_host_at(a + 8), device_host_at(a + 9), device_host_at(a + 10),
                  device_host_at(a + 11), device_host_at(a + 12));
}

static void run_centroid(int group, const DeviceArgument *a) {
  scalar_centroid(group, HOST_PAIRS(a), device_host_at(a + 8), device_host_at(a + 9), device_host_at(a + 10),
                  device_host_at(a + 11), device_host_at(a + 12));
}

const DeviceHostKernel device_host_scalar[] = {{"scalar_volume", run_volume},
                                               {"scalar_gradient", run_gradient},
                                               {"scalar_centroid", run_centroid},
                                               {NULL, NULL}};

// SPDX-License-Identifier: Apache-2.0
#include "device/host/kernel.h"
#include "device/host/pairs.h"
#include "device/kernels/language_host.h"

#include "device/kernels/one.inc"

#include "device/kernels/pairs.inc"

#include "device/kernels/gather.inc"

static void run_gather(int group, const DeviceArgument *a) {
  gather_pairs(group, HOST_PAIRS(a), device_host_at(a + 8));
}

static void run_scatter(int group, const DeviceArgument *a) {
  scatter_answers(group, a[0].integer, a[1].integer, a[2].integer, device_host_at(a + 3),
                  device_host_at(a + 4), device_host_at(a + 5), a[6].integer, device_host_at(a + 7),
                  device_host_at(a + 8), device_host_at(a + 9), device_host_at(a + 10));
}

const DeviceHostKernel device_host_gather[] = {
    {"gather_pairs", run_gather}, {"scatter_answers", run_scatter}, {NULL, NULL}};

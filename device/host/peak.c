// SPDX-License-Identifier: Apache-2.0
#include "device/host/kernel.h"
#include "device/kernels/language_host.h"

#include "device/kernels/peak.inc"

static void run_float(int group, const DeviceArgument *a) {
  peak_float(group, a[0].integer, a[1].number, a[2].number, device_host_at(a + 3));
}

static void run_double(int group, const DeviceArgument *a) {
  peak_double(group, a[0].integer, a[1].number, a[2].number, device_host_at(a + 3));
}

const DeviceHostKernel device_host_peak[] = {
    {"peak_float", run_float}, {"peak_double", run_double}, {NULL, NULL}};

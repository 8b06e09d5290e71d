// SPDX-License-Identifier: Apache-2.0
#include "device/host.h"
#include "device/host_pairs.h"
#include "device/kernels/language_host.h"

#include "device/kernels/one.inc"

#include "device/kernels/pairs.inc"

#include "device/kernels/tpn_steps.h"

#include "device/kernels/tpn.inc"

static void run_volume(int group, const DeviceArgument *a) {
  tpn_volume(group, HOST_PAIRS(a), device_host_at(a + 8), device_host_at(a + 9), device_host_at(a + 10),
             device_host_at(a + 11), device_host_at(a + 12), a[13].integer, device_host_at(a + 14),
             a[15].integer, device_host_at(a + 16), a[17].integer, a[18].number);
}

const DeviceHostKernel device_host_tpn[] = {{"tpn_volume", run_volume}, {NULL, NULL}};

// SPDX-License-Identifier: Apache-2.0
#include "device/host/kernel.h"
#include "device/host/pairs.h"
#include "device/kernels/language_host.h"

#include "device/kernels/one.inc"

#include "device/kernels/pairs.inc"

#include "device/kernels/tpn_steps.h"

#include "device/kernels/tpn.inc"

#define HOST_ANSWERS(a)                                                                                      \
  HOST_PAIRS(a), device_host_at((a) + 8), device_host_at((a) + 9), device_host_at((a) + 10),                 \
      device_host_at((a) + 11)
#define HOST_NETWORK(a)                                                                                      \
  device_host_at(a), device_host_at((a) + 1), device_host_at((a) + 2), device_host_at((a) + 3), (a)[4].number

static void run_volume(int group, const DeviceArgument *a) {
  tpn_volume(group, HOST_ANSWERS(a), HOST_NETWORK(a + 12));
}

static void run_gradient(int group, const DeviceArgument *a) {
  tpn_gradient(group, HOST_ANSWERS(a), device_host_at(a + 12), HOST_NETWORK(a + 13));
}

const DeviceHostKernel device_host_tpn[] = {
    {"tpn_volume", run_volume}, {"tpn_gradient", run_gradient}, {NULL, NULL}};

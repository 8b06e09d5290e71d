// SPDX-License-Identifier: Apache-2.0
#include "device/host/kernel.h"
#include "device/kernels/language_host.h"

#include "overlap/clip/constants.h"

#include "device/kernels/one.inc"

#include "device/kernels/clip/kept.inc"

#include "overlap/clip/lanes.inc"

#include "device/kernels/clip/pose.inc"

#include "device/kernels/clip/poses.inc"

static void run_clip(int group, const DeviceArgument *a) {
  poses_clip(group, a[0].integer, a[1].integer, a[2].integer, device_host_at(a + 3), device_host_at(a + 4),
             device_host_at(a + 5), device_host_at(a + 6), a[7].number, a[8].number, a[9].number,
             device_host_at(a + 10), device_host_at(a + 11), device_host_at(a + 12));
}

static void run_mend(int group, const DeviceArgument *a) {
  poses_mend(group, a[0].integer, a[1].integer, device_host_at(a + 2), device_host_at(a + 3),
             device_host_at(a + 4));
}

static void run_sum(int group, const DeviceArgument *a) {
  poses_sum(group, a[0].integer, a[1].integer, device_host_at(a + 2), device_host_at(a + 3));
}

const DeviceHostKernel device_host_poses[] = {
    {"poses_clip", run_clip}, {"poses_mend", run_mend}, {"poses_sum", run_sum}, {NULL, NULL}};

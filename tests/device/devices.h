// SPDX-License-Identifier: GPL-3.0-or-later
// Usable devices of all kinds, the first of each, and what each must do with every model.
#pragma once

#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "app/bench/overlap/pairs.h"
#include "device/overlap/overlap.h"

enum { DEVICE_KINDS = 3 };

static Device devices[DEVICE_KINDS];
static int device_count;

static inline void open_devices(void) {
  static const char *const names[DEVICE_KINDS] = {"host", "opencl", "cuda"};
  for (int k = 0; k < DEVICE_KINDS; k++) {
    if (device_open(&devices[device_count], names[k]) == STATUS_OK)
      device_count++;
    else
      printf("%s is not tested: %s\n", names[k], status_message());
  }
}

static inline void close_devices(void) {
  for (int k = 0; k < device_count; k++) device_close(&devices[k]);
}

// A pair that is not finite is named.
static inline void expect_named(const Device *device, const char *model) {
  DeviceOverlap overlap;
  double pairs[5 * 24], volume[5], gradient[5 * 24];
  unsigned flags[5];
  OverlapBatch batch = {
      .pair_count = 5, .pairs = pairs, .volume = volume, .gradient = gradient, .flags = flags};
  ck_assert_ok(app_bench_pairs_make("near", 5, 3, pairs));
  pairs[3 * 24 + 14] = NAN;
  ck_assert_ok(device_overlap_create(&overlap, device, model));
  ck_assert_int_eq(device_overlap_eval(&overlap, &batch), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "pair 3, tetrahedron 1, vertex 0: coordinate z") != NULL, "%s",
                status_message());
  device_overlap_destroy(&overlap);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// How much arithmetic a pair takes, of which `tetlap bench overlap --device` tells the share of the peak.
#include "suite.h"

#include "app/bench/overlap/pairs.h"
#include "count_operations.h"
#include "device/overlap/overlap.h"

enum { COUNT = 40 };

START_TEST(clipping_takes_the_same_of_every_pair) {
  static const char *const models[] = {"clip", "clip32"};
  Device device;
  ck_assert_ok(device_open(&device, "host"));
  for (int m = 0; m < 2; m++) {
    DeviceOverlap overlap;
    ck_assert_ok(device_overlap_create(&overlap, &device, models[m]));
    for (int set = 0; set < APP_BENCH_SET_COUNT; set++) {
      double pairs[COUNT * 24], counts[3], instructions[3];
      ck_assert_ok(app_bench_pairs_make(app_bench_sets[set], COUNT, 3, pairs));
      for (int i = 0; i < COUNT; i++) {
        count_operations(pairs + 24 * (size_t)i, counts, instructions);
        for (int q = 0; q < 3; q++) {
          ck_assert_double_eq(device_overlap_flops(&overlap, (DeviceQuantity)q), counts[q]);
          ck_assert_double_eq(device_overlap_instructions(&overlap, (DeviceQuantity)q), instructions[q]);
        }
      }
    }
    device_overlap_destroy(&overlap);
  }
  device_close(&device);
}
END_TEST

// 73,370 parameters and the folded network's 102 kflop: docs/benchmarks.md.
START_TEST(networks_take_what_their_layers_say) {
  Device device;
  DeviceOverlap overlap;
  ck_assert_ok(device_open(&device, "host"));
  ck_assert_ok(device_overlap_create(&overlap, &device, "tpn"));
  ck_assert_double_eq_tol(device_overlap_flops(&overlap, DEVICE_VOLUME), 102e3, 1e3);
  ck_assert_double_eq(device_overlap_flops(&overlap, DEVICE_GRADIENT),
                      2 * device_overlap_flops(&overlap, DEVICE_VOLUME));
  ck_assert_double_eq(device_overlap_instructions(&overlap, DEVICE_VOLUME),
                      0.5 * device_overlap_flops(&overlap, DEVICE_VOLUME));
  device_overlap_destroy(&overlap);
  device_close(&device);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("device_operations");
  tcase_add_test(cases, clipping_takes_the_same_of_every_pair);
  tcase_add_test(cases, networks_take_what_their_layers_say);
  return suite_run("device operations", cases, 60);
}

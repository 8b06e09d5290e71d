// SPDX-License-Identifier: GPL-3.0-or-later
// How much arithmetic a pair takes, of which `tetlap-lab device` tells the share of the peak.
#include "suite.h"

#include "app/bench/overlap/pairs.h"
#include "count_operations.h"
#include "device/overlap/overlap.h"
#include "device/peak/peak.h"
#include "devices.h"

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

// Of every device a share can be told. bf16 has no product of its own where it is not the maker who says.
START_TEST(a_peak_is_measured_in_float_and_double) {
  double peak[DEVICE_ARITHMETIC_COUNT];
  open_devices();
  for (int d = 0; d < device_count; d++) {
    ck_assert_ok(device_peak_measure(&devices[d], peak));
    ck_assert_msg(peak[DEVICE_IN_FLOAT] > 0 && peak[DEVICE_IN_DOUBLE] > 0 && peak[DEVICE_IN_BF16] == 0,
                  "%s: %g, %g, %g", devices[d].ops->name, peak[DEVICE_IN_FLOAT], peak[DEVICE_IN_DOUBLE],
                  peak[DEVICE_IN_BF16]);
  }
  close_devices();
}
END_TEST

// a · 1/2 + 1 goes to 2 from anywhere, so eight chains sum to 16: the work is done, and nothing overflows.
START_TEST(chains_of_the_peak_go_to_their_fixed_point) {
  open_devices();
  for (int d = 0; d < device_count; d++) {
    const Device *device = &devices[d];
    DeviceKernel kernels[DEVICE_MAX_KERNELS];
    DeviceMemory sums;
    void *module;
    float single[128] = {0};
    double both[128] = {0};
    ck_assert_ok(device_build(device, &device_program_peak, &module, kernels));
    ck_assert_ok(device_take(device, 128, sizeof(double), both, &sums));
    const DeviceArgument arguments[] = {device_int(64), device_double(.5), device_double(1),
                                        device_memory(&sums)};
    ck_assert_ok(device_launch(device, &kernels[0], 128, arguments, 4));
    ck_assert_ok(device->ops->get(device->self, &sums, 0, sizeof single, single));
    ck_assert_ok(device_launch(device, &kernels[1], 128, arguments, 4));
    ck_assert_ok(device->ops->get(device->self, &sums, 0, sizeof both, both));
    for (int i = 0; i < 128; i++) {
      ck_assert_near(single[i], 16, 1e-5);
      ck_assert_near(both[i], 16, 1e-12);
    }
    device->ops->release(device->self, &sums);
    device->ops->discard(device->self, module);
  }
  close_devices();
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("device_operations");
  tcase_add_test(cases, clipping_takes_the_same_of_every_pair);
  tcase_add_test(cases, networks_take_what_their_layers_say);
  tcase_add_test(cases, a_peak_is_measured_in_float_and_double);
  tcase_add_test(cases, chains_of_the_peak_go_to_their_fixed_point);
  return suite_run("device operations", cases, 60);
}

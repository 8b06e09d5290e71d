// SPDX-License-Identifier: GPL-3.0-or-later
// tpn-bf16 on devices. The tensor cores' part of it runs here as plain C: 32 lanes one after another, and
// their product of small matrices emulated from another description of which lane holds what than the kernels
// have. With its sums taken in order that part must give the bits of the plain kernels.
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/bench/overlap/pairs.h"
#include "base/memory.h"
#include "base/random.h"
#include "datagen/hard.h"
#include "device/network/pack.h"
#include "device/overlap/overlap.h"
#include "net/kernel/bf16.h"
#include "overlap/models.h"

#define HAS_MMA
#define MMA_HERE 32
#define HERE(lane) (lane)
#define TOGETHER (void)0
#define EACH_WARP(warp, count) for (int warp = 0; warp < (count); warp++)
#define EACH_LANE(lane) for (int lane = 0; lane < 32; lane++)
static unsigned mma_pack(float lower, float upper);
static void mma_load_left(const unsigned *words, unsigned left[4]);
static void mma_multiply(float sum[32][4], unsigned left[32][4], unsigned right[32][2]);

#define TPN_BF16
#define HOST_KERNELS by_warps
#include "device/host/tpn.inc"

static int products; // how often mma_multiply was called

static unsigned mma_pack(float lower, float upper) {
  return bf16_pack(lower, upper);
}

static void mma_load_left(const unsigned *words, unsigned left[4]) {
  ck_assert_uint_eq((uintptr_t)words % 16, 0); // a device loads them at once
  memcpy(left, words, 4 * sizeof *left);
}

// The factor in the lower (0) or upper half of a word.
static float half_of(unsigned word, int half) {
  return device_float(half ? word & 0xffff0000u : word << 16);
}

// Which lane holds what, as CUTLASS has it (MMA_Traits<SM80_16x8x16_F32BF16BF16F32_TN>): lane t0 + 4 t1,
// number v0 + 2 v1 + 4 v2, elements counted down the columns of L (16, 16), Rᵀ (8, 16) and S (16, 8).
static int left_element(int lane, int v) {
  return 32 * (lane % 4) + lane / 4 + 16 * (v % 2) + 8 * (v / 2 % 2) + 128 * (v / 4);
}
static int right_element(int lane, int v) {
  return 16 * (lane % 4) + lane / 4 + 8 * (v % 2) + 64 * (v / 2);
}
static int sum_element(int lane, int v) {
  return 32 * (lane % 4) + lane / 4 + 16 * (v % 2) + 8 * (v / 2);
}

static void mma_multiply(float sum[32][4], unsigned left[32][4], unsigned right[32][2]) {
  float l[16 * 16], r[8 * 16];
#pragma omp atomic
  products++;
  for (int lane = 0; lane < 32; lane++) {
    for (int v = 0; v < 8; v++) l[left_element(lane, v)] = half_of(left[lane][v / 2], v % 2);
    for (int v = 0; v < 4; v++) r[right_element(lane, v)] = half_of(right[lane][v / 2], v % 2);
  }
  for (int lane = 0; lane < 32; lane++)
    for (int v = 0; v < 4; v++) {
      const int row = sum_element(lane, v) % 16, column = sum_element(lane, v) / 16;
      for (int k = 0; k < 16; k++) sum[lane][v] = fmaf(l[row + 16 * k], r[column + 8 * k], sum[lane][v]);
    }
}

// --- What a lane holds.

// PTX ISA, "Matrix fragments for mma.m16n8k16": a_i, b_i, c_i of a lane, groupID = lane >> 2, t = lane % 4.
START_TEST(fragments_are_those_of_two_manuals) {
  for (int lane = 0; lane < 32; lane++) {
    const int group = lane >> 2, t = lane % 4;
    for (int i = 0; i < 8; i++) {
      const int row = i < 2 || (i >= 4 && i < 6) ? group : group + 8;
      const int column = t * 2 + (i & 1) + (i >= 4 ? 8 : 0);
      ck_assert_int_eq(mma_left_row(lane, i / 2), row);
      ck_assert_int_eq(mma_left_inner(lane, i / 2) + i % 2, column);
      ck_assert_int_eq(left_element(lane, i), row + 16 * column);
    }
    for (int i = 0; i < 4; i++) {
      const int inner = t * 2 + (i & 1) + (i >= 2 ? 8 : 0);
      ck_assert_int_eq(mma_right_inner(lane, i / 2) + i % 2, inner);
      ck_assert_int_eq(right_element(lane, i), mma_right_column(lane) + 8 * inner);
      ck_assert_int_eq(mma_right_column(lane), group);
      ck_assert_int_eq(mma_sum_row(lane, i), i < 2 ? group : group + 8);
      ck_assert_int_eq(mma_sum_column(lane, i), t * 2 + (i & 1));
      ck_assert_int_eq(sum_element(lane, i), mma_sum_row(lane, i) + 16 * mma_sum_column(lane, i));
    }
  }
}
END_TEST

static float draw(Random *random) {
  return (float)(2 * random_uniform(random) - 1);
}

// A product of matrices whose sizes are no multiples of anything, by warps and term by term.
static void check_product(Random *random, int rows, int inner, int across, bool has_relu,
                          bool is_transposed) {
  enum { MOST = 140, WIDTH = 48 };
  static _Alignas(16) unsigned packed[2 * MMA_TILE * 81];
  static float weights[MOST * MOST], right[MOST * WIDTH], bias[MOST], sums[MOST * WIDTH], base[MOST * WIDTH];
  for (int k = 0; k < MOST * MOST; k++) weights[k] = device_pack_round(draw(random));
  for (int k = 0; k < MOST; k++) bias[k] = draw(random);
  for (int k = 0; k < MOST * WIDTH; k++) right[k] = draw(random), base[k] = draw(random), sums[k] = 7;
  for (int k = inner * WIDTH; k < MOST * WIDTH; k++) right[k] = NAN; // must not be read
  const int row_step = is_transposed ? 1 : inner, inner_step = is_transposed ? rows : 1;
  ck_assert_uint_le(device_pack_size(rows, inner), sizeof packed / sizeof *packed);
  device_pack_matrix(rows, inner, weights, row_step, inner_step, packed);
  const MmaProduct product = {rows, inner, across, WIDTH, has_relu};
  for (int warp = 0; warp < TPN_ITEMS / MMA_LANES; warp++)
    mma_product(&product, packed, right, bias, base, sums, warp);
  for (int i = 0; i < MOST; i++)
    for (int j = 0; j < WIDTH; j++) {
      float sum = 7;
      if (i < rows && j < across) {
        sum = bias[i] + base[i * WIDTH + j];
        for (int l = 0; l < inner; l++)
          sum = fmaf(weights[i * row_step + l * inner_step], bf16_round(right[l * WIDTH + j]), sum);
        if (has_relu && !(sum > 0)) sum = 0;
      }
      ck_assert_msg(sums[i * WIDTH + j] == sum, "(%d, %d) of (%d, %d, %d): %.9g, expected %.9g", i, j, rows,
                    across, inner, (double)sums[i * WIDTH + j], (double)sum);
    }
}

START_TEST(products_by_warps_are_products) {
  Random random = random_seeded(5, 0);
  check_product(&random, 16, 16, 8, false, false);
  check_product(&random, 128, 96, 32, true, false);
  check_product(&random, 96, 128, 4, false, true);
  check_product(&random, 1, 128, 32, false, false);
  check_product(&random, 48, 27, 16, true, false);
  for (int k = 0; k < 40; k++) {
    const int rows = 1 + (int)(random_bits(&random) % 140), inner = 1 + (int)(random_bits(&random) % 140);
    const int across = 1 + (int)(random_bits(&random) % 48);
    check_product(&random, rows, inner, across, k % 2, k % 3 == 0);
  }
}
END_TEST

START_TEST(rounding_is_the_processors) {
  Random random = random_seeded(6, 0);
  for (int k = 0; k < 100000; k++) {
    const unsigned bits = (unsigned)random_bits(&random);
    const float x = device_float(bits);
    if (x == x) ck_assert(device_bits(bf16_round(x)) == device_bits(net_kernel_bf16_round(x)));
  }
  ck_assert(isnan(bf16_round(NAN)));
  ck_assert(isinf(bf16_round(3.4028235e38f)));
  ck_assert_uint_eq(bf16_pack(1, -2), 0xc0003f80u);
}
END_TEST

// --- The kernels.

static Status kernel_by_warps(void *self, void *module, const char *name, DeviceKernel *found) {
  TRY(device_host.kernel(self, module, name, found));
  for (int k = 0; by_warps[k].name; k++)
    if (strcmp(by_warps[k].name, name) == 0) found->at = (void *)(size_t)&by_warps[k];
  return STATUS_OK;
}

typedef struct Answers {
  double *volume, *gradient; // (count), (count, 24)
  unsigned *flags;           // (count)
} Answers;

static Answers make_answers(int count) {
  size_t n = (size_t)count;
  return (Answers){memory_zeroed(n, 8), memory_zeroed(n * 24, 8), memory_zeroed(n, sizeof(unsigned))};
}

static void destroy_answers(Answers *answers) {
  memory_free(answers->volume), memory_free(answers->gradient), memory_free(answers->flags);
}

static void ask(const Device *device, const char *model, const double *pairs, int count, bool has_gradient,
                const Answers *answers) {
  DeviceOverlap overlap;
  const OverlapBatch batch = {.pair_count = count,
                              .pairs = pairs,
                              .volume = answers->volume,
                              .gradient = has_gradient ? answers->gradient : NULL,
                              .flags = answers->flags};
  ck_assert_ok(device_overlap_create(&overlap, device, model));
  ck_assert_ok(device_overlap_eval(&overlap, &batch));
  device_overlap_destroy(&overlap);
}

enum { COUNT = 1031, MEMBERS = 8, HARD = DATAGEN_HARD_CLASS_COUNT * MEMBERS, ALL = 3 * COUNT + HARD };

static double *make_pairs(void) {
  double *pairs = memory_zeroed(ALL * 24, sizeof *pairs);
  for (int set = 0; set < 3; set++)
    ck_assert_ok(app_bench_pairs_make(app_bench_sets[set], COUNT, 3, pairs + (size_t)(set * COUNT) * 24));
  for (int i = 0; i < HARD; i++)
    memcpy(pairs + (size_t)(3 * COUNT + i) * 24, datagen_hard_make(i / MEMBERS, i % MEMBERS).x,
           24 * sizeof *pairs);
  return pairs;
}

START_TEST(kernels_by_warps_give_the_bits_of_the_plain_ones) {
  DeviceOps ops = device_host;
  Device device, warps;
  Answers plain = make_answers(ALL), answers = make_answers(ALL);
  double *pairs = make_pairs();
  ops.kernel = kernel_by_warps;
  ck_assert_ok(device_open(&device, "host"));
  warps = device;
  warps.ops = &ops;
  for (int has_gradient = 0; has_gradient < 2; has_gradient++) {
    products = 0;
    ask(&device, "tpn-bf16", pairs, ALL, has_gradient, &plain);
    ck_assert_int_eq(products, 0);
    ask(&warps, "tpn-bf16", pairs, ALL, has_gradient, &answers);
    ck_assert_int_gt(products, ALL);
    ck_assert_mem_eq(plain.flags, answers.flags, ALL * sizeof(unsigned));
    for (int i = 0; i < ALL; i++) ck_assert_msg(plain.volume[i] == answers.volume[i], "V of pair %d", i);
    for (int k = 0; has_gradient && k < 24 * ALL; k++)
      ck_assert_msg(plain.gradient[k] == answers.gradient[k] ||
                        (isnan(plain.gradient[k]) && isnan(answers.gradient[k])),
                    "pair %d, number %d: %.17g, %.17g", k / 24, k % 24, plain.gradient[k],
                    answers.gradient[k]);
  }
  device_close(&device);
  destroy_answers(&plain), destroy_answers(&answers), memory_free(pairs);
}
END_TEST

// ‖a − b‖ over pairs of the bench sets
static double distance(const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < 3 * COUNT; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum);
}

static void ask_processor(const char *name, const double *pairs, const Answers *answers) {
  OverlapModel model;
  const OverlapBatch batch = {
      .pair_count = ALL, .pairs = pairs, .volume = answers->volume, .flags = answers->flags};
  ck_assert_ok(overlap_models_create(&model, name));
  ck_assert_ok(overlap_model_eval(&model, &batch));
  overlap_model_destroy(&model);
}

// Whatever the order of the sums, of a processor's instructions or a tensor core's: it changes V by far less
// than rounding to bf16 does, in the mean over pairs. (A sum that lies between two bf16 now and then goes the
// other way.)
START_TEST(the_order_of_sums_matters_less_than_rounding) {
  static const char *const names[] = {"host", "opencl", "cuda"};
  Answers exact = make_answers(ALL), plain = make_answers(ALL), answers = make_answers(ALL);
  double *pairs = make_pairs();
  Device device;
  ck_assert_ok(device_open(&device, "host"));
  ask(&device, "tpn", pairs, ALL, false, &exact);
  ask(&device, "tpn-bf16", pairs, ALL, false, &plain);
  device_close(&device);
  const double rounding = distance(plain.volume, exact.volume);
  ck_assert_double_gt(rounding, 0);
  for (int k = 0; k <= 3; k++) {
    if (k < 3 && device_open(&device, names[k]) != STATUS_OK) continue;
    if (k < 3) {
      ask(&device, "tpn-bf16", pairs, ALL, true, &answers);
      device_close(&device);
    } else {
      ask_processor("tpn-bf16", pairs, &answers);
    }
    const double order = distance(answers.volume, plain.volume);
    printf("%s: order of sums %.2g, rounding %.2g\n", k < 3 ? names[k] : "processor", order, rounding);
    ck_assert_msg(order <= 0.2 * rounding, "order of sums %g, rounding %g", order, rounding);
  }
  destroy_answers(&exact), destroy_answers(&plain), destroy_answers(&answers), memory_free(pairs);
}
END_TEST

// What bf16 costs: the network's own error against exact volumes hardly changes, for rounding alone is far
// below it.
START_TEST(rounding_costs_little_of_the_accuracy) {
  Answers exact = make_answers(ALL), wide = make_answers(ALL), narrow = make_answers(ALL);
  double *pairs = make_pairs();
  Device device;
  ck_assert_ok(device_open(&device, "host"));
  ask(&device, "clip", pairs, ALL, true, &exact);
  ask(&device, "tpn", pairs, ALL, true, &wide);
  ask(&device, "tpn-bf16", pairs, ALL, true, &narrow);
  device_close(&device);
  for (int set = 0; set < 2; set++) { // near, uniform
    double all = 0, by_wide = 0, by_narrow = 0, between = 0;
    double slope = 0, slope_wide = 0, slope_narrow = 0, slope_between = 0;
    for (int i = set * COUNT; i < (set + 1) * COUNT; i++) {
      all += exact.volume[i];
      by_wide += fabs(wide.volume[i] - exact.volume[i]);
      by_narrow += fabs(narrow.volume[i] - exact.volume[i]);
      between += fabs(narrow.volume[i] - wide.volume[i]);
      for (int c = 24 * i; c < 24 * (i + 1); c++) {
        slope += pow(exact.gradient[c], 2);
        slope_wide += pow(wide.gradient[c] - exact.gradient[c], 2);
        slope_narrow += pow(narrow.gradient[c] - exact.gradient[c], 2);
        slope_between += pow(narrow.gradient[c] - wide.gradient[c], 2);
      }
    }
    printf("%s: of sum V, tpn is off by %.4f, tpn-bf16 by %.4f, they differ by %.4f; gradient %.3f, %.3f, "
           "%.3f\n",
           app_bench_sets[set], by_wide / all, by_narrow / all, between / all, sqrt(slope_wide / slope),
           sqrt(slope_narrow / slope), sqrt(slope_between / slope));
    ck_assert_double_gt(between, 0);
    ck_assert_double_le(between, 0.1 * by_wide);
    ck_assert_double_le(by_narrow, 1.02 * by_wide);
    // along two edges the derivative by the slope is divided by what may be small (overlap_tpn_normalise), and
    // its rounding with it
    ck_assert_double_le(slope_between, 0.15 * slope_wide);
    ck_assert_double_le(slope_narrow, 1.1 * slope_wide);
  }
  destroy_answers(&exact), destroy_answers(&wide), destroy_answers(&narrow), memory_free(pairs);
}
END_TEST

int main(void) {
  setenv("CK_FORK", "no", 1); // a driver's threads do not survive a fork
  TCase *cases = tcase_create("device_bf16");
  tcase_add_test(cases, fragments_are_those_of_two_manuals);
  tcase_add_test(cases, products_by_warps_are_products);
  tcase_add_test(cases, rounding_is_the_processors);
  tcase_add_test(cases, kernels_by_warps_give_the_bits_of_the_plain_ones);
  tcase_add_test(cases, the_order_of_sums_matters_less_than_rounding);
  tcase_add_test(cases, rounding_costs_little_of_the_accuracy);
  return suite_run("device bf16", cases, 300);
}

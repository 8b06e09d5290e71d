// SPDX-License-Identifier: GPL-3.0-or-later
// geo and geo-small on every device that there is, against the same models on this processor, carried out by
// the kernels that fuse no multiplication with an addition: so do devices. What is left are the last bits of
// exponentials. Without an OpenCL driver (pocl is one) only `host` runs, and a line says so.
#include "devices.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "datagen/hard.h"
#include "overlap/geo/model.h"
#include "overlap/models.h"
#include "overlap/pair/invariant.h"

enum { COUNT = 2051, MEMBERS = 64, MODELS = 2, QUANTITIES = 3 };

static const char *const models[MODELS] = {"geo-small", "geo"};

typedef struct Answers {
  double *volume, *more; // (count), (count, 24) or (count, 3)
  unsigned *flags;       // (count)
} Answers;

static Answers make_answers(int count) {
  size_t n = (size_t)count;
  return (Answers){memory_zeroed(n, 8), memory_zeroed(n * 24, 8), memory_zeroed(n, sizeof(unsigned))};
}

static void destroy_answers(Answers *answers) {
  memory_free(answers->volume), memory_free(answers->more), memory_free(answers->flags);
}

static OverlapBatch batch_of(const double *pairs, int count, const Answers *answers, int quantity) {
  return (OverlapBatch){.pair_count = count,
                        .pairs = pairs,
                        .volume = answers->volume,
                        .gradient = quantity == DEVICE_GRADIENT ? answers->more : NULL,
                        .centroid = quantity == DEVICE_CENTROID ? answers->more : NULL,
                        .flags = answers->flags};
}

static void ask_processor(const char *name, const OverlapBatch *batch, bool is_fused) {
  OverlapModel model;
  ck_assert_ok(overlap_models_create(&model, name));
  if (!is_fused) ((OverlapGeoOverlap *)model.self)->model.kernel = &overlap_geo_bundle_kernel_portable;
  ck_assert_ok(overlap_model_eval(&model, batch));
  overlap_model_destroy(&model);
}

// V to 1e-12 of itself, ∇V and x̄ by their largest component.
static void check_answer(const Answers *told, const Answers *expected, int i, int width, const char *what) {
  const double tolerance = width == 24 ? 1e-9 : 1e-12;
  const double *a = told->more + (size_t)(width * i), *b = expected->more + (size_t)(width * i);
  double largest = 0;
  ck_assert_msg(fabs(told->volume[i] - expected->volume[i]) <= 1e-12 * expected->volume[i],
                "%s, pair %d: V = %.17g, on the processor %.17g", what, i, told->volume[i],
                expected->volume[i]);
  ck_assert_msg(told->flags[i] == expected->flags[i], "%s, pair %d: flags %u, on the processor %u", what, i,
                told->flags[i], expected->flags[i]);
  for (int c = 0; c < width; c++) largest = fmax(largest, fabs(b[c]));
  for (int c = 0; c < width; c++)
    ck_assert_msg(fabs(a[c] - b[c]) <= tolerance * largest, "%s, pair %d, number %d: %.17g, expected %.17g",
                  what, i, c, a[c], b[c]);
}

// How many of the pairs intersect, how many are answered partly by clip.
static void check_batch(const Device *device, const char *model, const double *pairs, int count,
                        const char *what, int *inside, int *blended) {
  static const int widths[QUANTITIES] = {0, 24, 3};
  DeviceOverlap overlap;
  Answers told = make_answers(count), expected = make_answers(count);
  ck_assert_ok(device_overlap_create(&overlap, device, model));
  for (int quantity = 0; quantity < QUANTITIES; quantity++) {
    OverlapBatch batch = batch_of(pairs, count, &told, quantity),
                 other = batch_of(pairs, count, &expected, quantity);
    memset(told.volume, 0x55, (size_t)count * 8);
    memset(told.more, 0x55, (size_t)count * 24 * 8);
    ck_assert_ok(device_overlap_eval(&overlap, &batch));
    ask_processor(model, &other, false);
    for (int i = 0; i < count; i++) check_answer(&told, &expected, i, widths[quantity], what);
  }
  for (int i = 0; i < count; i++) {
    *inside += told.volume[i] > 0;
    *blended += (told.flags[i] & OVERLAP_BLENDED) != 0;
  }
  device_overlap_destroy(&overlap);
  destroy_answers(&told), destroy_answers(&expected);
}

START_TEST(bench_sets_are_answered_to_rounding) {
  const Device *device = &devices[_i / MODELS];
  double *pairs = memory_zeroed(COUNT * 24, sizeof *pairs);
  int inside = 0, blended = 0;
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) {
    ck_assert_ok(app_bench_pairs_make(app_bench_sets[set], COUNT, 3, pairs));
    check_batch(device, models[_i % MODELS], pairs, COUNT, app_bench_sets[set], &inside, &blended);
  }
  ck_assert_int_gt(inside, COUNT);
  ck_assert_int_gt(blended, COUNT / 50);
  memory_free(pairs);
}
END_TEST

// By the processor's own kernels, too, which fuse: V to 1e-11 of the smaller tetrahedron's volume, in which
// coordinates are known to an ulp. Of itself a small V is known less well: an ulp of the coordinates changes
// it by as much as the two differ.
START_TEST(fused_kernels_differ_by_what_an_ulp_of_the_coordinates_does) {
  const Device *device = &devices[_i / MODELS];
  const char *model = models[_i % MODELS];
  double *pairs = memory_zeroed(COUNT * 24, sizeof *pairs);
  Answers told = make_answers(COUNT), expected = make_answers(COUNT);
  DeviceOverlap overlap;
  ck_assert_ok(device_overlap_create(&overlap, device, model));
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) {
    OverlapBatch batch = batch_of(pairs, COUNT, &told, DEVICE_VOLUME),
                 other = batch_of(pairs, COUNT, &expected, DEVICE_VOLUME);
    ck_assert_ok(app_bench_pairs_make(app_bench_sets[set], COUNT, 3, pairs));
    ck_assert_ok(device_overlap_eval(&overlap, &batch));
    ask_processor(model, &other, true);
    for (int i = 0; i < COUNT; i++)
      ck_assert_msg(fabs(told.volume[i] - expected.volume[i]) <=
                        1e-11 * overlap_invariant_smaller_volume(pairs + 24 * (size_t)i),
                    "%s, pair %d: V = %.17g, on the processor %.17g", app_bench_sets[set], i, told.volume[i],
                    expected.volume[i]);
  }
  device_overlap_destroy(&overlap);
  destroy_answers(&told), destroy_answers(&expected);
  memory_free(pairs);
}
END_TEST

START_TEST(hard_pairs_are_answered_to_rounding) {
  const Device *device = &devices[_i / MODELS];
  int count = DATAGEN_HARD_CLASS_COUNT * MEMBERS, inside = 0, blended = 0;
  double *pairs = memory_zeroed((size_t)count * 24, sizeof *pairs);
  for (int i = 0; i < count; i++)
    memcpy(pairs + (size_t)i * 24, datagen_hard_make(i / MEMBERS, i % MEMBERS).x, 24 * sizeof *pairs);
  check_batch(device, models[_i % MODELS], pairs, count, "hard pairs", &inside, &blended);
  ck_assert_int_gt(inside, count / 4);
  ck_assert_int_gt(blended, count / 20);
  memory_free(pairs);
}
END_TEST

// More pairs than the kernels take at a time; by columns, where neighbours in memory are other pairs.
START_TEST(many_pairs_are_answered_in_portions) {
  enum { MANY = DEVICE_GEO_ROOM + 77 };
  DeviceOverlap overlap;
  double *pairs = memory_zeroed((size_t)COUNT * 24, sizeof *pairs),
         *columns = memory_zeroed((size_t)MANY * 24, sizeof *columns);
  Answers few = make_answers(COUNT), many = make_answers(MANY);
  OverlapBatch batch = batch_of(pairs, COUNT, &few, DEVICE_GRADIENT);
  ck_assert_ok(app_bench_pairs_make("uniform", COUNT, 9, pairs));
  for (size_t i = 0; i < MANY; i++)
    for (size_t c = 0; c < 24; c++) columns[c * MANY + i] = pairs[i % COUNT * 24 + c];
  ck_assert_ok(device_overlap_create(&overlap, &devices[_i], "geo-small"));
  ck_assert_ok(device_overlap_eval(&overlap, &batch));
  ck_assert_ok(device_overlap_put_columns(&overlap, MANY, columns));
  ck_assert_ok(device_overlap_run(&overlap, DEVICE_GRADIENT));
  ck_assert_ok(device_overlap_get(&overlap, many.volume, many.more, many.flags));
  for (size_t i = 0; i < MANY; i++) {
    ck_assert(memcmp(&many.volume[i], &few.volume[i % COUNT], sizeof(double)) == 0);
    ck_assert_uint_eq(many.flags[i], few.flags[i % COUNT]);
    for (size_t c = 0; c < 24; c++)
      ck_assert(memcmp(&many.more[c * MANY + i], &few.more[i % COUNT * 24 + c], sizeof(double)) == 0);
  }
  device_overlap_destroy(&overlap);
  destroy_answers(&few), destroy_answers(&many);
  memory_free(pairs), memory_free(columns);
}
END_TEST

START_TEST(a_pair_that_is_not_finite_is_named) {
  expect_named(&devices[_i], "geo");
}
END_TEST

int main(void) {
  setenv("CK_FORK", "no", 1); // a driver's threads do not survive a fork
  open_devices();
  TCase *cases = tcase_create("device_geo");
  tcase_add_loop_test(cases, bench_sets_are_answered_to_rounding, 0, device_count * MODELS);
  tcase_add_loop_test(cases, fused_kernels_differ_by_what_an_ulp_of_the_coordinates_does, 0,
                      device_count * MODELS);
  tcase_add_loop_test(cases, hard_pairs_are_answered_to_rounding, 0, device_count * MODELS);
  tcase_add_loop_test(cases, many_pairs_are_answered_in_portions, 0, device_count);
  tcase_add_loop_test(cases, a_pair_that_is_not_finite_is_named, 0, device_count);
  int result = suite_run("device geo", cases, 300);
  close_devices();
  return result;
}

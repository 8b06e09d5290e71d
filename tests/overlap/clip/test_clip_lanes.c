// SPDX-License-Identifier: GPL-3.0-or-later
// Clipping on vectors: every kernel that this processor has against `exact`, and against each other bit by
// bit. Without any (no AVX2) only the batches are tested, which then go to `clip-scalar`.
#include "suite.h"

#include <string.h>

#include "app/bench/overlap/pairs.h"
#include "base/memory.h"
#include "base/random.h"
#include "datagen/hard.h"
#include "overlap/clip/clip.h"
#include "overlap/clip/lanes.h"
#include "overlap/exact/exact.h"
#include "overlap/pair/invariant.h"

enum { WIDEST = OVERLAP_CLIP_MAX_LANES, MEMBERS = 192 };

static const OverlapClipLanes *const *kernels;
static int kernel_count;

static bool is_single(const OverlapClipLanes *kernel) {
  return strstr(kernel->name, "single") != NULL;
}

static double volume_allowed(const OverlapClipLanes *kernel, const double x[24], double expected) {
  if (!is_single(kernel)) return overlap_invariant_allowed(x, expected);
  double smaller = overlap_invariant_smaller_volume(x);
  return expected > 0.1 * smaller ? 1e-3 * expected : 1e-4 * smaller;
}

typedef struct Group {
  double x[WIDEST][24], volume[WIDEST], gradient[WIDEST][24], centroid[WIDEST][3];
  OverlapClipLanesOutcome outcome;
} Group;

static void run(const OverlapClipLanes *kernel, Group *group) {
  group->outcome = kernel->locate(group->x[0], 0, group->volume, group->gradient[0], group->centroid[0]);
}

// The lanes that are not doubtful; how many they are.
static int check_group(const OverlapClipLanes *kernel, const Group *group, const char *what) {
  int sure = 0;
  for (int k = 0; k < kernel->width; k++) {
    double expected, expected_gradient[24], expected_centroid[3],
        extent = overlap_invariant_extent(group->x[k]);
    unsigned flags;
    if (group->outcome.doubtful >> k & 1) continue;
    ck_assert_ok(overlap_exact_ops.eval_pair(NULL, group->x[k],
                                             &(OverlapAnswer){.volume = &expected,
                                                              .gradient = expected_gradient,
                                                              .centroid = expected_centroid,
                                                              .flags = &flags}));
    ck_assert_msg(!(flags & OVERLAP_FLAT), "%s, %s: flat and not doubtful", kernel->name, what);
    ck_assert_msg(fabs(group->volume[k] - expected) <= volume_allowed(kernel, group->x[k], expected),
                  "%s, %s: V = %.17g, exact %.17g", kernel->name, what, group->volume[k], expected);
    double tolerance = (is_single(kernel) ? 2e-5 : 1e-12) * extent * extent;
    bool is_smooth = strncmp(what, "coplanar", 8) != 0 && strcmp(what, "identical but a few ulp") != 0;
    for (int c = 0; c < 24 && is_smooth; c++)
      ck_assert_msg(fabs(group->gradient[k][c] - expected_gradient[c]) <= tolerance,
                    "%s, %s: gradient %d is %g, exact %g", kernel->name, what, c, group->gradient[k][c],
                    expected_gradient[c]);
    const double *x = group->x[k];
    double allowed = extent * volume_allowed(kernel, x, expected);
    for (int c = 0; c < 3; c++) {
      double moment = group->volume[k] * (group->centroid[k][c] - x[c]);
      double wanted = expected * (expected_centroid[c] - x[c]);
      ck_assert_msg(fabs(moment - wanted) <= allowed, "%s, %s: moment %g, exact %g", kernel->name, what,
                    moment, wanted);
    }
    bool is_disjoint = group->outcome.disjoint >> k & 1;
    ck_assert_int_eq(is_disjoint, group->volume[k] == 0);
    if (expected > 1e-3 * overlap_invariant_smaller_volume(group->x[k]))
      ck_assert_int_eq(group->outcome.enclosed >> k & 1, (flags & OVERLAP_ENCLOSED) != 0);
    sure++;
  }
  return sure;
}

START_TEST(lanes_that_are_not_doubtful_are_right_in_every_class) {
  const OverlapClipLanes *kernel = kernels[_i];
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++) {
    int sure = 0;
    for (int member = 0; member < MEMBERS; member += kernel->width) {
      Group group;
      for (int k = 0; k < kernel->width; k++)
        memcpy(group.x[k], datagen_hard_make(c, member + k).x, sizeof group.x[k]);
      run(kernel, &group);
      sure += check_group(kernel, &group, datagen_hard_classes[c].name);
    }
    const char *name = datagen_hard_classes[c].name;
    bool is_ordinary = strcmp(name, "far") == 0 || strcmp(name, "boxes") == 0 ||
                       strcmp(name, "uniform") == 0 || strcmp(name, "inside") == 0 ||
                       strcmp(name, "inverted") == 0;
    // in single precision a small one inside a large one is lost in the noise of that
    if (is_ordinary && !(is_single(kernel) && strcmp(name, "inside") == 0))
      ck_assert_msg(sure >= MEMBERS * (is_single(kernel) ? 5 : 9) / 10, "%s: %d of %d", name, sure, MEMBERS);
    if (strcmp(name, "flat") == 0 || strcmp(name, "identical") == 0) ck_assert_int_eq(sure, 0);
  }
}
END_TEST

START_TEST(ordinary_pairs_are_hardly_ever_doubtful) {
  const OverlapClipLanes *kernel = kernels[_i];
  if (is_single(kernel)) {
    suite_skip("%s: in single precision many pairs are doubtful, which docs/models.md tells", kernel->name);
    return;
  }
  enum { COUNT = 4096 };
  double *pairs = memory_zeroed(COUNT * 24, sizeof *pairs);
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) {
    int sure = 0;
    ck_assert_ok(app_bench_pairs_make(app_bench_sets[set], COUNT, 11, pairs));
    for (int i = 0; i < COUNT; i += kernel->width) {
      Group group;
      memcpy(group.x[0], pairs + 24 * i, (size_t)kernel->width * sizeof group.x[0]);
      run(kernel, &group);
      sure += check_group(kernel, &group, app_bench_sets[set]);
      // the plane test alone never calls a pair apart that is not, and sees most of those that are
      ck_assert_uint_eq(kernel->separate(group.x[0]) & ~group.outcome.disjoint, 0);
    }
    // flat ones that only an edge keeps apart have to ask
    ck_assert_int_ge(sure, COUNT - COUNT / (strcmp(app_bench_sets[set], "disjoint") == 0 ? 100 : 1000));
  }
  memory_free(pairs);
}
END_TEST

// Vertices on a grid, the second's between those of the first: edges that meet edges, planes through grid
// lines, flat tetrahedra.
START_TEST(edges_that_meet_leave_lanes_right_or_doubtful) {
  const OverlapClipLanes *kernel = kernels[_i];
  Random random = random_seeded(57, 0);
  int sure = 0;
  for (int round = 0; round < 40000 / kernel->width; round++) {
    Group group;
    int steps = 1 + round % 8;
    for (int k = 0; k < kernel->width; k++)
      for (int c = 0; c < 24; c++)
        group.x[k][c] = (double)random_below(&random, steps + 1) / steps + (c < 12 ? 0 : 0.5 / steps);
    run(kernel, &group);
    sure += check_group(kernel, &group, "grid");
  }
  ck_assert_int_gt(sure, 10000);
}
END_TEST

// All orders of the vertices and tetrahedra of a pair must be right or doubtful; how many are doubtful.
static int check_orders(const OverlapClipLanes *kernel, const double x[24], const char *what) {
  enum { ORDERS = 2 * 24 * 24 };
  int sure = 0;
  for (int order = 0; order < ORDERS; order += kernel->width) {
    Group group;
    for (int k = 0; k < kernel->width; k++) {
      double swapped[24];
      overlap_ops_swap(x, swapped);
      const double *from = (order + k) & 1 ? swapped : x;
      datagen_hard_permute(from, (order + k) / 2 % 24, group.x[k]);
      datagen_hard_permute(from + 12, (order + k) / 48, group.x[k] + 12);
    }
    run(kernel, &group);
    sure += check_group(kernel, &group, what);
  }
  return ORDERS - sure;
}

// Found by tools/fuzz: the tip of a sliver in a large tetrahedron, whose cut faces are a millionth of the
// sliver's own.
START_TEST(small_faces_that_rounding_keeps_open_are_doubted) {
  static const double x[24] = {0x1.3p+11,    0x1.a8p+12,  0x1.46p+14, 0x1.327p+11,  0x1.6p+12,  0x1.ap+11,
                               0x1.3168p+11, -0x1.ccp+13, 0x1.8p+13,  0x1.3124p+11, 0x1.5p+12,  0x1.dcp+14,
                               0x1.3p+11,    0x1.dp+11,   0x1.46p+14, 0x1.f8p+14,   0x1.48p+12, 0x1.bcp+14,
                               0x1.48p+13,   0x1.5p+11,   0x1.7p+12,  0x1.2p+13,    0x1.16p+14, 0x1.c8p+12};
  ck_assert_int_gt(check_orders(kernels[_i], x, "tip of a sliver"), 0);
}
END_TEST

// Found by tools/fuzz: an edge of the one seems to end within the other, and the other's edge that it meets
// within the one, which cannot both be.
START_TEST(segments_that_end_twice_are_doubted) {
  static const double x[24] = {
      0x1.3424061d02a49p+20, 0x1.f85ee039e87d1p+25, 0x1.00f42403f7563p+28, 0x1.34240755660f6p+20,
      0x1.f85ee0408efe3p+25, 0x1.00f424036b502p+28, 0x1.34240382f7958p+20, 0x1.f85ee058fdf68p+25,
      0x1.00f424078444bp+28, 0x1.3424022ce2a92p+20, 0x1.f85ee03c6e9dfp+25, 0x1.00f4240bae195p+28,
      0x1.34240693f1b48p+20, 0x1.f85ee0426fbeap+25, 0x1.00f424053ebfcp+28, 0x1.34240382f8958p+20,
      0x1.f85ee058fdf68p+25, 0x1.00f424078444bp+28, 0x1.342407555ea26p+20, 0x1.f85ee0408efe3p+25,
      0x1.00f424036b502p+28, 0x1.3424022ce3a93p+20, 0x1.f85ee03c6e9dfp+25, 0x1.00f4240bae195p+28};
  ck_assert_int_gt(check_orders(kernels[_i], x, "edges that meet"), 0);
}
END_TEST

// Many of these are flat but for rounding, and what is found of their intersection may be anything.
START_TEST(flat_lanes_that_are_apart_have_no_volume) {
  const OverlapClipLanes *kernel = kernels[_i];
  Random random = random_seeded(58, 0);
  double rounding = is_single(kernel) ? 1e-5 : 1e-13;
  int apart = 0;
  for (int round = 0; round < 160000 / kernel->width; round++) {
    Group group;
    for (int k = 0; k < kernel->width; k++)
      for (int c = 0; c < 24; c++)
        group.x[k][c] = random_below(&random, 4) / 3.0 + (c < 12 ? 0 : 1.0 / 6) +
                        rounding * random_between(&random, -1, 1);
    run(kernel, &group);
    for (int k = 0; k < kernel->width; k++) {
      if (!(group.outcome.disjoint >> k & 1)) continue;
      ck_assert_msg(group.volume[k] == 0, "%s: V = %g", kernel->name, group.volume[k]);
      apart++;
    }
  }
  ck_assert_int_gt(apart, 100);
}
END_TEST

START_TEST(lanes_that_are_not_finite_are_doubtful) {
  const OverlapClipLanes *kernel = kernels[_i];
  static const double values[] = {NAN, INFINITY, -INFINITY};
  for (int number = 0; number < 24 * 3 * 8; number++) {
    Group group;
    for (int k = 0; k < kernel->width; k++)
      memcpy(group.x[k], datagen_hard_make(number % DATAGEN_HARD_CLASS_COUNT, number + k).x,
             sizeof group.x[k]);
    int lane = number % kernel->width;
    group.x[lane][number % 24] = values[number / 24 % 3];
    run(kernel, &group);
    ck_assert_msg(group.outcome.doubtful >> lane & 1, "%s: coordinate %d is %g and not doubtful",
                  kernel->name, number % 24, values[number / 24 % 3]);
  }
}
END_TEST

static void draw_any(int number, double x[24]) {
  memcpy(x, datagen_hard_make(number % DATAGEN_HARD_CLASS_COUNT, number).x, 24 * sizeof *x);
}

START_TEST(a_lane_knows_nothing_of_the_others) {
  const OverlapClipLanes *kernel = kernels[_i];
  for (int number = 0; number < 300; number++) {
    Group alone, among;
    for (int k = 0; k < WIDEST; k++) {
      draw_any(number, alone.x[k]);
      draw_any(7 * number + 13 * k + 1, among.x[k]);
    }
    int lane = number % kernel->width;
    memcpy(among.x[lane], alone.x[0], sizeof alone.x[0]);
    run(kernel, &alone), run(kernel, &among);
    ck_assert_uint_eq(alone.outcome.doubtful & 1, among.outcome.doubtful >> lane & 1);
    if (alone.outcome.doubtful & 1) continue;
    ck_assert_mem_eq(&alone.volume[0], &among.volume[lane], sizeof(double));
    ck_assert_mem_eq(alone.gradient[0], among.gradient[lane], sizeof alone.gradient[0]);
    ck_assert_mem_eq(alone.centroid[0], among.centroid[lane], sizeof alone.centroid[0]);
  }
}
END_TEST

// Also: V alone is the V that comes with ∇V and with x̄.
START_TEST(every_instruction_set_gives_the_same_bits) {
  for (int m = 1; m < kernel_count; m++) {
    if (is_single(kernels[m]) != is_single(kernels[m - 1])) continue;
    for (int number = 0; number < 3000; number += WIDEST) {
      Group groups[2];
      for (int side = 0; side < 2; side++) {
        const OverlapClipLanes *kernel = kernels[m - side];
        Group *group = &groups[side];
        for (int k = 0; k < WIDEST; k++) draw_any(number + k, group->x[k]);
        group->outcome.doubtful = 0;
        for (int first = 0; first < WIDEST; first += kernel->width) {
          double volume[WIDEST], located[WIDEST], gradient[WIDEST][24];
          OverlapClipLanesOutcome outcome =
              kernel->differentiate(group->x[first], 0, group->volume + first, group->gradient[first]);
          group->outcome.doubtful |= outcome.doubtful << first;
          outcome = kernel->measure(group->x[first], 0, volume);
          kernel->locate(group->x[first], 0, located, gradient[0], group->centroid[first]);
          for (int k = 0; k < kernel->width; k++)
            if (!(outcome.doubtful >> k & 1)) {
              ck_assert_mem_eq(&volume[k], &group->volume[first + k], sizeof *volume);
              ck_assert_mem_eq(&located[k], &group->volume[first + k], sizeof *volume);
              ck_assert_mem_eq(gradient[k], group->gradient[first + k], sizeof gradient[k]);
            }
        }
      }
      ck_assert_uint_eq(groups[0].outcome.doubtful, groups[1].outcome.doubtful);
      for (int k = 0; k < WIDEST; k++) {
        if (groups[0].outcome.doubtful >> k & 1) continue;
        ck_assert_mem_eq(&groups[0].volume[k], &groups[1].volume[k], sizeof(double));
        ck_assert_mem_eq(groups[0].gradient[k], groups[1].gradient[k], sizeof groups[0].gradient[k]);
        ck_assert_mem_eq(groups[0].centroid[k], groups[1].centroid[k], sizeof groups[0].centroid[k]);
      }
    }
  }
}
END_TEST

static const OverlapOps *const batched[2] = {&overlap_clip_ops, &overlap_clip32_ops};

// Sizes around the width of a vector and a portion; pairs of all classes and mostly disjoint ones, so that
// groups are full, half full, and wait.
START_TEST(a_batch_answers_each_pair_as_if_it_were_alone) {
  static const int sizes[] = {1, 3, 7, 8, 9, 17, 33, 511, 513, 1100};
  enum { MOST = 1100 };
  const OverlapOps *ops = batched[_i / 2];
  double *x = memory_zeroed(MOST * 24, sizeof *x), *gradient = memory_zeroed(MOST * 24, sizeof *gradient);
  static double volume[MOST];
  static unsigned flags[MOST];
  for (int i = 0; i < MOST; i++) {
    draw_any(i, x + 24 * i);
    if (_i % 2 && i % 5)
      for (int c = 12; c < 24; c++) x[24 * i + c] += 3 * overlap_invariant_extent(x + 24 * i);
  }
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
    OverlapBatch batch = {
        .pair_count = sizes[s], .pairs = x, .volume = volume, .gradient = gradient, .flags = flags};
    memset(volume, 0xff, sizeof volume), memset(gradient, 0xff, MOST * 24 * sizeof *gradient);
    ck_assert_ok(ops->eval_batch(NULL, &batch));
    for (int i = 0; i < sizes[s]; i++) {
      double alone, slope[24];
      unsigned flag;
      ck_assert_ok(ops->eval_pair(NULL, x + 24 * i,
                                  &(OverlapAnswer){.volume = &alone, .gradient = slope, .flags = &flag}));
      ck_assert_msg(alone == volume[i] && flag == flags[i], "pair %d of %d: %g, alone %g", i, sizes[s],
                    volume[i], alone);
      ck_assert_mem_eq(slope, gradient + 24 * i, sizeof slope);
      ck_assert_int_eq((flag & (OVERLAP_DISJOINT | OVERLAP_FLAT)) != 0, alone == 0);
    }
  }
  memory_free(x), memory_free(gradient);
}
END_TEST

START_TEST(the_scalar_form_gives_the_same_up_to_rounding) {
  for (int number = 0; number < 3000; number++) {
    double x[24], volume[2], gradient[24];
    unsigned flags[2];
    draw_any(number, x);
    ck_assert_ok(overlap_clip_ops.eval_pair(
        NULL, x, &(OverlapAnswer){.volume = &volume[0], .gradient = gradient, .flags = &flags[0]}));
    ck_assert_ok(overlap_clip_scalar_ops.eval_pair(
        NULL, x, &(OverlapAnswer){.volume = &volume[1], .gradient = gradient, .flags = &flags[1]}));
    ck_assert_msg(fabs(volume[0] - volume[1]) <= 2 * overlap_invariant_allowed(x, volume[1]),
                  "pair %d: %g, scalar %g", number, volume[0], volume[1]);
  }
}
END_TEST

int main(void) {
  kernels = overlap_clip_lanes_list(&kernel_count);
  TCase *cases = tcase_create("clip_lanes");
  tcase_add_loop_test(cases, lanes_that_are_not_doubtful_are_right_in_every_class, 0, kernel_count);
  tcase_add_loop_test(cases, ordinary_pairs_are_hardly_ever_doubtful, 0, kernel_count);
  tcase_add_loop_test(cases, edges_that_meet_leave_lanes_right_or_doubtful, 0, kernel_count);
  tcase_add_loop_test(cases, small_faces_that_rounding_keeps_open_are_doubted, 0, kernel_count);
  tcase_add_loop_test(cases, segments_that_end_twice_are_doubted, 0, kernel_count);
  tcase_add_loop_test(cases, flat_lanes_that_are_apart_have_no_volume, 0, kernel_count);
  tcase_add_loop_test(cases, lanes_that_are_not_finite_are_doubtful, 0, kernel_count);
  tcase_add_loop_test(cases, a_lane_knows_nothing_of_the_others, 0, kernel_count);
  tcase_add_test(cases, every_instruction_set_gives_the_same_bits);
  tcase_add_loop_test(cases, a_batch_answers_each_pair_as_if_it_were_alone, 0, 4);
  tcase_add_test(cases, the_scalar_form_gives_the_same_up_to_rounding);
  return suite_run("clip lanes", cases, 60);
}

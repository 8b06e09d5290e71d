// SPDX-License-Identifier: GPL-3.0-or-later
// The centroid x̄ of the intersection, of every overlap model that has one of its own and is exact to
// rounding. The oracle is `exact`, whose own oracles are cases that a hand can compute, sums over parts, and
// `cgal`.
#include "suite.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

#include "datagen/hard.h"
#include "overlap/exact/exact.h"
#include "overlap/models.h"
#include "overlap/pair/invariant.h"

// How far V may be off, as shares of V and of the smaller volume, whichever is less strict; the moment V x̄
// may be off by the extent times that.
typedef struct Demand {
  const char *name;
  double of_volume, of_smaller;
  double ordinary; // share of the extent that x̄ of an ordinary pair may be off
  int members;     // of each hard class
} Demand;

static const Demand demands[] = {
    {"clip", 1e-9, 1e-12, 1e-12, 100},
    {"clip32", 1e-3, 1e-4, 1e-3, 100},
    {"clip-scalar", 1e-9, 1e-12, 1e-12, 100},
    {"exact", 1e-15, 0, 1e-15, 100},
    {"cgal", 1e-15, 0, 1e-15, 3},
};
enum { DEMANDS = sizeof demands / sizeof *demands };

typedef struct Answer {
  double volume, centroid[3];
  unsigned flags;
} Answer;

static Answer ask(const OverlapModel *model, const double x[24]) {
  Answer answer = {.volume = NAN, .centroid = {NAN, NAN, NAN}};
  OverlapBatch batch = {.pair_count = 1,
                        .pairs = x,
                        .volume = &answer.volume,
                        .flags = &answer.flags,
                        .centroid = answer.centroid};
  ck_assert_ok(overlap_model_eval(model, &batch));
  return answer;
}

static Answer ask_exact(const double x[24]) {
  OverlapModel exact = {.ops = &overlap_exact_ops};
  return ask(&exact, x);
}

static OverlapModel open_model(int index) {
  OverlapModel model;
  ck_assert_ok(overlap_models_create(&model, demands[index].name));
  ck_assert(overlap_model_has_own_centroid(&model));
  return model;
}

// The moment relative to a point.
static void moment_about(const double point[3], const Answer *answer, double moment[3]) {
  for (int c = 0; c < 3; c++) moment[c] = answer->volume * (answer->centroid[c] - point[c]);
}

static double largest_coordinate(const double x[24]) {
  double largest = 0;
  for (int i = 0; i < 24; i++) largest = fmax(largest, fabs(x[i]));
  return largest;
}

// How far V may be off [m³].
static double volume_allowed(const Demand *demand, const double x[24], double volume) {
  double of_smaller = demand->of_smaller * overlap_invariant_smaller_volume(x);
  return fmax(demand->of_volume * volume, of_smaller);
}

// How far the moment may be off [m⁴]: what V may, and the rounding of x̄ itself.
static double moment_allowed(const Demand *demand, const double x[24], double volume) {
  return overlap_invariant_extent(x) * volume_allowed(demand, x, volume) +
         DBL_EPSILON * largest_coordinate(x) * volume;
}

static void compare(const Demand *demand, const double x[24], const Answer *answer, const Answer *expected,
                    double slack, const char *where) {
  double moment[3], wanted[3], allowed = moment_allowed(demand, x, expected->volume) + slack;
  moment_about(x, answer, moment);
  moment_about(x, expected, wanted);
  for (int c = 0; c < 3; c++)
    ck_assert_msg(fabs(moment[c] - wanted[c]) <= allowed, "%s: moment %c = %g, not %g: off by %.3g > %.3g",
                  where, "xyz"[c], moment[c], wanted[c], fabs(moment[c] - wanted[c]), allowed);
}

typedef void PairCheck(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                       const char *where);

static void for_each_pair(int index, PairCheck *check) {
  OverlapModel model = open_model(index);
  const Demand *demand = &demands[index];
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    for (int member = 0; member < demand->members; member++) {
      char where[96];
      snprintf(where, sizeof where, "%s: %s, member %d", demand->name, datagen_hard_classes[c].name, member);
      DatagenHardPair pair = datagen_hard_make(c, member);
      check(&model, demand, &pair, where);
    }
  overlap_model_destroy(&model);
}

// ---- Cases that a hand can compute.

static const double unit[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

// scale · (the unit tetrahedron) + shift
static void place(double tet[12], double scale, const double shift[3]) {
  for (int i = 0; i < 12; i++) tet[i] = scale * unit[i] + shift[i % 3];
}

START_TEST(cases_that_a_hand_can_compute) {
  OverlapModel model = open_model(_i);
  double x[24], tolerance = 4 * fmax(demands[_i].ordinary, DBL_EPSILON);
  // two of the same shape: what is common is that shape again, smaller
  place(x, 1, (double[]){0, 0, 0}), place(x + 12, 1, (double[]){0.25, 0.125, 0});
  Answer answer = ask(&model, x);
  ck_assert_near(answer.volume, pow(0.625, 3) / 6, tolerance);
  ck_assert_near(answer.centroid[0], 0.25 + 0.625 / 4, tolerance);
  ck_assert_near(answer.centroid[1], 0.125 + 0.625 / 4, tolerance);
  ck_assert_near(answer.centroid[2], 0.625 / 4, tolerance);
  // one within the other: its own mean
  place(x, 8, (double[]){-2, -2, -2});
  answer = ask(&model, x);
  ck_assert_uint_eq(answer.flags & OVERLAP_ENCLOSED, OVERLAP_ENCLOSED);
  ck_assert_near(answer.centroid[0], 0.5, 8 * tolerance);
  ck_assert_near(answer.centroid[1], 0.375, 8 * tolerance);
  ck_assert_near(answer.centroid[2], 0.25, 8 * tolerance);
  // the same twice
  memcpy(x, x + 12, 12 * sizeof *x);
  answer = ask(&model, x);
  ck_assert_near(answer.centroid[1], 0.375, tolerance);
  // x, y, z ≥ 0 and x + y + z ≤ ½, cut off by one face of the second
  place(x, 1, (double[]){0, 0, 0}), place(x + 12, 4, (double[]){0, 0, -3.5});
  answer = ask(&model, x);
  ck_assert_near(answer.volume, 1.0 / 48, tolerance);
  for (int c = 0; c < 3; c++) ck_assert_near(answer.centroid[c], 0.125, tolerance);
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(without_common_interior_it_is_zero) {
  OverlapModel model = open_model(_i);
  double x[24];
  place(x, 1, (double[]){3, 3, 3}), place(x + 12, 1, (double[]){5, 3, 3});
  for (int touching = 0; touching < 2; touching++) {
    Answer answer = ask(&model, x);
    ck_assert_uint_eq(answer.flags & OVERLAP_DISJOINT, OVERLAP_DISJOINT);
    ck_assert(answer.volume == 0);
    for (int c = 0; c < 3; c++) ck_assert(answer.centroid[c] == 0);
    place(x + 12, 1, (double[]){4, 3, 3});
  }
  x[11] = x[2]; // flat
  Answer answer = ask(&model, x);
  for (int c = 0; c < 3; c++) ck_assert(answer.centroid[c] == 0);
  overlap_model_destroy(&model);
}
END_TEST

// ---- Hard pairs.

static void check_moment(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                         const char *where) {
  Answer answer = ask(model, pair->x), expected = ask_exact(pair->x);
  compare(demand, pair->x, &answer, &expected, 0, where);
  for (int c = 0; c < 3 && answer.volume > 0; c++) {
    double low = INFINITY, high = -INFINITY, slack = DBL_EPSILON * largest_coordinate(pair->x);
    for (int i = c; i < 24; i += 3) low = fmin(low, pair->x[i]), high = fmax(high, pair->x[i]);
    ck_assert_msg(answer.centroid[c] >= low - slack && answer.centroid[c] <= high + slack,
                  "%s: outside of the pair's box", where);
  }
}

START_TEST(moments_are_right_in_every_class) {
  for_each_pair(_i, check_moment);
}
END_TEST

static void check_exchange(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                           const char *where) {
  double swapped[24], permuted[24];
  Answer answer = ask(model, pair->x);
  overlap_ops_swap(pair->x, swapped);
  Answer other = ask(model, swapped);
  compare(demand, pair->x, &other, &answer, moment_allowed(demand, pair->x, answer.volume), where);
  for (int k = 1; k < 24; k += 7) {
    datagen_hard_permute(pair->x, k, permuted);
    datagen_hard_permute(pair->x + 12, (5 * k + 3) % 24, permuted + 12);
    other = ask(model, permuted);
    compare(demand, pair->x, &other, &answer, moment_allowed(demand, pair->x, answer.volume), where);
  }
}

START_TEST(it_depends_on_no_order) {
  for_each_pair(_i, check_exchange);
}
END_TEST

// What rounding of moved coordinates may change of the moment, over ε.
static double rounding_scale(const double x[24]) {
  return largest_coordinate(x) * pow(overlap_invariant_extent(x), 3);
}

static void check_motion(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                         const char *where) {
  double moved[24], rotation[9], extent = overlap_invariant_extent(pair->x);
  Vec3 shift = {extent, -2 * extent, extent};
  Answer answer = ask(model, pair->x);
  Random random = random_seeded(77, 0);
  random_rotation(&random, rotation);
  memcpy(moved, pair->x, sizeof moved);
  datagen_hard_transform(moved, 8, rotation, 1, shift);
  Answer there = ask(model, moved), carried = {.volume = answer.volume};
  memcpy(carried.centroid, answer.centroid, sizeof carried.centroid);
  datagen_hard_transform(carried.centroid, 1, rotation, 1, shift);
  double slack = 16 * DBL_EPSILON * (rounding_scale(pair->x) + rounding_scale(moved));
  compare(demand, moved, &there, &carried, slack + moment_allowed(demand, pair->x, answer.volume), where);

  for (int i = 0; i < 24; i++) moved[i] = 0x1p20 * pair->x[i];
  Answer scaled = ask(model, moved);
  scaled.volume *= 0x1p-60;
  for (int c = 0; c < 3; c++) scaled.centroid[c] *= 0x1p-20;
  compare(demand, pair->x, &scaled, &answer, moment_allowed(demand, pair->x, answer.volume), where);
}

START_TEST(it_moves_and_grows_with_the_pair) {
  for_each_pair(_i, check_motion);
}
END_TEST

static void check_subdivision(const OverlapModel *model, const Demand *demand, const DatagenHardPair *pair,
                              const char *where) {
  const double weights[4] = {0.125, 0.25, 0.25, 0.375};
  double parts[4][12], whole = overlap_invariant_tet_volume(pair->x + 12), sum_of_parts = 0;
  datagen_hard_subdivide(pair->x + 12, weights, parts);
  for (int k = 0; k < 4; k++) sum_of_parts += overlap_invariant_tet_volume(parts[k]);
  if (!(fabs(sum_of_parts - whole) <= 1e-13 * whole) || pair->is_flat) return; // rounded out of a sliver
  Answer answer = ask(model, pair->x);
  double moment[3], sum[3] = {0}, allowed = moment_allowed(demand, pair->x, answer.volume);
  moment_about(pair->x, &answer, moment);
  for (int k = 0; k < 4; k++) {
    double x[24], part[3];
    memcpy(x, pair->x, 12 * sizeof *x), memcpy(x + 12, parts[k], 12 * sizeof *x);
    Answer of_part = ask(model, x);
    moment_about(pair->x, &of_part, part);
    for (int c = 0; c < 3; c++) sum[c] += part[c];
    allowed += moment_allowed(demand, x, of_part.volume);
  }
  // the parts' common vertex is rounded
  allowed += 1e-13 * whole * overlap_invariant_extent(pair->x) + 16 * DBL_EPSILON * rounding_scale(pair->x);
  for (int c = 0; c < 3; c++)
    ck_assert_msg(fabs(sum[c] - moment[c]) <= allowed, "%s: parts sum to %g, not %g", where, sum[c],
                  moment[c]);
}

START_TEST(the_parts_moments_sum_to_the_whole) {
  for_each_pair(_i, check_subdivision);
}
END_TEST

// ---- Ordinary pairs.

static void make_ordinary(Random *random, DatagenHardPair *pair) {
  datagen_hard_fat(random, pair, 0), datagen_hard_fat(random, pair, 1);
}

START_TEST(ordinary_pairs_have_it_to_many_digits) {
  OverlapModel model = open_model(_i);
  Random random = random_seeded(13, 0);
  double worst = 0;
  int seen = 0, count = demands[_i].members < 10 ? 40 : 20000;
  for (int k = 0; k < count; k++) {
    DatagenHardPair pair = {0};
    make_ordinary(&random, &pair);
    Answer expected = ask_exact(pair.x);
    if (!(expected.volume > 1e-4 * overlap_invariant_smaller_volume(pair.x))) continue;
    Answer answer = ask(&model, pair.x);
    for (int c = 0; c < 3; c++)
      worst = suite_larger(worst, fabs(answer.centroid[c] - expected.centroid[c]) /
                                      overlap_invariant_extent(pair.x));
    seen++;
  }
  ck_assert_int_ge(seen, count / 4);
  ck_assert_msg(worst <= demands[_i].ordinary, "%s: off by %.3g", demands[_i].name, worst);
  overlap_model_destroy(&model);
}
END_TEST

// ---- Batches.

enum { BATCH = 33 * 40 };

START_TEST(asking_for_it_changes_nothing_else) {
  OverlapModel model = open_model(_i);
  static double x[BATCH * 24], volume[3][BATCH], gradient[2][BATCH * 24], centroid[2][BATCH * 3];
  static unsigned flags[3][BATCH];
  int count = demands[_i].members < 10 ? 66 : BATCH;
  for (int k = 0; k < count; k++)
    memcpy(x + 24 * k, datagen_hard_make(k % DATAGEN_HARD_CLASS_COUNT, k).x, 24 * sizeof *x);
  OverlapBatch batch = {
      .pair_count = count, .pairs = x, .volume = volume[0], .gradient = gradient[0], .flags = flags[0]};
  ck_assert_ok(overlap_model_eval(&model, &batch));
  batch.volume = volume[1], batch.gradient = gradient[1], batch.flags = flags[1];
  batch.centroid = centroid[0];
  ck_assert_ok(overlap_model_eval(&model, &batch));
  batch.volume = volume[2], batch.gradient = NULL, batch.flags = flags[2];
  batch.centroid = centroid[1];
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert_mem_eq(gradient[0], gradient[1], 24 * sizeof *x * (size_t)count);
  ck_assert_mem_eq(centroid[0], centroid[1], 3 * sizeof *x * (size_t)count);
  for (int k = 1; k < 3; k++) {
    ck_assert_mem_eq(volume[0], volume[k], sizeof *x * (size_t)count);
    ck_assert_mem_eq(flags[0], flags[k], sizeof flags[0][0] * (size_t)count);
  }
  for (int k = 0; k < count; k++) { // and what one pair gets hangs on no other
    Answer alone = ask(&model, x + 24 * k);
    ck_assert(alone.volume == volume[0][k]);
    ck_assert_mem_eq(alone.centroid, centroid[0] + 3 * k, sizeof alone.centroid);
  }
  overlap_model_destroy(&model);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("centroid");
  tcase_add_loop_test(cases, cases_that_a_hand_can_compute, 0, DEMANDS);
  tcase_add_loop_test(cases, without_common_interior_it_is_zero, 0, DEMANDS);
  tcase_add_loop_test(cases, moments_are_right_in_every_class, 0, DEMANDS);
  tcase_add_loop_test(cases, it_depends_on_no_order, 0, DEMANDS);
  tcase_add_loop_test(cases, it_moves_and_grows_with_the_pair, 0, DEMANDS);
  tcase_add_loop_test(cases, the_parts_moments_sum_to_the_whole, 0, DEMANDS);
  tcase_add_loop_test(cases, ordinary_pairs_have_it_to_many_digits, 0, DEMANDS);
  tcase_add_loop_test(cases, asking_for_it_changes_nothing_else, 0, DEMANDS);
  return suite_run("centroid", cases, 60);
}

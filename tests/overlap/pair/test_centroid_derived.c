// SPDX-License-Identifier: GPL-3.0-or-later
// The centroid that follows from V and ∇V (overlap/pair/centroid.h). The oracles are cases that a hand can
// compute and the centroids that clip and exact have of their own.
#include "suite.h"

#include <float.h>
#include <string.h>

#include "base/random.h"
#include "base/vec3.h"
#include "datagen/hard.h"
#include "overlap/clip/clip.h"
#include "overlap/exact/exact.h"
#include "overlap/models.h"
#include "overlap/pair/centroid.h"

enum { PAIRS = 200 };

typedef struct Answer {
  double volume, gradient[24], centroid[3];
} Answer;

static Answer ask(const OverlapModel *model, const double x[24]) {
  Answer answer;
  OverlapBatch batch = {.pair_count = 1,
                        .pairs = x,
                        .volume = &answer.volume,
                        .gradient = answer.gradient,
                        .centroid = answer.centroid};
  ck_assert_ok(overlap_model_eval(model, &batch));
  return answer;
}

static const OverlapModel asked[] = {{.ops = &overlap_clip_ops}, {.ops = &overlap_exact_ops}};

static void swap_vertices(double tet[12]) {
  double first[3];
  memcpy(first, tet, sizeof first);
  memcpy(tet, tet + 3, sizeof first);
  memcpy(tet + 3, first, sizeof first);
}

// A random pair that overlaps by more than a thousandth of either edge's cube.
static void draw_pair(Random *random, double x[24]) {
  Answer answer = {0};
  while (!(answer.volume > 1e-3)) {
    for (int i = 0; i < 24; i++) x[i] = random_uniform(random);
    answer = ask(&asked[0], x);
  }
}

static double distance(const double a[3], const double b[3]) {
  return vec3_length(vec3_sub(vec3_at(a), vec3_at(b)));
}

// `scale` · x + `shift`; `turned`: which tetrahedra are given in the other orientation, bits.
static void check_placed(const double shape[24], double scale, double shift, int turned) {
  double x[24];
  for (int i = 0; i < 24; i++) x[i] = scale * shape[i] + (i % 3 + 1) * shift;
  for (int t = 0; t < 2; t++)
    if (turned >> t & 1) swap_vertices(x + 12 * t);
  for (int m = 0; m < 2; m++) {
    Answer own = ask(&asked[m], x);
    double derived[3], size = cbrt(own.volume);
    // far from the origin the vertices themselves are rounded, and so is each model's own centroid
    double rounding = 16 * DBL_EPSILON * fabs(shift) * pow(scale / size, 2);
    overlap_centroid_derive(x, own.volume, own.gradient, derived);
    ck_assert_double_le(distance(derived, own.centroid), 1e-8 * size + rounding);
  }
}

START_TEST(it_is_the_models_own_of_random_pairs_however_placed) {
  Random random = random_seeded(41, 0);
  for (int k = 0; k < PAIRS; k++) {
    double x[24];
    draw_pair(&random, x);
    for (int turned = 0; turned < 4; turned++) check_placed(x, 1, 0, turned);
    check_placed(x, 1e-3, 0, 0);
    check_placed(x, 1e3, 0, 3);
    check_placed(x, 1, 1e4, 0);
    check_placed(x, 1, -1e4, 2);
  }
}
END_TEST

START_TEST(cases_that_a_hand_can_compute) {
  static const double unit[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  double x[24], derived[3];
  // of the same shape: what is common is that shape again, of edge 1 − ¼ − ⅛
  for (int i = 0; i < 12; i++) x[i] = x[12 + i] = unit[i];
  for (int v = 0; v < 4; v++) x[12 + 3 * v] += 0.25, x[13 + 3 * v] += 0.125;
  Answer answer = ask(&asked[1], x);
  overlap_centroid_derive(x, answer.volume, answer.gradient, derived);
  ck_assert_near(derived[0], 0.25 + 0.625 / 4, 1e-15);
  ck_assert_near(derived[1], 0.125 + 0.625 / 4, 1e-15);
  ck_assert_near(derived[2], 0.625 / 4, 1e-15);
  // one within the other: its own mean
  for (int i = 0; i < 12; i++) x[i] = 8 * unit[i] - 2;
  answer = ask(&asked[1], x);
  overlap_centroid_derive(x, answer.volume, answer.gradient, derived);
  ck_assert_near(derived[0], 0.5, 1e-15);
  ck_assert_near(derived[1], 0.375, 1e-15);
  ck_assert_near(derived[2], 0.25, 1e-15);
}
END_TEST

static bool is_within(const double x[24], const double point[3]) {
  for (int t = 0; t < 2; t++)
    for (int c = 0; c < 3; c++) {
      double low = INFINITY, high = -INFINITY;
      for (int v = 0; v < 4; v++) {
        low = fmin(low, x[12 * t + 3 * v + c]);
        high = fmax(high, x[12 * t + 3 * v + c]);
      }
      if (!(low <= point[c] && point[c] <= high)) return false;
    }
  return true;
}

START_TEST(of_slivers_and_flat_tetrahedra_it_is_within_both_boxes) {
  int flat = 0, overlapping = 0;
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    for (int member = 0; member < 100; member++) {
      double derived[3];
      DatagenHardPair pair = datagen_hard_make(c, member);
      Answer answer = ask(&asked[0], pair.x);
      overlap_centroid_derive(pair.x, answer.volume, answer.gradient, derived);
      if (answer.volume > 0)
        ck_assert_msg(is_within(pair.x, derived), "%s, member %d", datagen_hard_classes[c].name, member);
      else
        ck_assert(derived[0] == 0 && derived[1] == 0 && derived[2] == 0);
      overlapping += answer.volume > 0, flat += !(answer.volume > 0);
    }
  ck_assert_int_gt(overlapping, 100);
  ck_assert_int_gt(flat, 0);
}
END_TEST

// Halfway between boxes that are apart, where the model tells of a volume that there is not.
START_TEST(what_no_volume_can_have_is_clamped_and_finite) {
  double x[24], gradient[24], derived[3];
  Random random = random_seeded(43, 0);
  draw_pair(&random, x);
  for (int i = 0; i < 24; i++) gradient[i] = 1e6 * (random_uniform(&random) - 0.5);
  overlap_centroid_derive(x, 1e-9, gradient, derived);
  ck_assert(is_within(x, derived));
  gradient[7] = NAN, gradient[19] = INFINITY;
  overlap_centroid_derive(x, 1e-9, gradient, derived);
  ck_assert(is_within(x, derived));
  overlap_centroid_derive(x, 5e-324, gradient, derived);
  ck_assert(is_within(x, derived));
  for (int v = 0; v < 4; v++) x[12 + 3 * v] += 3;
  overlap_centroid_derive(x, 1e-9, gradient, derived);
  double high = fmax(fmax(x[0], x[3]), fmax(x[6], x[9])), low = fmin(fmin(x[12], x[15]), fmin(x[18], x[21]));
  ck_assert_near(derived[0], (low + high) / 2, 1e-15);
  overlap_centroid_derive(x, 0, gradient, derived);
  ck_assert(derived[0] == 0 && derived[1] == 0 && derived[2] == 0);
}
END_TEST

static const char *const networks[] = {"tpn", "tpn-bf16", "tpn-scene", "tpn-published"};
enum { NETWORKS = sizeof networks / sizeof *networks };

START_TEST(models_without_their_own_have_it_too) {
  OverlapModel model;
  ck_assert_ok(overlap_models_create(&model, networks[_i]));
  ck_assert(!overlap_model_has_own_centroid(&model));
  Random random = random_seeded(47, 0);
  double off = 0, off_middle = 0;
  for (int k = 0; k < PAIRS; k++) {
    double x[24], centroid[3], derived[3], middle[3], volume, no_gradient[24] = {0};
    draw_pair(&random, x);
    Answer told = ask(&model, x), truth = ask(&asked[0], x);
    overlap_centroid_derive(x, told.volume, told.gradient, derived);
    ck_assert_mem_eq(told.centroid, derived, sizeof derived);
    OverlapBatch batch = {.pair_count = 1, .pairs = x, .volume = &volume, .centroid = centroid};
    ck_assert_ok(overlap_model_eval(&model, &batch)); // with no place for the gradient
    ck_assert_mem_eq(centroid, derived, sizeof derived);
    if (!(told.volume > 0)) continue;
    overlap_centroid_derive(x, told.volume, no_gradient, middle);
    off += truth.volume * distance(derived, truth.centroid);
    off_middle += truth.volume * distance(middle, truth.centroid);
  }
  // it means something: nearer than the middle of what is common to both boxes. tpn-published learns V
  // without a scale, so its gradient says nothing of the kind.
  if (strcmp(networks[_i], "tpn-published") != 0) ck_assert_double_le(off, 0.8 * off_middle);
  overlap_model_destroy(&model);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("derived centroid");
  tcase_add_test(cases, it_is_the_models_own_of_random_pairs_however_placed);
  tcase_add_test(cases, cases_that_a_hand_can_compute);
  tcase_add_test(cases, of_slivers_and_flat_tetrahedra_it_is_within_both_boxes);
  tcase_add_test(cases, what_no_volume_can_have_is_clamped_and_finite);
  tcase_add_loop_test(cases, models_without_their_own_have_it_too, 0, NETWORKS);
  return suite_run("centroid_derived", cases, 60);
}

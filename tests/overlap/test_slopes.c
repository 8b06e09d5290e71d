// SPDX-License-Identifier: GPL-3.0-or-later
// ∂x̄/∂x of overlap models against central differences of x̄, of a randomly drawn pair after the other.
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "folder.h"
#include "overlap/models.h"
#include "overlap/pair/invariant.h"
#include "overlap/separation.h"
#include "overlap/slopes.h"

enum { SIZE = OVERLAP_PAIR_SIZE, PAIRS = 300 };

// Through geo with and without a share of clipping, and through V and ∇V.
static const char *const names[] = {"geo",         "geo-small",          "hybrid", "hybrid=geo", "both=geo",
                                    "fade:.3=geo", "coplanar=placed=geo"};

// Edges of about 1; centres so near that most intersect.
static void draw(Random *random, double pair[SIZE]) {
  for (int t = 0; t < 2; t++) {
    double centre[3];
    for (int c = 0; c < 3; c++) centre[c] = 0.25 * suite_normal(random);
    do
      for (int i = 0; i < SIZE / 2; i++)
        pair[SIZE / 2 * t + i] = centre[i % 3] + 2 * random_uniform(random) - 1;
    while (!(overlap_invariant_tet_volume(pair + SIZE / 2 * t) > 0.05));
  }
}

static void centroid_at(const OverlapModel *model, const double pair[SIZE], int i, double by, double x[3]) {
  double moved[SIZE], volume;
  memcpy(moved, pair, sizeof moved);
  moved[i] += by;
  ck_assert_ok(overlap_model_eval(
      model, &(OverlapBatch){.pair_count = 1, .pairs = moved, .volume = &volume, .centroid = x}));
}

// By a difference of fourth order; how far it is from that of half the step.
static double differ(const OverlapModel *model, const double pair[SIZE], int i, double found[3]) {
  double of_step[2][3], apart = 0;
  for (int k = 0; k < 2; k++) {
    static const double places[] = {-2, -1, 1, 2}, weights[] = {1.0 / 12, -2.0 / 3, 2.0 / 3, -1.0 / 12};
    double step = k == 0 ? 2e-4 : 1e-4;
    memset(of_step[k], 0, sizeof of_step[k]);
    for (int p = 0; p < 4; p++) {
      double x[3];
      centroid_at(model, pair, i, places[p] * step, x);
      for (int c = 0; c < 3; c++) of_step[k][c] += weights[p] / step * x[c];
    }
  }
  for (int c = 0; c < 3; c++) {
    found[c] = of_step[1][c];
    apart = fmax(apart, fabs(of_step[1][c] - of_step[0][c]));
  }
  return apart;
}

// Where two differences agree, there is no kink between: there the slopes are theirs.
START_TEST(slopes_agree_with_differences) {
  OverlapModel model;
  Random random = random_seeded(5, 0);
  int compared = 0, kinks = 0;
  ck_assert_ok(overlap_models_create(&model, names[_i]));
  ck_assert(overlap_slopes_are_there(&model));
  for (int n = 0; n < PAIRS; n++) {
    double pair[SIZE], volume, gradient[SIZE], slopes[3 * SIZE];
    draw(&random, pair);
    ck_assert_ok(overlap_slopes_eval(
        &model, &(OverlapBatch){.pair_count = 1, .pairs = pair, .volume = &volume, .gradient = gradient},
        slopes));
    if (!(volume > 1e-4)) continue;
    for (int i = 0; i < SIZE; i++) {
      double found[3];
      if (differ(&model, pair, i, found) > 1e-7) {
        kinks++;
        continue;
      }
      compared++;
      for (int c = 0; c < 3; c++)
        ck_assert_msg(fabs(slopes[SIZE * c + i] - found[c]) <= 1e-8,
                      "%s, pair %d: ∂x̄_%d/∂x_%d = %.12g, differences %.12g", names[_i], n, c, i,
                      slopes[SIZE * c + i], found[c]);
    }
  }
  printf("%s: %d compared, %d kinks\n", names[_i], compared, kinks);
  ck_assert_int_gt(compared, 2000);
  ck_assert_int_lt(10 * kinks, compared);
  overlap_model_destroy(&model);
}
END_TEST

// The network gives volumes to disjoint pairs, too; faded in, none to these.
START_TEST(slopes_where_clip_finds_no_overlap) {
  static const char *const words[] = {"placed=tpn-published", "placed=fade=tpn-published"};
  OverlapModel model;
  Random random = random_seeded(9, 0);
  int compared = 0, none = 0;
  ck_assert_ok(overlap_models_create(&model, words[_i]));
  for (int n = 0; n < 8 * PAIRS; n++) {
    double pair[SIZE], volume, gradient[SIZE], slopes[3 * SIZE];
    draw(&random, pair);
    for (int v = 0; v < SIZE / 2; v += 3) pair[v] += 0.5;
    if (overlap_separation_pair(pair, 0) < 1e-3) continue;
    ck_assert_ok(overlap_slopes_eval(
        &model, &(OverlapBatch){.pair_count = 1, .pairs = pair, .volume = &volume, .gradient = gradient},
        slopes));
    none += volume == 0;
    for (int i = 0; i < SIZE; i++) {
      double found[3] = {0};
      if (volume > 0 && differ(&model, pair, i, found) > 1e-7) continue;
      compared += volume > 0;
      for (int c = 0; c < 3; c++) ck_assert_near(slopes[SIZE * c + i], found[c], 1e-8);
    }
  }
  if (_i == 0) ck_assert_int_gt(compared, 200);
  if (_i == 1) ck_assert_int_gt(none, 20);
  overlap_model_destroy(&model);
}
END_TEST

// ---- By weights.

enum { TRAINED = 20 };

// A number g of V and x̄ of some pairs.
static double sum_of(const OverlapModel *model, const double *pairs, const double *by) {
  double volumes[TRAINED], centroids[3 * TRAINED], sum = 0;
  ck_assert_ok(overlap_model_eval(
      model,
      &(OverlapBatch){.pair_count = TRAINED, .pairs = pairs, .volume = volumes, .centroid = centroids}));
  for (int i = 0; i < TRAINED; i++) {
    sum += by[4 * i] * volumes[i];
    for (int c = 0; c < 3; c++) sum += by[4 * i + 1 + c] * centroids[3 * i + c];
  }
  return sum;
}

// g of the model with other weights.
static double sum_with(const OverlapModel *model, const double *weights, const double *pairs,
                       const double *by) {
  char path[300];
  OverlapModel other;
  snprintf(path, sizeof path, "%s/other.safetensors", folder);
  ck_assert_ok(model->ops->training->write(model->self, weights, path));
  ck_assert_ok(overlap_models_create(&other, path));
  double sum = sum_of(&other, pairs, by);
  overlap_model_destroy(&other);
  return sum;
}

START_TEST(slopes_by_weights_agree_with_differences) {
  // Weights into which whitening was folded cancel: a longer way is no small one.
  static const double STEP = 1e-7, places[] = {-2, -1, 1, 2},
                      weights[] = {1.0 / 12, -2.0 / 3, 2.0 / 3, -1.0 / 12};
  OverlapModel model;
  Random random = random_seeded(7, 0);
  double pairs[TRAINED * SIZE], by[4 * TRAINED];
  ck_assert_ok(overlap_models_create(&model, names[_i]));
  const OverlapTraining *training = model.ops->training;
  size_t count = training->count(model.self);
  double *own = calloc(count, sizeof *own), *slope = calloc(count, sizeof *slope),
         *way = calloc(count, sizeof *way), *moved = calloc(count, sizeof *moved);
  for (int i = 0; i < TRAINED; i++) draw(&random, pairs + SIZE * i);
  // The last ones lie on a plane of the other: of some clipping has a share.
  for (int i = TRAINED / 2; i < TRAINED; i++)
    for (int v = 0; v < 3; v++) pairs[SIZE * i + 3 * v + 2] = pairs[SIZE * i + 12 + 3 * v + 2] = 0.01 * v;
  double volumes[TRAINED];
  unsigned flags[TRAINED];
  int blended = 0;
  ck_assert_ok(overlap_model_eval(
      &model, &(OverlapBatch){.pair_count = TRAINED, .pairs = pairs, .volume = volumes, .flags = flags}));
  for (int i = 0; i < TRAINED; i++) blended += volumes[i] > 0 && (flags[i] & OVERLAP_BLENDED) != 0;
  ck_assert_int_gt(blended, 0);
  for (int i = 0; i < 4 * TRAINED; i++) by[i] = suite_normal(&random);
  training->read(model.self, own);
  ck_assert_ok(training->pull(model.self, TRAINED, pairs, by, slope));
  for (int n = 0; n < 3; n++) {
    double along = 0, found = 0, size = 0;
    for (size_t i = 0; i < count; i++) way[i] = own[i] * suite_normal(&random);
    for (size_t i = 0; i < count; i++) along += slope[i] * way[i], size += fabs(slope[i] * way[i]);
    for (int p = 0; p < 4; p++) {
      for (size_t i = 0; i < count; i++) moved[i] = own[i] + places[p] * STEP * way[i];
      found += weights[p] / STEP * sum_with(&model, moved, pairs, by);
    }
    ck_assert_double_gt(fabs(along), 1e-3 * size / sqrt((double)count));
    ck_assert_msg(fabs(along - found) <= 1e-7 * size, "%s: %.12g, differences %.12g, terms %.3g", names[_i],
                  along, found, size);
  }
  free(own), free(slope), free(way), free(moved);
  overlap_model_destroy(&model);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("slopes");
  tcase_add_loop_test(cases, slopes_agree_with_differences, 0, sizeof names / sizeof *names);
  tcase_add_loop_test(cases, slopes_where_clip_finds_no_overlap, 0, 2);
  tcase_add_checked_fixture(cases, folder_make, folder_remove);
  tcase_add_loop_test(cases, slopes_by_weights_agree_with_differences, 0, 2);
  return suite_run("slopes", cases, 60);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// What training learns from: the pool of samples, rates along directions, the order of an epoch.
#include "pairs.h"

#include "app/training/geo/pool.h"
#include "app/training/rates.h"
#include "app/training/training.h"
#include "base/memory.h"
#include "base/random.h"
#include "overlap/clip/clip.h"
#include "overlap/geo/geo.h"
#include "overlap/tpn/normalise.h"

START_TEST(basis_is_orthonormal_and_of_no_affine_map) {
  Random random = random_seeded(1, 0);
  double pair[24], basis[12 * 24];
  for (int n = 0; n < 50; n++) {
    for (int i = 0; i < 24; i++) pair[i] = random_uniform(&random);
    app_training_pool_basis(pair, basis);
    for (int p = 0; p < 12; p++) {
      for (int q = 0; q < 12; q++) {
        double dot = 0;
        for (int i = 0; i < 24; i++) dot += basis[24 * p + i] * basis[24 * q + i];
        ck_assert_near(dot, p == q, 1e-13);
      }
      for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++) {
          double dot = 0;
          for (int v = 0; v < 8; v++)
            dot += basis[24 * p + 3 * v + row] * (column < 3 ? pair[3 * v + column] : 1);
          ck_assert_near(dot, 0, 1e-13);
        }
    }
  }
}
END_TEST

START_TEST(affine_directions_change_neither_features_nor_target) {
  size_t count;
  DatagenPairs pairs = load_pairs(40, &count);
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(36);
  Random random = random_seeded(2, 0);
  int used = 0;
  for (size_t n = 0; n < count; n++) {
    const double *pair = pairs.coordinates + 24 * n, *gradient = pairs.gradient + 24 * n;
    double matrix[12], direction[24], features[36], changes[36], guess, guess_change, along = 0;
    for (int i = 0; i < 12; i++) matrix[i] = suite_normal(&random);
    for (int v = 0; v < 8; v++)
      for (int r = 0; r < 3; r++) {
        direction[3 * v + r] = matrix[9 + r];
        for (int c = 0; c < 3; c++) direction[3 * v + r] += matrix[3 * r + c] * pair[3 * v + c];
      }
    if (overlap_geo_features_tangent(set, pair, 1, direction, features, changes, &guess, &guess_change) !=
        OVERLAP_GEO_INSIDE)
      continue;
    used++;
    for (int f = 0; f < 36; f++) ck_assert_near(changes[f], 0, 1e-7);
    for (int i = 0; i < 24; i++) along += gradient[i] * direction[i];
    ck_assert_near(along / pairs.volume[n], guess_change, 1e-6);
  }
  ck_assert_int_ge(used, 35);
  datagen_pairs_destroy(&pairs);
}
END_TEST

START_TEST(pool_holds_whitened_inputs) {
  size_t count;
  DatagenPairs pairs = load_pairs(600, &count);
  AppTrainingPool pool;
  NetWhitening none = {0};
  ck_assert_ok(app_training_pool_create(&pool, overlap_geo_features_set(36), &pairs, count, &none));
  ck_assert_int_eq((long long)pool.count + pool.apart + pool.unfit, 600);
  for (int i = 0; i < 36; i++) {
    double mean = 0, square = 0;
    for (int k = 0; k < pool.count; k++) {
      double w = (double)pool.inputs[k * 36 + i];
      mean += w / pool.count, square += w * w / pool.count;
    }
    ck_assert_near(mean, 0, 1e-4);
    ck_assert(square > 1e-6 && square < 1.001);
  }
  app_training_pool_destroy(&pool);
  datagen_pairs_destroy(&pairs);
}
END_TEST

START_TEST(rates_are_the_changes_of_clipped_volumes) {
  size_t count;
  DatagenPairs pairs = load_pairs(60, &count);
  AppTrainingRates rates;
  NetRandom random = net_random_seeded(5, 0);
  const double scale = 30, step = 1e-5;
  int used = 0;
  ck_assert_ok(app_training_rates_create(&rates, 1));
  for (size_t n = 0; n < count; n++) {
    OverlapTpnNormalised normalised;
    float direction[24];
    double moved[24], volume[2];
    unsigned flags;
    ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_UNIT, pairs.coordinates + 24 * n, &normalised));
    if (!(pairs.volume[n] > 1e-3 * normalised.factor)) continue;
    app_training_rates_set(&rates, 0, &normalised, pairs.gradient + 24 * n, scale);
    app_training_rates_finish(&rates, 1);
    double rate = (double)app_training_rates_draw(&rates, 0, &random, direction);
    for (int side = 0; side < 2; side++) {
      for (int i = 0; i < 24; i++)
        moved[i] = normalised.pair[i] + (side ? step : -step) * (double)direction[i];
      ck_assert_ok(overlap_clip_ops.eval_pair(NULL, moved,
                                              &(OverlapAnswer){.volume = &volume[side], .flags = &flags}));
    }
    ck_assert_near(scale * (volume[1] - volume[0]) / (2 * step), rate, 1e-3);
    used++;
  }
  ck_assert_int_ge(used, 20);
  app_training_rates_destroy(&rates);
  datagen_pairs_destroy(&pairs);
}
END_TEST

START_TEST(each_epoch_takes_each_sample_once) {
  AppTrainingOrder order;
  int samples[7], seen[21] = {0};
  ck_assert_ok(app_training_order_create(&order, 21));
  for (int step = 0; step < 3; step++) {
    app_training_order_take(&order, 5, step, 7, samples);
    for (int k = 0; k < 7; k++) seen[samples[k]]++;
  }
  for (int i = 0; i < 21; i++) ck_assert_int_eq(seen[i], 1);
  int again[7];
  app_training_order_take(&order, 5, 4, 7, samples);
  app_training_order_take(&order, 5, 0, 7, again); // back and forth
  app_training_order_take(&order, 5, 4, 7, again);
  ck_assert_mem_eq(samples, again, sizeof again);
  app_training_order_destroy(&order);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("samples");
  tcase_add_test(test_case, basis_is_orthonormal_and_of_no_affine_map);
  tcase_add_test(test_case, affine_directions_change_neither_features_nor_target);
  tcase_add_test(test_case, pool_holds_whitened_inputs);
  tcase_add_test(test_case, rates_are_the_changes_of_clipped_volumes);
  tcase_add_test(test_case, each_epoch_takes_each_sample_once);
  return suite_run("samples", test_case, 60);
}

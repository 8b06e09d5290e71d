// SPDX-License-Identifier: GPL-3.0-or-later
// `hybrid` of a geo: who answers follows from the bound, what comes out is continuous with its derivatives,
// and the bound holds for the share of pairs that it promises.
#include "suite.h"

#include <string.h>
#include <unistd.h>

#include "app/dataset/source.h"
#include "app/evaluation/bounds.h"
#include "app/evaluation/model.h"
#include "base/files/data.h"
#include "base/random.h"
#include "datagen/hard.h"
#include "datagen/pairs.h"
#include "overlap/models.h"
#include "overlap/pair/invariant.h"

enum { SIZE = 24, MOST = 4096 };

static OverlapModel open_named(const char *name, double doubt) {
  OverlapModel model;
  OverlapOptions options = overlap_options_default();
  if (doubt > 0) options.doubt = doubt;
  ck_assert_ok(overlap_models_create_with(&model, name, NULL, &options));
  return model;
}

static DatagenPairs load(size_t count) {
  DatagenPairs pairs;
  AppSourceDef def = {.law = "scene", .mix = "scene=1", .count = (int)count, .seed = 9101};
  ck_assert_ok(app_dataset_source_load(&def, &pairs, &count));
  return pairs;
}

static void eval(const OverlapModel *model, const double *pairs, int count, double *volume, double *gradient,
                 double *hessian, double *centroid, unsigned *flags) {
  OverlapBatch batch = {.pair_count = count,
                        .pairs = pairs,
                        .volume = volume,
                        .gradient = gradient,
                        .hessian = hessian,
                        .centroid = centroid,
                        .flags = flags};
  ck_assert_ok(overlap_model_eval(model, &batch));
}

// The network's answer where its bound is below the doubt, clip's where it is twice that, between them
// elsewhere.
START_TEST(the_bound_decides_who_answers) {
  static double net[MOST], bound[MOST], clip[MOST], volume[MOST], centroid[3 * MOST], centroids[2][3 * MOST];
  static unsigned flags[MOST];
  const double doubt = 0.006;
  int counts[3] = {0};
  DatagenPairs pairs = load(MOST);
  OverlapModel hybrid = open_named("hybrid", doubt), geo = open_named("geo-small", 0),
               exact = open_named("clip", 0);
  eval(&hybrid, pairs.coordinates, MOST, volume, NULL, NULL, centroid, flags);
  eval(&geo, pairs.coordinates, MOST, net, NULL, NULL, centroids[0], NULL);
  eval(&exact, pairs.coordinates, MOST, clip, NULL, NULL, centroids[1], NULL);
  double same[MOST];
  ck_assert_ok(hybrid.ops->eval_bounds(hybrid.self, MOST, pairs.coordinates, same, bound));
  for (int i = 0; i < MOST; i++) {
    double ratio = bound[i] / (doubt * net[i]),
           near = 0.85 * overlap_invariant_smaller_volume(pairs.coordinates + SIZE * i);
    ck_assert(same[i] == net[i] && bound[i] > 0);
    if (net[i] > near) continue;
    if (ratio <= 1) {
      counts[0]++;
      ck_assert(volume[i] == net[i] && (flags[i] & OVERLAP_NET));
      ck_assert_mem_eq(centroid + 3 * i, centroids[0] + 3 * i, 3 * sizeof(double));
    } else if (ratio >= 2) {
      counts[1]++;
      ck_assert_near(volume[i], clip[i], 1e-15 * clip[i]);
      ck_assert(flags[i] & OVERLAP_FALLBACK && !(flags[i] & OVERLAP_NET));
      for (int c = 0; c < 3; c++) ck_assert_near(centroid[3 * i + c], centroids[1][3 * i + c], 1e-12);
    } else {
      counts[2]++;
      ck_assert(volume[i] >= fmin(net[i], clip[i]) && volume[i] <= fmax(net[i], clip[i]));
      ck_assert((flags[i] & OVERLAP_BLENDED) && (flags[i] & OVERLAP_NET));
    }
  }
  for (int k = 0; k < 3; k++) ck_assert_int_ge(counts[k], 300);
  overlap_model_destroy(&hybrid), overlap_model_destroy(&geo), overlap_model_destroy(&exact);
  datagen_pairs_destroy(&pairs);
}
END_TEST

// What is asked with derivatives says the same of V, x̄ and who answered.
START_TEST(values_do_not_depend_on_what_else_is_asked) {
  enum { COUNT = 500 };
  static double volumes[3][COUNT], centroids[3][3 * COUNT], gradients[2][SIZE * COUNT];
  static double hessians[SIZE * SIZE * COUNT];
  static unsigned flags[3][COUNT];
  DatagenPairs pairs = load(COUNT);
  OverlapModel hybrid = open_named("hybrid", 0.006);
  eval(&hybrid, pairs.coordinates, COUNT, volumes[0], NULL, NULL, centroids[0], flags[0]);
  eval(&hybrid, pairs.coordinates, COUNT, volumes[1], gradients[0], NULL, centroids[1], flags[1]);
  eval(&hybrid, pairs.coordinates, COUNT, volumes[2], gradients[1], hessians, centroids[2], flags[2]);
  for (int i = 0; i < COUNT; i++) {
    double length = 0;
    for (int j = 0; j < SIZE; j++) length = fmax(length, fabs(gradients[0][SIZE * i + j]));
    for (int j = 0; j < SIZE; j++)
      ck_assert_near(gradients[1][SIZE * i + j], gradients[0][SIZE * i + j], 1e-9 * length);
  }
  for (int k = 1; k < 3; k++)
    for (int i = 0; i < COUNT; i++) {
      ck_assert_near(volumes[k][i], volumes[0][i], 1e-13 * volumes[0][i]);
      ck_assert_uint_eq(flags[k][i], flags[0][i]);
      for (int c = 0; c < 3; c++) ck_assert_near(centroids[k][3 * i + c], centroids[0][3 * i + c], 1e-12);
    }
  overlap_model_destroy(&hybrid);
  datagen_pairs_destroy(&pairs);
}
END_TEST

// ∇V and ∇²V of pairs in the band, where c, V and clip's V all vary, against differences.
START_TEST(derivatives_hold_where_the_two_are_mixed) {
  enum { COUNT = 400 };
  DatagenPairs pairs = load(COUNT);
  OverlapModel hybrid = open_named("hybrid", 0.005);
  int mixed = 0, right = 0;
  for (int n = 0; n < COUNT && mixed < 80; n++) {
    double pair[SIZE], volume, gradient[SIZE], hessian[SIZE * SIZE], sides[2], slopes[2][SIZE];
    double worst = 0, bent = 0, length = 0, size = 0;
    unsigned flags;
    memcpy(pair, pairs.coordinates + SIZE * n, sizeof pair);
    eval(&hybrid, pair, 1, &volume, gradient, hessian, NULL, &flags);
    if (!(flags & OVERLAP_BLENDED)) continue;
    mixed++;
    for (int i = 0; i < SIZE; i++) length = fmax(length, fabs(gradient[i]));
    for (int i = 0; i < SIZE * SIZE; i++) size = fmax(size, fabs(hessian[i]));
    double step = 1e-4 * volume / length;
    for (int i = 0; i < SIZE; i++) {
      double kept = pair[i];
      for (int side = 0; side < 2; side++) {
        pair[i] = kept + (side ? step : -step);
        eval(&hybrid, pair, 1, &sides[side], slopes[side], NULL, NULL, NULL);
      }
      pair[i] = kept;
      worst = suite_larger(worst, fabs((sides[1] - sides[0]) / (2 * step) - gradient[i]));
      for (int j = 0; j < SIZE; j++)
        bent = suite_larger(bent, fabs((slopes[1][j] - slopes[0][j]) / (2 * step) - hessian[SIZE * i + j]));
    }
    right += worst < 1e-5 * length && bent < 1e-3 * size;
  }
  ck_assert_int_ge(mixed, 60);
  // corners of the true volume, and of the bands, lie within some differences
  ck_assert_msg(right >= mixed * 85 / 100, "%d of %d right", right, mixed);
  overlap_model_destroy(&hybrid);
  datagen_pairs_destroy(&pairs);
}
END_TEST

START_TEST(volumes_stay_below_the_smaller_tetrahedron) {
  OverlapModel hybrid = open_named("hybrid", 0);
  Random random = random_seeded(21, 0);
  int near = 0;
  for (int n = 0; n < 6000; n++) {
    DatagenHardPair pair;
    double volume;
    datagen_hard_fill(&datagen_hard_classes[n % DATAGEN_HARD_CLASS_COUNT], &random, &pair);
    bool is_finite = true;
    for (int i = 0; i < SIZE; i++) is_finite = is_finite && isfinite(pair.x[i]);
    if (!is_finite) continue;
    eval(&hybrid, pair.x, 1, &volume, NULL, NULL, NULL, NULL);
    double smaller = overlap_invariant_smaller_volume(pair.x);
    ck_assert_msg(volume >= 0 && volume <= smaller * (1 + 1e-9), "%s: %g of %g",
                  datagen_hard_classes[n % DATAGEN_HARD_CLASS_COUNT].name, volume, smaller);
    near += volume > 0.95 * smaller;
  }
  ck_assert_int_ge(near, 200);
  overlap_model_destroy(&hybrid);
}
END_TEST

// Of pairs that neither training nor calibration has seen; and the bound is no wider than it must be.
START_TEST(the_bound_holds_for_the_share_it_promises) {
  static const char *const names[] = {"hybrid=geo-small", "hybrid=geo"};
  enum { COUNT = 12000 };
  DatagenPairs pairs = load(COUNT);
  OverlapModel hybrid;
  ck_assert_ok(app_evaluation_model_open(&hybrid, names[_i]));
  AppEvaluationBoundsRun run = {0};
  ck_assert_ok(app_evaluation_bounds_add(&run, &hybrid, &pairs, COUNT));
  AppEvaluationBounds bounds = app_evaluation_bounds_finish(&run);
  ck_assert_uint_ge(bounds.count, COUNT - 100);
  ck_assert_near(bounds.coverage, 0.95, 0.01);
  ck_assert(bounds.width_median < bounds.error_p95 && bounds.width_p95 < 3 * bounds.error_p95);
  app_evaluation_bounds_end(&run);
  overlap_model_destroy(&hybrid);
  datagen_pairs_destroy(&pairs);
}
END_TEST

START_TEST(a_bound_is_no_model_and_a_network_without_one_no_hybrid) {
  OverlapModel model;
  char path[4096];
  ck_assert_ok(data_find("net/weights/geo-small-bound.safetensors", path, sizeof path));
  ck_assert_int_eq(overlap_models_create(&model, path), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "a bound of the error of V"));
  ck_assert_int_ne(overlap_models_create_with(&model, "hybrid", path, NULL), STATUS_OK);
  char lonely[] = "/tmp/test_hybrid_XXXXXX.safetensors", command[8300];
  int file = mkstemps(lonely, 12);
  ck_assert_int_ge(file, 0);
  close(file);
  ck_assert_ok(data_find("net/weights/geo.safetensors", path, sizeof path));
  snprintf(command, sizeof command, "cp '%s' '%s'", path, lonely);
  ck_assert_int_eq(system(command), 0);
  ck_assert_int_ne(overlap_models_create_with(&model, "hybrid", lonely, NULL), STATUS_OK);
  ck_assert_ptr_nonnull(strstr(status_message(), "model.kind: bound"));
  unlink(lonely);
}
END_TEST

// Another network of the scene: what hybrid was with it.
START_TEST(with_the_network_of_tpn_scene_the_centroid_is_not_its_own) {
  OverlapModel model;
  ck_assert_ok(overlap_models_create_with(&model, "hybrid", "tpn-scene", NULL));
  ck_assert(!overlap_model_has_own_centroid(&model) && overlap_model_has_hessian(&model));
  overlap_model_destroy(&model);
  ck_assert_ok(overlap_models_create(&model, "hybrid"));
  ck_assert(overlap_model_has_own_centroid(&model) && overlap_model_has_hessian(&model));
  overlap_model_destroy(&model);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("hybrid");
  tcase_add_test(cases, the_bound_decides_who_answers);
  tcase_add_test(cases, values_do_not_depend_on_what_else_is_asked);
  tcase_add_test(cases, derivatives_hold_where_the_two_are_mixed);
  tcase_add_test(cases, volumes_stay_below_the_smaller_tetrahedron);
  tcase_add_loop_test(cases, the_bound_holds_for_the_share_it_promises, 0, 2);
  tcase_add_test(cases, a_bound_is_no_model_and_a_network_without_one_no_hybrid);
  tcase_add_test(cases, with_the_network_of_tpn_scene_the_centroid_is_not_its_own);
  return suite_run("hybrid", cases, 20);
}

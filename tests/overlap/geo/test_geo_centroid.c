// SPDX-License-Identifier: GPL-3.0-or-later
// The centroid that `geo` gives: what holds by construction, whatever the network has learned, with random
// weights; and how near the shipped weights come.
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "datagen/hard.h"
#include "net/files/weights.h"
#include "overlap/exact/exact.h"
#include "overlap/geo/model.h"
#include "overlap/geo/network.h"
#include "overlap/models.h"
#include "overlap/pair/centroid.h"
#include "overlap/pair/invariant.h"

static const int set_sizes[] = {36, 56, 70, 100, 120};

// A model of random weights, `strength` times those that a training begins with.
static OverlapModel random_model(int inputs, double strength) {
  char path[64], normalisation[] = OVERLAP_GEO_NORMALISATION, none[] = "";
  snprintf(path, sizeof path, "/tmp/tetlap_geo_centroid_%ld.safetensors", (long)getpid());
  int planes = overlap_geo_features_plane_count(overlap_geo_features_set(inputs));
  NetShape shape = net_shape_mlp(inputs, 16, 2, 1 + planes);
  NetModel_f64 net;
  ck_assert_int_eq(net_model_create_f64(&shape, &net), NET_OK);
  net_model_initialise_f64(&net, 17);
  for (size_t i = 0; i < net.plan->parameter_count; i++) net.parameters[i] *= strength;
  NetCard card = {.normalisation = normalisation, .range = none, .provenance = none};
  ck_assert_int_eq(net_weights_write_f64(path, &net, &card), NET_OK);
  net_model_destroy_f64(&net);
  OverlapModel model;
  ck_assert_ok(overlap_models_create(&model, path));
  unlink(path);
  ck_assert(overlap_model_has_own_centroid(&model));
  return model;
}

typedef struct Answer {
  double volume, centroid[3];
  unsigned flags;
} Answer;

static Answer ask(const OverlapModel *model, const double x[24]) {
  Answer answer = {.volume = NAN, .centroid = {NAN, NAN, NAN}};
  ck_assert_ok(overlap_model_eval(model, &(OverlapBatch){.pair_count = 1,
                                                         .pairs = x,
                                                         .volume = &answer.volume,
                                                         .flags = &answer.flags,
                                                         .centroid = answer.centroid}));
  return answer;
}

// 0 inside; outside, where shares of volumes sum to more than 1, by how much less.
static double inside_by(const double tet[12], const double point[3]) {
  double whole = overlap_invariant_tet_volume(tet), sum = 0;
  for (int k = 0; k < 4; k++) {
    double part[12];
    memcpy(part, tet, sizeof part);
    memcpy(part + 3 * k, point, 3 * sizeof *point);
    sum += fabs(overlap_invariant_tet_volume(part) / whole);
  }
  return 1 - sum;
}

START_TEST(it_is_inside_of_both_and_zero_without_volume) {
  OverlapModel model = random_model(set_sizes[_i], 3);
  int seen = 0, empty = 0;
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    for (int member = 0; member < 60; member++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      Answer answer = ask(&model, pair.x);
      if (!(answer.volume > 0)) {
        for (int i = 0; i < 3; i++) ck_assert(answer.centroid[i] == 0);
        empty++;
        continue;
      }
      double extent = overlap_invariant_extent(pair.x), smaller = overlap_invariant_smaller_volume(pair.x);
      // what rounding of coordinates makes of λ in a tetrahedron that is thin
      double allowed = 1e-11 * extent * extent * extent / smaller;
      for (int t = 0; t < 2; t++)
        ck_assert_msg(inside_by(pair.x + 12 * t, answer.centroid) >= -allowed,
                      "%s, member %d, tetrahedron %d: outside by %g, allowed %g",
                      datagen_hard_classes[c].name, member, t, -inside_by(pair.x + 12 * t, answer.centroid),
                      allowed);
      seen++;
    }
  ck_assert_int_gt(seen, 500);
  ck_assert_int_gt(empty, 100);
  overlap_model_destroy(&model);
}
END_TEST

// Uniform pairs in the unit cube that share volume.
static bool draw(Random *random, double x[24]) {
  for (int i = 0; i < 24; i++) x[i] = random_uniform(random);
  Answer answer = ask(&(OverlapModel){.ops = &overlap_exact_ops}, x);
  return answer.volume > 1e-5;
}

START_TEST(it_goes_along_with_affine_maps_and_any_order) {
  OverlapModel model = random_model(set_sizes[_i], 1);
  Random random = random_seeded(23, (uint64_t)_i);
  static const double map[3][3] = {{2, 0.5, -1}, {0, 0.75, 0.25}, {-0.5, 1, 1.5}}, shift[3] = {1, -2, 0.5};
  for (int seen = 0; seen < 200;) {
    double x[24], changed[24];
    if (!draw(&random, x)) continue;
    seen++;
    Answer answer = ask(&model, x);
    double allowed = 1e-9;
    for (int v = 0; v < 8; v++) // vertices turned around, the two exchanged
      memcpy(changed + 3 * v, x + 3 * (v < 4 ? 4 + (v + 2) % 4 : (v + 1) % 4), 3 * sizeof *x);
    Answer turned = ask(&model, changed);
    for (int c = 0; c < 3; c++) ck_assert_near(turned.centroid[c], answer.centroid[c], allowed);
    for (int v = 0; v < 8; v++)
      for (int r = 0; r < 3; r++) {
        changed[3 * v + r] = shift[r];
        for (int c = 0; c < 3; c++) changed[3 * v + r] += map[r][c] * x[3 * v + c];
      }
    Answer mapped = ask(&model, changed);
    for (int r = 0; r < 3; r++) {
      double expected = shift[r];
      for (int c = 0; c < 3; c++) expected += map[r][c] * answer.centroid[c];
      ck_assert_near(mapped.centroid[r], expected, 10 * allowed);
    }
  }
  overlap_model_destroy(&model);
}
END_TEST

// A corner that has come through a face by d: a simplex, whose centroid is the mean of its vertices.
START_TEST(it_is_true_at_the_onset_with_any_weights) {
  OverlapModel model = random_model(set_sizes[_i], 1);
  for (double d = 1e-2; d > 1e-7; d /= 10) {
    const double x[24] = {0,   0,   0,  3,    0,   0, 0,   3,   0, 0,    0,    -3, //
                          0.7, 0.8, -d, 0.75, 0.8, 1, 0.6, 0.9, 1, 0.65, 0.65, 1};
    Answer answer = ask(&model, x), truth = ask(&(OverlapModel){.ops = &overlap_exact_ops}, x);
    ck_assert(truth.volume > 0);
    ck_assert_int_eq(answer.flags, 0);
    double distance = 0;
    for (int c = 0; c < 3; c++)
      distance = suite_larger(fabs(answer.centroid[c] - truth.centroid[c]), distance);
    ck_assert_msg(distance <= 2 * d * d, "at depth %g: off by %g", d, distance);
  }
  overlap_model_destroy(&model);
}
END_TEST

enum { BATCH = 1000 };

START_TEST(asking_for_it_changes_nothing_else) {
  OverlapModel model = random_model(set_sizes[_i], 1);
  static double x[BATCH * 24], volume[3][BATCH], gradient[2][BATCH * 24], centroid[2][BATCH * 3];
  static unsigned flags[3][BATCH];
  for (int k = 0; k < BATCH; k++)
    memcpy(x + 24 * k, datagen_hard_make(k % DATAGEN_HARD_CLASS_COUNT, k).x, 24 * sizeof *x);
  OverlapBatch batch = {.pair_count = BATCH, .pairs = x};
  batch.volume = volume[0], batch.gradient = gradient[0], batch.flags = flags[0];
  ck_assert_ok(overlap_model_eval(&model, &batch));
  batch.volume = volume[1], batch.gradient = gradient[1], batch.flags = flags[1],
  batch.centroid = centroid[0];
  ck_assert_ok(overlap_model_eval(&model, &batch));
  batch.volume = volume[2], batch.gradient = NULL, batch.flags = flags[2], batch.centroid = centroid[1];
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert_mem_eq(gradient[0], gradient[1], sizeof gradient[0]);
  ck_assert_mem_eq(centroid[0], centroid[1], sizeof centroid[0]);
  for (int k = 1; k < 3; k++) {
    ck_assert_mem_eq(volume[0], volume[k], sizeof volume[0]);
    ck_assert_mem_eq(flags[0], flags[k], sizeof flags[0]);
  }
  for (int k = 0; k < BATCH; k++) { // and what one pair gets hangs on no other
    Answer alone = ask(&model, x + 24 * k);
    ck_assert(alone.volume == volume[0][k]);
    ck_assert_mem_eq(alone.centroid, centroid[0] + 3 * k, sizeof alone.centroid);
  }
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(of_a_network_of_one_output_it_follows_from_the_gradient) {
  void *self;
  ck_assert_ok(overlap_geo_model_create(&self, NULL));
  OverlapModel model = {.ops = &overlap_geo_ops, .self = self};
  ck_assert(!overlap_model_has_own_centroid(&model));
  double x[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, volume, gradient[24], centroid[3], derived[3];
  for (int i = 0; i < 12; i++) x[12 + i] = x[i] + 0.1;
  OverlapBatch batch = {
      .pair_count = 1, .pairs = x, .volume = &volume, .gradient = gradient, .centroid = centroid};
  ck_assert_ok(overlap_model_eval(&model, &batch));
  overlap_centroid_derive(x, volume, gradient, derived);
  ck_assert_mem_eq(centroid, derived, sizeof derived);
  overlap_model_destroy(&model);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("geo_centroid");
  tcase_add_loop_test(cases, it_is_inside_of_both_and_zero_without_volume, 0, 5);
  tcase_add_loop_test(cases, it_goes_along_with_affine_maps_and_any_order, 0, 5);
  tcase_add_loop_test(cases, it_is_true_at_the_onset_with_any_weights, 0, 5);
  tcase_add_loop_test(cases, asking_for_it_changes_nothing_else, 0, 5);
  tcase_add_test(cases, of_a_network_of_one_output_it_follows_from_the_gradient);
  return suite_run("geo_centroid", cases, 60);
}

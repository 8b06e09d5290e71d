// SPDX-License-Identifier: GPL-3.0-or-later
// `geo` with a network from a weights file.
#include "suite.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "datagen/hard.h"
#include "net/files/weights.h"
#include "net/model/model.h"
#include "overlap/exact/exact.h"
#include "overlap/geo/model.h"
#include "overlap/pair/invariant.h"

static const char *weights_path(void) {
  static char path[64];
  snprintf(path, sizeof path, "/tmp/tetlap_geo_%ld.safetensors", (long)getpid());
  return path;
}

static void write_weights(const NetShape *shape, const char *normalisation) {
  NetModel_f64 model;
  ck_assert_int_eq(net_model_create_f64(shape, &model), NET_OK);
  net_model_initialise_f64(&model, 11);
  for (size_t i = 0; i < model.plan->parameter_count; i++) model.parameters[i] *= 0.3;
  char text[64], none[] = "";
  snprintf(text, sizeof text, "%s", normalisation);
  NetCard card = {.normalisation = text, .range = none, .provenance = none};
  ck_assert_msg(net_weights_write_f64(weights_path(), &model, &card) == NET_OK, "%s", net_status_message());
  net_model_destroy_f64(&model);
}

static NetShape shape_of(int inputs) {
  return net_shape_mlp(inputs, 16, 2, 1);
}

static void *create(int inputs) {
  NetShape shape = shape_of(inputs);
  void *self = NULL;
  write_weights(&shape, OVERLAP_GEO_NORMALISATION);
  ck_assert_ok(overlap_geo_model_create(&self, weights_path()));
  unlink(weights_path());
  return self;
}

START_TEST(gradient_and_hessian_of_a_loaded_network_are_derivatives) {
  const int inputs[] = {36, 56, 70, 100, 120};
  void *self = create(inputs[_i]);
  int seen = 0;
  for (int member = 0; member < 40; member++) {
    DatagenHardPair pair = datagen_hard_make(2, member);
    double volume, gradient[24], hessian[576];
    unsigned flags;
    ck_assert_ok(overlap_geo_model_eval_pair(
        self, pair.x,
        &(OverlapAnswer){.volume = &volume, .gradient = gradient, .hessian = hessian, .flags = &flags}));
    if (!(volume > 1e-6) || flags) continue;
    seen++;
    double h = 1e-6 * cbrt(volume), size = 0, bend = 0;
    for (int i = 0; i < 24; i++) size = fmax(size, fabs(gradient[i]));
    for (int i = 0; i < 576; i++) bend = fmax(bend, fabs(hessian[i]));
    for (int i = 0; i < 24; i++) {
      double x[24], up, down, up_gradient[24], down_gradient[24];
      memcpy(x, pair.x, sizeof x);
      x[i] = pair.x[i] + h;
      ck_assert_ok(overlap_geo_model_eval_pair(
          self, x, &(OverlapAnswer){.volume = &up, .gradient = up_gradient, .flags = &flags}));
      x[i] = pair.x[i] - h;
      ck_assert_ok(overlap_geo_model_eval_pair(
          self, x, &(OverlapAnswer){.volume = &down, .gradient = down_gradient, .flags = &flags}));
      ck_assert_near((up - down) / (2 * h), gradient[i], 1e-7 * size);
      for (int j = 0; j < 24; j++)
        ck_assert_near((up_gradient[j] - down_gradient[j]) / (2 * h), hessian[24 * i + j], 1e-6 * bend);
    }
  }
  ck_assert_int_gt(seen, 10);
  overlap_geo_model_destroy(self);
}
END_TEST

START_TEST(a_vanishing_overlap_is_true_with_any_weights) {
  void *self = create(100);
  for (int member = 0; member < 40; member++) {
    DatagenHardPair pair = datagen_hard_make(5, member); // a vertex on a face
    Vec3 n = datagen_hard_face_normal(&pair, 0);
    for (int i = 4; i < 8; i++)
      datagen_hard_set(&pair, i,
                       vec3_sub(datagen_hard_vertex(&pair, i), vec3_scale(1e-5 / vec3_length(n), n)));
    double volume, exact;
    unsigned flags;
    ck_assert_ok(
        overlap_geo_model_eval_pair(self, pair.x, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
    ck_assert_ok(
        overlap_exact_ops.eval_pair(NULL, pair.x, &(OverlapAnswer){.volume = &exact, .flags = &flags}));
    ck_assert(exact > 0);
    ck_assert_near(volume / exact, 1, 1e-3);
  }
  overlap_geo_model_destroy(self);
}
END_TEST

START_TEST(any_number_of_threads_gives_the_same_bits) {
  enum { COUNT = 300 };
  static double pairs[COUNT * 24], volume[2][COUNT], gradient[2][COUNT * 24];
  int threads = omp_get_max_threads();
  for (int n = 0; n < COUNT; n++) memcpy(pairs + 24 * n, datagen_hard_make(2, n).x, 24 * sizeof *pairs);
  for (int run = 0; run < 2; run++) {
    void *self = create(100);
    omp_set_num_threads(run ? 4 : 1);
    OverlapBatch batch = {
        .pair_count = COUNT, .pairs = pairs, .volume = volume[run], .gradient = gradient[run]};
    ck_assert_ok(overlap_geo_model_eval_batch(self, &batch));
    omp_set_num_threads(threads);
    overlap_geo_model_destroy(self);
  }
  ck_assert_mem_eq(volume[0], volume[1], sizeof volume[0]);
  ck_assert_mem_eq(gradient[0], gradient[1], sizeof gradient[0]);
}
END_TEST

static void expect_refusal(const NetShape *shape, const char *normalisation, const char *says) {
  void *self = NULL;
  write_weights(shape, normalisation);
  ck_assert_int_eq(overlap_geo_model_create(&self, weights_path()), STATUS_INPUT);
  ck_assert_ptr_null(self);
  ck_assert_msg(strstr(status_message(), says) && strstr(status_message(), weights_path()), "%s",
                status_message());
  unlink(weights_path());
}

START_TEST(weights_of_another_kind_are_refused_by_name) {
  NetShape shape = net_shape_tpn_b();
  expect_refusal(&shape, OVERLAP_GEO_NORMALISATION, "dense SiLU");
  shape = shape_of(37);
  expect_refusal(&shape, OVERLAP_GEO_NORMALISATION, "37 inputs");
  shape = shape_of(36);
  expect_refusal(&shape, "unit", "'unit'");
  void *self = NULL;
  ck_assert_int_ne(overlap_geo_model_create(&self, "/nowhere.safetensors"), STATUS_OK);
  ck_assert_ptr_nonnull(strstr(status_message(), "/nowhere.safetensors"));
}
END_TEST

START_TEST(without_a_file_there_is_the_constant) {
  void *self = NULL;
  ck_assert_ok(overlap_geo_model_create(&self, NULL));
  OverlapGeoFrame frame;
  DatagenHardPair pair = datagen_hard_make(2, 1);
  for (int member = 1; overlap_geo_frame(&frame, pair.x) != OVERLAP_GEO_INSIDE; member++)
    pair = datagen_hard_make(2, member);
  double volume;
  unsigned flags;
  ck_assert_ok(
      overlap_geo_model_eval_pair(self, pair.x, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
  ck_assert_near(volume, 1.28 * frame.volume, 1e-15 * volume);
  overlap_geo_model_destroy(self);
}
END_TEST

START_TEST(every_failed_allocation_is_an_error_and_nothing_leaks) {
  NetShape shape = shape_of(36);
  write_weights(&shape, OVERLAP_GEO_NORMALISATION);
  int failures = 0;
  for (long k = 1; k < 100; k++) {
    void *self = NULL;
    memory_fail_at(k);
    Status status = overlap_geo_model_create(&self, weights_path());
    memory_fail_at(0);
    if (status == STATUS_OK) {
      overlap_geo_model_destroy(self);
      break;
    }
    ck_assert_int_eq(status, STATUS_MEMORY);
    failures++;
  }
  unlink(weights_path());
  ck_assert_int_ge(failures, 3);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("geo_net");
  tcase_add_loop_test(cases, gradient_and_hessian_of_a_loaded_network_are_derivatives, 0, 5);
  tcase_add_test(cases, a_vanishing_overlap_is_true_with_any_weights);
  tcase_add_test(cases, any_number_of_threads_gives_the_same_bits);
  tcase_add_test(cases, weights_of_another_kind_are_refused_by_name);
  tcase_add_test(cases, without_a_file_there_is_the_constant);
  tcase_add_test(cases, every_failed_allocation_is_an_error_and_nothing_leaks);
  return suite_run("geo net", cases, 60);
}

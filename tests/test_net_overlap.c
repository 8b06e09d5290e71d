// SPDX-License-Identifier: GPL-3.0-or-later
// TetrahedronPairNet as an overlap model, with random weights: what holds for any network.
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/random.h"
#include "contact/exact.h"
#include "contact/net_overlap.h"
#include "net/weights.h"
#include "suite.h"

static char path[64];

static void write_network(const char *normalisation, NetActivation activation) {
  NetShape shape = net_shape_tpn_a();
  NetModel_f32 model;
  char input[64], range[] = "anything", provenance[] = "random weights";
  snprintf(input, sizeof input, "%s", normalisation);
  NetCard card = {.normalisation = input, .range = range, .provenance = provenance};
  shape.activation = activation;
  snprintf(path, sizeof path, "/tmp/test_net_overlap_%d.safetensors", (int)getpid());
  ck_assert_int_eq(net_model_create_f32(&shape, &model), NET_OK);
  net_model_initialise_f32(&model, 3);
  float *bias = NULL;
  for (int k = 0; k < model.plan->tensor_count; k++) {
    const NetTensor *tensor = &model.plan->tensors[k];
    if (strncmp(tensor->name, "volume", 6) == 0 && tensor->rows == 1 && tensor->columns == 0)
      bias = model.parameters + tensor->offset;
  }
  ck_assert_ptr_nonnull(bias);
  // V > 0 whatever the input; not larger than needed, for float's rounding
  *bias = normalisation[0] == 'p' ? 2 : 40;
  ck_assert_int_eq(net_weights_write_f32(path, &model, &card), NET_OK);
  net_model_destroy_f32(&model);
}

static void draw_pairs(uint64_t seed, int count, double *pairs) {
  Random random = random_seeded(seed, 0);
  for (int i = 0; i < 24 * count; i++) pairs[i] = random_uniform(&random);
}

static double volume_of(const void *self, const double pair[24]) {
  double volume;
  unsigned flags;
  ck_assert_ok(contact_net_overlap_eval_pair(self, pair, &volume, NULL, NULL, &flags));
  return volume;
}

static void check_gradient(const char *normalisation) {
  void *self;
  double pairs[24 * 40], volume, gradient[24];
  unsigned flags;
  write_network(normalisation, NET_SILU);
  ck_assert_ok(contact_net_overlap_create(&self, path));
  draw_pairs(1, 40, pairs);
  int checked = 0;
  for (int n = 0; n < 40; n++) {
    double *pair = pairs + 24 * n, size = 0, worst = 0;
    ck_assert_ok(contact_net_overlap_eval_pair(self, pair, &volume, gradient, NULL, &flags));
    for (int i = 0; i < 24; i++) size = fmax(size, fabs(gradient[i]));
    for (int i = 0; i < 24; i++) {
      double step = 1e-3, kept = pair[i];
      pair[i] = kept + step;
      double above = volume_of(self, pair);
      pair[i] = kept - step;
      double below = volume_of(self, pair);
      pair[i] = kept;
      worst = fmax(worst, fabs((above - below) / (2 * step) - gradient[i]));
    }
    // max pools have kinks, thin first tetrahedra bend sharply: most, not all
    checked += worst < 0.02 * size && volume > 0;
  }
  ck_assert_int_ge(checked, 28);
  contact_net_overlap_destroy(self);
  unlink(path);
}

START_TEST(gradient_is_that_of_the_volume_with_unit) {
  check_gradient("unit, V times 1000");
}
END_TEST

START_TEST(gradient_is_that_of_the_volume_with_pca) {
  check_gradient("pca, V times 1000");
}
END_TEST

START_TEST(batches_give_what_single_pairs_give) {
  enum { COUNT = 500 };
  static double pairs[24 * COUNT], volume[COUNT], gradient[24 * COUNT], logits[COUNT];
  void *self;
  write_network("pca, V times 1000", NET_RELU);
  ck_assert_ok(contact_net_overlap_create(&self, path));
  draw_pairs(2, COUNT, pairs);
  ContactOverlapBatch batch = {.pair_count = COUNT, .pairs = pairs, .volume = volume, .gradient = gradient};
  ck_assert_ok(contact_net_overlap_eval_batch(self, &batch));
  ck_assert_ok(contact_net_overlap_logits(self, COUNT, pairs, logits));
  for (int n = 0; n < COUNT; n++) {
    double alone = volume_of(self, pairs + 24 * n), total[3] = {0};
    ck_assert_near(volume[n], alone, 1e-5 * alone);
    ck_assert(isfinite(logits[n]));
    for (int i = 0; i < 24; i++) total[i % 3] += gradient[24 * n + i];
    for (int c = 0; c < 3; c++) ck_assert_near(total[c], 0, 1e-12); // no net force, by the normalisation
  }
  contact_net_overlap_destroy(self);
  unlink(path);
}
END_TEST

START_TEST(flat_first_tetrahedron_is_answered_by_exact) {
  double pair[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, -1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
  double volume = 7, gradient[24], logit;
  unsigned flags = 0;
  void *self;
  write_network("unit, V times 1000", NET_RELU);
  ck_assert_ok(contact_net_overlap_create(&self, path));
  ck_assert_ok(contact_net_overlap_eval_pair(self, pair, &volume, gradient, NULL, &flags));
  ck_assert(volume == 0 && (flags & CONTACT_OVERLAP_FALLBACK));
  ck_assert_ok(contact_net_overlap_logits(self, 1, pair, &logit));
  ck_assert(logit == -INFINITY);
  contact_net_overlap_destroy(self);
  unlink(path);
}
END_TEST

START_TEST(normalisation_text_is_read_as_it_is_written) {
  char text[CONTACT_NET_NORMALISATION_TEXT];
  ContactNormalisation kind;
  double scale;
  contact_net_overlap_print(CONTACT_NORMALISE_PCA, 1234.5, text);
  ck_assert(contact_net_overlap_parse(text, &kind, &scale));
  ck_assert(kind == CONTACT_NORMALISE_PCA && scale == 1234.5);
  ck_assert(!contact_net_overlap_parse("unit", &kind, &scale));
  ck_assert(!contact_net_overlap_parse("box, V times 10", &kind, &scale));
  ck_assert(!contact_net_overlap_parse("pca, V times -1", &kind, &scale));
  ck_assert(!contact_net_overlap_parse("pca, V times 10 or so", &kind, &scale));
}
END_TEST

START_TEST(weights_of_another_normalisation_are_refused_by_name) {
  void *self;
  write_network("analytic-centre frame", NET_RELU);
  ck_assert_int_eq(contact_net_overlap_create(&self, path), STATUS_INPUT);
  ck_assert(strstr(status_message(), "analytic-centre frame") && strstr(status_message(), path));
  unlink(path);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("net_overlap");
  tcase_add_test(test_case, gradient_is_that_of_the_volume_with_unit);
  tcase_add_test(test_case, gradient_is_that_of_the_volume_with_pca);
  tcase_add_test(test_case, batches_give_what_single_pairs_give);
  tcase_add_test(test_case, flat_first_tetrahedron_is_answered_by_exact);
  tcase_add_test(test_case, normalisation_text_is_read_as_it_is_written);
  tcase_add_test(test_case, weights_of_another_normalisation_are_refused_by_name);
  return suite_run("net_overlap", test_case, 30);
}

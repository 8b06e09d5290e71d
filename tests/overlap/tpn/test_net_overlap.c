// SPDX-License-Identifier: GPL-3.0-or-later
// TetrahedronPairNet as an overlap model, with random weights: what holds for any network.
#include "random_network.h"

#include "overlap/models.h"
#include "overlap/pair/invariant.h"
#include "overlap/tpn/model.h"

static double volume_of(const void *self, const double pair[24]) {
  double volume;
  unsigned flags;
  ck_assert_ok(overlap_tpn_model_eval_pair(self, pair, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
  return volume;
}

static void check_gradient(const char *normalisation) {
  void *self;
  double pairs[24 * 40], volume, gradient[24];
  unsigned flags;
  write_network(normalisation, NET_SILU);
  ck_assert_ok(overlap_tpn_ops.create(&self, path, NULL));
  draw_pairs(1, 40, pairs);
  int checked = 0;
  for (int n = 0; n < 40; n++) {
    double *pair = pairs + 24 * n, size = 0, worst = 0;
    ck_assert_ok(overlap_tpn_model_eval_pair(
        self, pair, &(OverlapAnswer){.volume = &volume, .gradient = gradient, .flags = &flags}));
    for (int i = 0; i < 24; i++) size = fmax(size, fabs(gradient[i]));
    for (int i = 0; i < 24; i++) {
      double step = 1e-3, kept = pair[i];
      pair[i] = kept + step;
      double above = volume_of(self, pair);
      pair[i] = kept - step;
      double below = volume_of(self, pair);
      pair[i] = kept;
      worst = suite_larger(worst, fabs((above - below) / (2 * step) - gradient[i]));
    }
    // max pools have kinks, thin first tetrahedra bend sharply: most, not all
    checked += worst < 0.02 * size && volume > 0;
  }
  ck_assert_int_ge(checked, 28);
  overlap_tpn_model_destroy(self);
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
  ck_assert_ok(overlap_tpn_ops.create(&self, path, NULL));
  draw_pairs(2, COUNT, pairs);
  OverlapBatch batch = {.pair_count = COUNT, .pairs = pairs, .volume = volume, .gradient = gradient};
  ck_assert_ok(overlap_tpn_model_eval_batch(self, &batch));
  ck_assert_ok(overlap_tpn_model_logits(self, COUNT, pairs, logits));
  for (int n = 0; n < COUNT; n++) {
    double alone = volume_of(self, pairs + 24 * n), total[3] = {0};
    ck_assert_near(volume[n], alone, 1e-5 * alone);
    ck_assert(isfinite(logits[n]));
    for (int i = 0; i < 24; i++) total[i % 3] += gradient[24 * n + i];
    for (int c = 0; c < 3; c++) ck_assert_near(total[c], 0, 1e-12); // no net force, by the normalisation
  }
  overlap_tpn_model_destroy(self);
  unlink(path);
}
END_TEST

START_TEST(flat_first_tetrahedron_is_answered_by_exact) {
  double pair[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, -1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
  double volume = 7, gradient[24], logit;
  unsigned flags = 0;
  void *self;
  write_network("unit, V times 1000", NET_RELU);
  ck_assert_ok(overlap_tpn_ops.create(&self, path, NULL));
  ck_assert_ok(overlap_tpn_model_eval_pair(
      self, pair, &(OverlapAnswer){.volume = &volume, .gradient = gradient, .flags = &flags}));
  ck_assert(volume == 0 && (flags & OVERLAP_FALLBACK));
  ck_assert_ok(overlap_tpn_model_logits(self, 1, pair, &logit));
  ck_assert(logit == -INFINITY);
  overlap_tpn_model_destroy(self);
  unlink(path);
}
END_TEST

START_TEST(normalisation_text_is_read_as_it_is_written) {
  char text[OVERLAP_TPN_NORMALISATION_TEXT];
  OverlapTpnNormalisation kind;
  double scale;
  overlap_tpn_network_print(OVERLAP_TPN_NORMALISE_PCA, 1234.5, text);
  ck_assert(overlap_tpn_network_parse(text, &kind, &scale));
  ck_assert(kind == OVERLAP_TPN_NORMALISE_PCA && scale == 1234.5);
  ck_assert(!overlap_tpn_network_parse("unit", &kind, &scale));
  ck_assert(!overlap_tpn_network_parse("box, V times 10", &kind, &scale));
  ck_assert(!overlap_tpn_network_parse("pca, V times -1", &kind, &scale));
  ck_assert(!overlap_tpn_network_parse("pca, V times 10 or so", &kind, &scale));
}
END_TEST

START_TEST(weights_of_another_normalisation_are_refused_by_name) {
  void *self;
  write_network("analytic-centre frame", NET_RELU);
  ck_assert_int_eq(overlap_tpn_ops.create(&self, path, NULL), STATUS_INPUT);
  ck_assert(strstr(status_message(), "analytic-centre frame") && strstr(status_message(), path));
  unlink(path);
}
END_TEST

START_TEST(a_file_says_which_model_it_is) {
  OverlapModel model;
  write_network("unit, V times 1000", NET_RELU);
  ck_assert_ok(overlap_models_create(&model, path));
  ck_assert(model.ops == &overlap_tpn_ops && overlap_model_has_ghosts(&model));
  overlap_model_destroy(&model);
  ck_assert_ok(overlap_models_create(&model, TETLAP_SOURCE_DIR "/net/weights/geo-small.safetensors"));
  ck_assert(strcmp(model.ops->name, "geo") == 0 && !overlap_model_has_ghosts(&model));
  overlap_model_destroy(&model);
  unlink(path);
  ck_assert_int_eq(overlap_models_create(&model, path), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), path));
}
END_TEST

START_TEST(ghosts_are_kept_cut_or_faded_as_asked) {
  double apart[24], touching[24], deep[24];
  write_smooth(40, 5);
  slide(0.4, apart), slide(0.3333, touching), slide(0.1, deep);
  OverlapOptions options = overlap_options_default();
  options.gate = OVERLAP_GATE_NONE;
  options.orders = OVERLAP_ORDERS_ONE;
  options.ghosts = OVERLAP_GHOSTS_KEEP;
  OverlapModel keep = open_with("tpn", options);
  options.ghosts = OVERLAP_GHOSTS_CUT;
  OverlapModel cut = open_with("tpn", options);
  options.ghosts = OVERLAP_GHOSTS_FADE;
  OverlapModel fade = open_with("tpn", options);
  ck_assert(overlap_model_has_ghosts(&keep) && !overlap_model_has_ghosts(&cut));
  ck_assert(ask(&keep, apart).volume > 0.01);
  Answer nothing = ask(&cut, apart);
  ck_assert(nothing.volume == 0 && (nothing.flags & OVERLAP_DISJOINT));
  for (int i = 0; i < 24; i++) ck_assert(nothing.gradient[i] == 0);
  ck_assert(ask(&fade, apart).volume == 0);
  ck_assert(ask(&cut, touching).volume == ask(&keep, touching).volume); // the jump
  ck_assert(ask(&fade, touching).volume < 1e-6);
  ck_assert(ask(&fade, deep).volume == ask(&keep, deep).volume);
  overlap_model_destroy(&keep), overlap_model_destroy(&cut), overlap_model_destroy(&fade);
  unlink(path);
}
END_TEST

START_TEST(the_gate_multiplies_by_the_probability) {
  double pair[24], logit;
  write_smooth(40, 0.5f);
  slide(0.1, pair);
  OverlapOptions options = overlap_options_default();
  OverlapModel plain = open_with("tpn", options);
  options.gate = OVERLAP_GATE_STATUS;
  OverlapModel gated = open_with("tpn", options);
  ck_assert_ok(overlap_tpn_model_logits(gated.self, 1, pair, &logit));
  double expected = ask(&plain, pair).volume / (1 + exp(-logit));
  ck_assert(fabs(logit) < 3);
  ck_assert_near(ask(&gated, pair).volume, expected, 1e-12 * expected);
  overlap_model_destroy(&plain), overlap_model_destroy(&gated);
  unlink(path);
}
END_TEST

START_TEST(both_orders_make_it_symmetric) {
  double pairs[24 * 20], swapped[24];
  write_smooth(40, 5);
  draw_pairs(4, 20, pairs);
  OverlapOptions options = overlap_options_default();
  OverlapModel one = open_with("tpn", options);
  options.orders = OVERLAP_ORDERS_BOTH;
  OverlapModel both = open_with("tpn", options);
  int unequal = 0;
  for (int n = 0; n < 20; n++) {
    const double *pair = pairs + 24 * n;
    memcpy(swapped, pair + 12, 12 * sizeof *pair), memcpy(swapped + 12, pair, 12 * sizeof *pair);
    Answer mean = ask(&both, pair), exchanged = ask(&both, swapped);
    double v = ask(&one, pair).volume, w = ask(&one, swapped).volume;
    unequal += fabs(v - w) > 0.1 * v;
    ck_assert_near(mean.volume, 0.5 * (v + w), 1e-12 * (v + w));
    ck_assert_near(exchanged.volume, mean.volume, 1e-12 * mean.volume);
    for (int i = 0; i < 24; i++)
      ck_assert_near(exchanged.gradient[i], mean.gradient[(i + 12) % 24], 1e-9 * mean.volume);
  }
  ck_assert_int_ge(unequal, 10);
  overlap_model_destroy(&one), overlap_model_destroy(&both);
  unlink(path);
}
END_TEST

START_TEST(pairs_beyond_the_range_are_counted_or_sent_to_exact) {
  double inside[24], beyond[24];
  write_smooth(40, 5);
  slide(0.1, inside), slide(0.1, beyond);
  for (int v = 1; v < 4; v++) // four times as long: radius and volume leave the range
    for (int c = 0; c < 3; c++) beyond[12 + 3 * v + c] = 0.1 + 4 * (beyond[12 + 3 * v + c] - 0.1);
  OverlapOptions options = overlap_options_default();
  OverlapModel count = open_with("tpn", options);
  options.beyond = OVERLAP_BEYOND_EXACT;
  OverlapModel exact = open_with("tpn", options);
  ck_assert(ask(&count, inside).flags == OVERLAP_NET && ask(&exact, inside).flags == OVERLAP_NET);
  ck_assert(ask(&count, beyond).flags == (OVERLAP_NET | OVERLAP_BEYOND));
  Answer answer = ask(&exact, beyond);
  ck_assert((answer.flags & OVERLAP_BEYOND) && (answer.flags & OVERLAP_FALLBACK));
  ck_assert(!(answer.flags & OVERLAP_NET) && answer.volume == exact_volume(beyond));
  overlap_model_destroy(&count), overlap_model_destroy(&exact);
  unlink(path);
}
END_TEST

START_TEST(a_range_that_is_not_known_cannot_send_pairs_to_exact) {
  NetShape shape = net_shape_tpn_a();
  write_shape(&shape, "unit, V times 1000", "anything", 40, 5);
  OverlapModel model;
  OverlapOptions options = overlap_options_default();
  ck_assert_ok(overlap_models_create_with(&model, "tpn", path, &options));
  overlap_model_destroy(&model);
  options.beyond = OVERLAP_BEYOND_EXACT;
  ck_assert_int_eq(overlap_models_create_with(&model, "tpn", path, &options), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "tetlap weights --range"));
  unlink(path);
}
END_TEST

START_TEST(hybrid_is_exact_where_shallow_deep_or_unsure_and_the_network_between) {
  double shallow[24], middle[24], deep[24];
  write_smooth(40, 8); // sure of everything
  slide(0.3, shallow), slide(0.15, middle), slide(0.01, deep);
  OverlapOptions options = overlap_options_default();
  OverlapModel sure = open_with("hybrid", options);
  ck_assert(ask(&sure, shallow).volume == exact_volume(shallow));
  ck_assert(ask(&sure, deep).volume == exact_volume(deep));
  ck_assert(ask(&sure, middle).flags == OVERLAP_NET);
  ck_assert(fabs(ask(&sure, middle).volume - exact_volume(middle)) > 0.01); // a network that learned nothing
  overlap_model_destroy(&sure);
  write_smooth(40, -8); // sure that nothing meets
  OverlapModel unsure = open_with("hybrid", options);
  Answer answer = ask(&unsure, middle);
  ck_assert(answer.volume == exact_volume(middle) && answer.flags == OVERLAP_FALLBACK);
  overlap_model_destroy(&unsure);
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
  tcase_add_test(test_case, a_file_says_which_model_it_is);
  tcase_add_test(test_case, ghosts_are_kept_cut_or_faded_as_asked);
  tcase_add_test(test_case, the_gate_multiplies_by_the_probability);
  tcase_add_test(test_case, both_orders_make_it_symmetric);
  tcase_add_test(test_case, pairs_beyond_the_range_are_counted_or_sent_to_exact);
  tcase_add_test(test_case, a_range_that_is_not_known_cannot_send_pairs_to_exact);
  tcase_add_test(test_case, hybrid_is_exact_where_shallow_deep_or_unsure_and_the_network_between);
  return suite_run("net_overlap", test_case, 30);
}

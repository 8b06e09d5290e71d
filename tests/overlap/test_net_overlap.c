// SPDX-License-Identifier: GPL-3.0-or-later
// TetrahedronPairNet as an overlap model, with random weights: what holds for any network.
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/random.h"
#include "net/files/weights.h"
#include "overlap/exact/exact.h"
#include "overlap/invariant.h"
#include "overlap/model.h"
#include "overlap/tpn/model.h"
#include "suite.h"

static char path[64];

static const char RANGE[] =
    "radius 0.5 to 2, first volume 0.1 to 0.2, second volume 0.01 to 1, overlap to 0.15";

// Random weights. `volume`: what the volume head says, about; `logit`: likewise.
static void write_shape(const NetShape *shape, const char *normalisation, const char *range, float volume,
                        float logit) {
  NetModel_f32 model;
  char input[64], covered[160], provenance[] = "random weights";
  snprintf(input, sizeof input, "%s", normalisation);
  snprintf(covered, sizeof covered, "%s", range);
  NetCard card = {.normalisation = input, .range = covered, .provenance = provenance};
  snprintf(path, sizeof path, "/tmp/test_net_overlap_%d.safetensors", (int)getpid());
  ck_assert_int_eq(net_model_create_f32(shape, &model), NET_OK);
  net_model_initialise_f32(&model, 3);
  float *volume_bias = NULL, *logit_bias = NULL;
  for (int k = 0; k < model.plan->tensor_count; k++) {
    const NetTensor *tensor = &model.plan->tensors[k];
    if (tensor->rows != 1 || tensor->columns != 0) continue;
    if (strncmp(tensor->name, "volume", 6) == 0) volume_bias = model.parameters + tensor->offset;
    if (strncmp(tensor->name, "status", 6) == 0) logit_bias = model.parameters + tensor->offset;
  }
  ck_assert(volume_bias && logit_bias);
  *volume_bias = volume;
  *logit_bias = logit;
  ck_assert_int_eq(net_weights_write_f32(path, &model, &card), NET_OK);
  net_model_destroy_f32(&model);
}

static void write_network(const char *normalisation, NetActivation activation) {
  NetShape shape = net_shape_tpn_a();
  shape.activation = activation;
  // V > 0 whatever the input; not larger than needed, for float's rounding
  write_shape(&shape, normalisation, RANGE, normalisation[0] == 'p' ? 2 : 40, 0);
}

// A network whose V has a continuous gradient.
static void write_smooth(float volume, float logit) {
  NetShape shape = net_shape_tpn_a();
  shape.activation = NET_SILU;
  shape.pool = NET_SUM;
  write_shape(&shape, "unit, V times 1000", RANGE, volume, logit);
}

static void draw_pairs(uint64_t seed, int count, double *pairs) {
  Random random = random_seeded(seed, 0);
  for (int i = 0; i < 24 * count; i++) pairs[i] = random_uniform(&random);
}

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
  ck_assert_ok(overlap_tpn_model_create(&self, path, NULL));
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
  ck_assert_ok(overlap_tpn_model_create(&self, path, NULL));
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
  ck_assert_ok(overlap_tpn_model_create(&self, path, NULL));
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
  ck_assert_int_eq(overlap_tpn_model_create(&self, path, NULL), STATUS_INPUT);
  ck_assert(strstr(status_message(), "analytic-centre frame") && strstr(status_message(), path));
  unlink(path);
}
END_TEST

static OverlapModel open_with(const char *name, OverlapOptions options) {
  OverlapModel model;
  ck_assert_ok(overlap_model_create_with(&model, name, path, &options));
  return model;
}

typedef struct Answer {
  double volume, gradient[24];
  unsigned flags;
} Answer;

static Answer ask(const OverlapModel *model, const double pair[24]) {
  Answer answer;
  OverlapBatch batch = {.pair_count = 1,
                        .pairs = pair,
                        .volume = &answer.volume,
                        .gradient = answer.gradient,
                        .flags = &answer.flags};
  ck_assert_ok(overlap_model_eval(model, &batch));
  return answer;
}

// The unit simplex, and the same moved along the diagonal: they touch where `by` is 1/3, share 1/6 where it
// is 0.
static void slide(double by, double pair[24]) {
  static const double simplex[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int i = 0; i < 12; i++) pair[i] = simplex[i], pair[12 + i] = simplex[i] + by;
}

START_TEST(a_file_says_which_model_it_is) {
  OverlapModel model;
  write_network("unit, V times 1000", NET_RELU);
  ck_assert_ok(overlap_model_create(&model, path));
  ck_assert(model.ops == &overlap_tpn_ops && overlap_model_has_ghosts(&model));
  overlap_model_destroy(&model);
  ck_assert_ok(overlap_model_create(&model, TETLAP_SOURCE_DIR "/net/weights/geo-small.safetensors"));
  ck_assert(strcmp(model.ops->name, "geo") == 0 && !overlap_model_has_ghosts(&model));
  overlap_model_destroy(&model);
  unlink(path);
  ck_assert_int_eq(overlap_model_create(&model, path), STATUS_IO);
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

static double exact_volume(const double pair[24]) {
  double volume;
  unsigned flags;
  ck_assert_ok(overlap_exact_ops.eval_pair(NULL, pair, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
  return volume;
}

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
  ck_assert_ok(overlap_model_create_with(&model, "tpn", path, &options));
  overlap_model_destroy(&model);
  options.beyond = OVERLAP_BEYOND_EXACT;
  ck_assert_int_eq(overlap_model_create_with(&model, "tpn", path, &options), STATUS_INPUT);
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

// Along the whole path from apart to coincident, in steps that blends can be seen in, V and ∇V change no more
// than in proportion to the step; and ∇V is the slope of V.
static void check_path(const char *name, OverlapOptions options, int *blended) {
  enum { STEPS = 4000 };
  OverlapModel model = open_with(name, options);
  Answer before = {0};
  double jump_volume = 0, jump_gradient = 0, slope_error = 0, largest = 0, top = 0.37,
         h = (top - 0.005) / STEPS;
  *blended = 0;
  for (int k = 0; k <= STEPS; k++) {
    double pair[24], difference = 0, slope = 0;
    slide(top - h * k, pair);
    pair[3] += 0.05, pair[19] -= 0.04; // nothing parallel
    Answer now = ask(&model, pair);
    for (int i = 0; i < 24; i++) difference += pow(now.gradient[i] - before.gradient[i], 2);
    for (int i = 12; i < 24; i++) slope -= 0.5 * (now.gradient[i] + before.gradient[i]);
    jump_volume = suite_larger(jump_volume, fabs(now.volume - before.volume));
    jump_gradient = suite_larger(jump_gradient, sqrt(difference));
    largest = suite_larger(largest, fabs(slope));
    slope_error = suite_larger(slope_error, fabs((now.volume - before.volume) / h - slope));
    *blended += (now.flags & OVERLAP_BLENDED) != 0;
    before = now;
  }
  ck_assert_msg(jump_volume < 5 * h * largest, "%s: V jumps by %g, slope %g", name, jump_volume, largest);
  ck_assert_msg(jump_gradient < 0.05 * largest, "%s: the gradient jumps by %g of %g", name, jump_gradient,
                largest);
  ck_assert_msg(slope_error < 0.02 * largest, "%s: slope off by %g of %g", name, slope_error, largest);
  overlap_model_destroy(&model);
}

START_TEST(volume_and_gradient_are_continuous_along_a_path) {
  int blended;
  OverlapOptions options = overlap_options_default();
  write_smooth(40, 1.5f);
  check_path("tpn-scene", options, &blended);
  options.beyond = OVERLAP_BEYOND_EXACT;
  check_path("tpn-scene", options, &blended);
  check_path("hybrid", options, &blended);
  ck_assert_int_ge(blended, 100);
  unlink(path);
}
END_TEST

// Two spikes of four tetrahedra each, tip into tip by `depth` of their height of 1, their inner faces in the
// same planes x = 0 and y = 0; the upper one moved aside by `shift`. What pushes it along x if all pairs
// press alike.
static double push_aside(const OverlapModel *model, double depth, double shift) {
  static const double corner[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  double push = 0;
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < 4; b++) {
      const double *p = corner[a], *q = corner[(a + 1) % 4], *r = corner[b], *s = corner[(b + 1) % 4];
      double base = 2 - depth;
      Answer answer = ask(
          model, (double[24]){0, 0,        0, p[0], p[1],         0,    q[0], q[1],         0,    0,    0,
                              1, shift,    0, base, shift + s[0], s[1], base, shift + r[0], r[1], base, shift,
                              0, 1 - depth});
      for (int v = 4; v < 8; v++) push -= answer.gradient[3 * v];
    }
  return push;
}

// Where inner faces slide through one another's planes, pairs beside each other have kinks that cancel: what
// `exact` says of the slice is missing in its neighbours' V if a network answers them as any other pair.
START_TEST(the_force_of_meshes_in_the_same_planes_does_not_leap) {
  const double shift = 1e-7;
  double leap[3];
  OverlapOptions options = overlap_options_default();
  options.beyond = OVERLAP_BEYOND_COUNT;
  write_smooth(40, 8);
  for (int coplanar = OVERLAP_COPLANAR_AUTO; coplanar <= OVERLAP_COPLANAR_CLIP; coplanar++) {
    options.coplanar = (OverlapCoplanar)coplanar;
    OverlapModel model = open_with("hybrid", options);
    leap[coplanar] = fabs(push_aside(&model, 0.7, shift) - push_aside(&model, 0.7, -shift));
    overlap_model_destroy(&model);
  }
  // each inner face in the overlap has an area of about 0.1
  ck_assert_msg(leap[OVERLAP_COPLANAR_KEEP] > 0.05, "keep: %g", leap[OVERLAP_COPLANAR_KEEP]);
  ck_assert_msg(leap[OVERLAP_COPLANAR_CLIP] < 1e-4, "clip: %g", leap[OVERLAP_COPLANAR_CLIP]);
  ck_assert_msg(leap[OVERLAP_COPLANAR_AUTO] < 1e-4, "auto: %g", leap[OVERLAP_COPLANAR_AUTO]);
  unlink(path);
}
END_TEST

// ∇V against differences, where gate, fading, range and confidence all vary.
START_TEST(gradient_holds_through_gate_fading_range_and_blend) {
  static const char *const names[] = {"tpn-scene", "hybrid"};
  write_smooth(40, 1.5f);
  for (int m = 0; m < 2; m++) {
    OverlapOptions options = overlap_options_default();
    options.beyond = OVERLAP_BEYOND_EXACT;
    options.touch = 0.2; // most pairs lie in the bands
    options.deep = 0.6;
    OverlapModel model = open_with(names[m], options);
    Random random = random_seeded(9, 0);
    int mixed = 0, right = 0;
    for (int n = 0; n < 60; n++) {
      double pair[24], worst = 0, size = 0;
      slide(0.1 + 0.1 * random_uniform(&random), pair);
      for (int i = 0; i < 24; i++) pair[i] += 0.2 * (random_uniform(&random) - 0.5);
      Answer answer = ask(&model, pair);
      for (int i = 0; i < 24; i++) size = fmax(size, fabs(answer.gradient[i]));
      for (int i = 0; i < 24; i++) {
        double step = 3e-4, kept = pair[i];
        pair[i] = kept + step;
        double above = ask(&model, pair).volume;
        pair[i] = kept - step;
        double below = ask(&model, pair).volume;
        pair[i] = kept;
        worst = suite_larger(worst, fabs((above - below) / (2 * step) - answer.gradient[i]));
      }
      mixed += (answer.flags & OVERLAP_NET) != 0;
      right += worst < 0.01 * size;
    }
    ck_assert_int_ge(mixed, 30);
    ck_assert_msg(right >= 58, "%s: %d of 60 right", names[m], right);
    overlap_model_destroy(&model);
  }
  unlink(path);
}
END_TEST

// ∇²V against differences of ∇V, through the same, and where faces are nearly coplanar.
static void check_bend(const char *name, OverlapOptions options, double squeeze) {
  enum { PAIRS = 60 };
  OverlapModel model = open_with(name, options);
  Random random = random_seeded(11, 0);
  int mixed = 0, right = 0;
  for (int n = 0; n < PAIRS; n++) {
    double pair[24], gradient[24], volume, hessian[576], worst = 0, size = 0;
    unsigned flags;
    slide(0.1 + 0.1 * random_uniform(&random), pair);
    for (int i = 0; i < 24; i++) pair[i] += 0.2 * (random_uniform(&random) - 0.5);
    if (squeeze > 0) // the faces at the bottom nearly in one plane
      for (int v = 0; v < 8; v++)
        if (v % 4 != 3) pair[3 * v + 2] = squeeze * random_uniform(&random);
    OverlapBatch batch = {.pair_count = 1,
                          .pairs = pair,
                          .volume = &volume,
                          .gradient = gradient,
                          .hessian = hessian,
                          .flags = &flags};
    ck_assert_ok(overlap_model_eval(&model, &batch));
    Answer answer = ask(&model, pair);
    ck_assert_near(volume, answer.volume, 1e-6 * volume);
    ck_assert_int_eq(flags, answer.flags);
    for (int i = 0; i < 576; i++) size = fmax(size, fabs(hessian[i]));
    for (int i = 0; i < 24; i++) {
      ck_assert_near(gradient[i], answer.gradient[i], 1e-4 * fabs(size));
      double step = 1e-3, kept = pair[i];
      pair[i] = kept + step;
      Answer above = ask(&model, pair);
      pair[i] = kept - step;
      Answer below = ask(&model, pair);
      pair[i] = kept;
      for (int j = 0; j < 24; j++) {
        double difference = (above.gradient[j] - below.gradient[j]) / (2 * step);
        worst = suite_larger(worst, fabs(difference - hessian[24 * j + i]));
        ck_assert_near(hessian[24 * j + i], hessian[24 * i + j], 1e-5 * size);
      }
    }
    mixed += (flags & (squeeze > 0 ? OVERLAP_BLENDED : OVERLAP_NET)) != 0;
    right += worst < 0.02 * size;
  }
  ck_assert_int_ge(mixed, PAIRS / 3);
  // differences cross the ends of bands, where ∇²V jumps, and corners of the true volume
  ck_assert_msg(right >= PAIRS * 8 / 10, "%s: %d of %d right", name, right, PAIRS);
  overlap_model_destroy(&model);
}

START_TEST(second_derivatives_hold_through_gate_fading_range_and_blend) {
  write_smooth(40, 1.5f);
  OverlapOptions options = overlap_options_default();
  options.coplanar = OVERLAP_COPLANAR_KEEP;
  check_bend("tpn", options, 0);
  check_bend("tpn-scene", options, 0);
  options.beyond = OVERLAP_BEYOND_EXACT;
  options.touch = 0.2;
  options.deep = 0.6;
  check_bend("tpn-scene", options, 0);
  check_bend("hybrid", options, 0);
  options.coplanar = OVERLAP_COPLANAR_CLIP;
  check_bend("tpn-scene", options, 0.1);
  check_bend("hybrid", options, 0.1);
  unlink(path);
}
END_TEST

// A network that says too much: V is bent to stay below the smaller tetrahedron, and the derivatives with it.
START_TEST(volumes_stay_below_the_smaller_tetrahedron) {
  static const char *const names[] = {"tpn-scene", "hybrid"};
  static const float said[] = {60, 120, 160}; // thousandths of V over six times the first volume, about
  int near = 0;
  for (int k = 0; k < 3; k++) {
    write_smooth(said[k], 8);
    OverlapOptions options = overlap_options_default();
    options.beyond = OVERLAP_BEYOND_COUNT;
    options.coplanar = OVERLAP_COPLANAR_KEEP;
    for (int m = 0; m < 2; m++) {
      OverlapModel model = open_with(names[m], options);
      Random random = random_seeded(12, 0);
      for (int n = 0; n < 300; n++) {
        double pair[24];
        slide(0.4 * random_uniform(&random), pair);
        double size = pow(10, -3 * random_uniform(&random)); // of the second
        for (int i = 12; i < 24; i++) pair[i] = pair[12 + i % 3] + size * (pair[i] - pair[12 + i % 3]);
        for (int i = 0; i < 24; i++) pair[i] += 0.1 * size * random_uniform(&random);
        double smaller = overlap_invariant_smaller_volume(pair), volume = ask(&model, pair).volume;
        ck_assert_msg(volume <= smaller, "%s: V = %g of %g", names[m], volume, smaller);
        near += volume > 0.95 * smaller;
      }
      overlap_model_destroy(&model);
    }
    check_bend("tpn-scene", options, 0);
    check_bend("hybrid", options, 0);
  }
  ck_assert_int_gt(near, 100);
  unlink(path);
}
END_TEST

START_TEST(networks_that_do_not_bend_offer_no_second_derivatives) {
  static const char *const normalisations[] = {"pca, V times 1000", "sorted, V times 1000",
                                               "unit, V times 1000"};
  for (int k = 0; k < 3; k++) {
    write_network(normalisations[k], k == 2 ? NET_RELU : NET_SILU);
    OverlapModel model = open_with("tpn", overlap_options_default());
    ck_assert(!overlap_model_has_hessian(&model));
    overlap_model_destroy(&model);
  }
  write_smooth(40, 0);
  OverlapModel model = open_with("tpn", overlap_options_default());
  ck_assert(overlap_model_has_hessian(&model));
  overlap_model_destroy(&model);
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
  tcase_add_test(test_case, volume_and_gradient_are_continuous_along_a_path);
  tcase_add_test(test_case, the_force_of_meshes_in_the_same_planes_does_not_leap);
  tcase_add_test(test_case, gradient_holds_through_gate_fading_range_and_blend);
  tcase_add_test(test_case, second_derivatives_hold_through_gate_fading_range_and_blend);
  tcase_add_test(test_case, volumes_stay_below_the_smaller_tetrahedron);
  tcase_add_test(test_case, networks_that_do_not_bend_offer_no_second_derivatives);
  return suite_run("net_overlap", test_case, 30);
}

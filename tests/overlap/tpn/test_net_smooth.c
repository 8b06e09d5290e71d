// SPDX-License-Identifier: GPL-3.0-or-later
// TetrahedronPairNet in scenes, alone and blended with the exact model: V and its derivatives change
// steadily, and are derivatives of one another, through gate, fading, range and blend.
#include "random_network.h"

#include "overlap/pair/invariant.h"
#include "overlap/tpn/model.h"

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
  TCase *test_case = tcase_create("net_smooth");
  tcase_add_test(test_case, volume_and_gradient_are_continuous_along_a_path);
  tcase_add_test(test_case, the_force_of_meshes_in_the_same_planes_does_not_leap);
  tcase_add_test(test_case, gradient_holds_through_gate_fading_range_and_blend);
  tcase_add_test(test_case, second_derivatives_hold_through_gate_fading_range_and_blend);
  tcase_add_test(test_case, volumes_stay_below_the_smaller_tetrahedron);
  tcase_add_test(test_case, networks_that_do_not_bend_offer_no_second_derivatives);
  return suite_run("net_smooth", test_case, 30);
}

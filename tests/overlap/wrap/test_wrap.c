// SPDX-License-Identifier: GPL-3.0-or-later
// Wrappers round models (overlap/wrap). The oracles are the inner models, `clip`, and differences.
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "base/random.h"
#include "overlap/models.h"
#include "overlap/pair/invariant.h"
#include "overlap/separation.h"
#include "overlap/slopes.h"

enum { PAIRS = 120, SIZE = 24 };

static double pairs[PAIRS][SIZE], swapped[PAIRS][SIZE];

typedef struct Answers {
  double volume[PAIRS], gradient[PAIRS][SIZE], hessian[PAIRS][SIZE][SIZE], centroid[PAIRS][3];
  unsigned flags[PAIRS];
} Answers;
static Answers inner, outer, other;

// Pairs that overlap, and some that do not.
static void draw(void) {
  Random random = random_seeded(5, 0);
  for (int i = 0; i < PAIRS; i++) {
    for (int v = 0; v < SIZE; v++)
      pairs[i][v] = random_uniform(&random) + (i % 4 == 3 && v >= 12 && v % 3 == 0);
    overlap_ops_swap(pairs[i], swapped[i]);
  }
}

enum { VOLUMES, GRADIENTS, HESSIANS };

static void ask(const char *word, double (*x)[SIZE], int order, bool with_centroid, Answers *answers) {
  OverlapModel model;
  ck_assert_ok(overlap_models_create(&model, word));
  OverlapBatch batch = {.pair_count = PAIRS,
                        .pairs = x[0],
                        .volume = answers->volume,
                        .gradient = order >= GRADIENTS ? answers->gradient[0] : NULL,
                        .hessian = order >= HESSIANS ? answers->hessian[0][0] : NULL,
                        .centroid = with_centroid ? answers->centroid[0] : NULL,
                        .flags = answers->flags};
  ck_assert_ok(overlap_model_eval(&model, &batch));
  overlap_model_destroy(&model);
}

static void expect_refused(const char *word, const char *says) {
  OverlapModel model;
  ck_assert_int_eq(overlap_models_create(&model, word), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), says), "%s", status_message());
}

static void compare_centroids(const double a[3], const double b[3], double most) {
  for (int c = 0; c < 3; c++) ck_assert_near(a[c], b[c], most);
}

// V x̄ is that of the mean, too.
START_TEST(both_is_the_mean_of_both_orders_of_any_model) {
  static const char *const names[][2] = {{"tpn-published", "both=tpn-published"},
                                         {"tpn-scene", "both=tpn-scene"},
                                         {TETLAP_MODEL_SPLIT, "both=" TETLAP_MODEL_SPLIT}};
  const bool has_gradient = _i < 2;
  ask(names[_i][0], pairs, has_gradient ? GRADIENTS : VOLUMES, true, &inner);
  ask(names[_i][0], swapped, has_gradient ? GRADIENTS : VOLUMES, true, &other);
  ask(names[_i][1], pairs, has_gradient ? GRADIENTS : VOLUMES, true, &outer);
  int unlike = 0;
  for (int i = 0; i < PAIRS; i++) {
    const double sum = inner.volume[i] + other.volume[i];
    ck_assert(outer.volume[i] == sum / 2);
    unlike += inner.volume[i] != other.volume[i];
    for (int v = 0; v < SIZE && has_gradient; v++)
      ck_assert(outer.gradient[i][v] == (inner.gradient[i][v] + other.gradient[i][(v + 12) % SIZE]) / 2);
    for (int c = 0; c < 3 && sum > 0; c++)
      ck_assert_near(outer.centroid[i][c] * sum,
                     inner.volume[i] * inner.centroid[i][c] + other.volume[i] * other.centroid[i][c], 1e-15);
  }
  ck_assert_int_gt(unlike, 0);
  ask(names[_i][1], swapped, VOLUMES, false, &other);
  ck_assert_int_eq(memcmp(other.volume, outer.volume, sizeof outer.volume), 0);
}
END_TEST

START_TEST(cut_answers_disjoint_pairs_and_leaves_the_others_alone) {
  int disjoint = 0;
  ask("tpn-published", pairs, GRADIENTS, false, &inner);
  ask("cut=tpn-published", pairs, GRADIENTS, false, &outer);
  for (int i = 0; i < PAIRS; i++) {
    const bool is_apart = overlap_separation_pair(pairs[i], 0) >= 0;
    disjoint += is_apart && inner.volume[i] > 0;
    ck_assert_int_eq((outer.flags[i] & OVERLAP_DISJOINT) != 0, is_apart || inner.volume[i] == 0);
    for (int v = 0; v < SIZE; v++) ck_assert(outer.gradient[i][v] == (is_apart ? 0 : inner.gradient[i][v]));
    ck_assert(outer.volume[i] == (is_apart ? 0 : inner.volume[i]));
  }
  ck_assert_int_gt(disjoint, 0);
}
END_TEST

// 1 of pairs that share more than the number says, 0 of those that touch, and never more than it was.
START_TEST(fade_begins_at_touch) {
  static const char *const names[][2] = {
      {"tpn", "fade:.4=tpn"}, {"geo", "fade:.4=geo"}, {TETLAP_MODEL_SPLIT, "fade:.4=" TETLAP_MODEL_SPLIT}};
  int faded = 0, whole = 0;
  ask(names[_i][0], pairs, VOLUMES, true, &inner);
  ask(names[_i][1], pairs, VOLUMES, true, &outer);
  for (int i = 0; i < PAIRS; i++) {
    if (overlap_separation_pair(pairs[i], 0) >= 0) {
      ck_assert(outer.volume[i] == 0 && outer.flags[i] == OVERLAP_DISJOINT);
      continue;
    }
    ck_assert(outer.volume[i] <= inner.volume[i]);
    faded += outer.volume[i] < 0.9 * inner.volume[i], whole += outer.volume[i] == inner.volume[i];
    if (outer.volume[i] > 0) compare_centroids(outer.centroid[i], inner.centroid[i], 1e-12);
  }
  ck_assert(faded > 10 && whole > 0);
}
END_TEST

// Beside a face of the outer one in the plane of one of its own: `coplanar` leaves the pair to clip.
START_TEST(what_clip_finds_enclosed_stays_enclosed) {
  static const double outside[12] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4};
  static const char *const words[] = {"hybrid=placed=" TETLAP_MODEL_16, "coplanar=placed=" TETLAP_MODEL_16};
  for (int v = 0; v < 12; v++) {
    pairs[0][v] = 0.61 + 0.2 * (v / 3 == v % 3 + 1); // the first coordinate is what the model doubts by
    pairs[0][12 + v] = outside[v];
    if (_i == 1 && v % 3 == 2) pairs[0][v] -= 0.61;
  }
  ask("clip", pairs, VOLUMES, false, &other);
  ask(words[_i], pairs, VOLUMES, false, &outer);
  ck_assert_uint_eq(other.flags[0], OVERLAP_ENCLOSED);
  ck_assert_uint_eq(outer.flags[0], OVERLAP_FALLBACK | OVERLAP_ENCLOSED);
  ck_assert_near(outer.volume[0], other.volume[0], 1e-15);
}
END_TEST

// Planes that coincide are clip's business; pairs in general position are not.
START_TEST(coplanar_turns_to_clip_where_faces_lie_in_one_plane) {
  int general = 0;
  for (int v = 0; v < 12; v += 3) pairs[0][v + 2] = v < 9 ? 0 : 1, pairs[0][12 + v + 2] = v < 9 ? 0 : 0.9;
  ask("tpn-scene", pairs, VOLUMES, true, &inner);
  ask("coplanar=tpn-scene", pairs, VOLUMES, true, &outer);
  ask("clip", pairs, VOLUMES, true, &other);
  ck_assert(other.volume[0] > 1e-4 && fabs(inner.volume[0] / other.volume[0] - 1) > 1e-3);
  ck_assert_near(outer.volume[0], other.volume[0], 1e-12);
  compare_centroids(outer.centroid[0], other.centroid[0], 1e-9);
  for (int i = 1; i < PAIRS; i++) general += inner.volume[i] > 0 && outer.volume[i] == inner.volume[i];
  ck_assert_int_gt(general, PAIRS / 4);
}
END_TEST

// The model's V is 1e-3, or 0, and its doubt 0, infinite, or between, as the first coordinate has it.
START_TEST(hybrid_is_clip_where_a_model_of_yours_doubts) {
  int left[3] = {0}, missed = 0;
  ask("hybrid=placed=" TETLAP_MODEL_16, pairs, VOLUMES, true, &outer);
  ask("clip", pairs, VOLUMES, true, &other);
  for (int i = 0; i < PAIRS; i++) {
    const double x = pairs[i][0], c = (outer.volume[i] - 1e-3) / (other.volume[i] - 1e-3);
    if (!(overlap_invariant_smaller_volume(pairs[i]) > 2e-3) || overlap_separation_pair(pairs[i], 0) >= 0 ||
        fabs(other.volume[i] - 1e-3) < 1e-4)
      continue;
    if (x < 0.3) ck_assert(outer.volume[i] == 1e-3);
    if (x > 0.6) ck_assert_near(c, 1, 1e-9);
    if (x > 0.3 && x < 0.6) ck_assert(c > 0.1 && c < 0.9 && (outer.flags[i] & OVERLAP_BLENDED));
    left[x < 0.3 ? 0 : x > 0.6 ? 2 : 1]++;
    missed += x > 0.8;
    if (other.volume[i] > 1e-6) compare_centroids(outer.centroid[i], other.centroid[i], 1e-9);
  }
  ck_assert(left[0] > 3 && left[1] > 3 && left[2] > 3 && missed > 0);
  OverlapModel model;
  ck_assert_ok(overlap_models_create(&model, "hybrid=" TETLAP_MODEL_16));
  ck_assert(!overlap_model_has_gradient(&model) && !overlap_model_has_own_centroid(&model));
  overlap_model_destroy(&model);
}
END_TEST

// By the factor `band` beyond an end of what library.c declares; V is 1e-4 Σ x².
static bool is_beyond(const double pair[SIZE], double band) {
  double centre[3] = {0, 0, 0}, square = 0, sum = 0;
  for (int v = 0; v < 12; v++) centre[v % 3] += pair[v] / 4;
  for (int v = 0; v < SIZE; v++) {
    square += (pair[v] - centre[v % 3]) * (pair[v] - centre[v % 3]) / 8;
    sum += pair[v] * pair[v];
  }
  bool is_beyond = sqrt(square) > 0.7 * band || 1e-4 * sum > 0.0008 * band;
  for (int t = 0; t < 2; t++) {
    const double volume = overlap_invariant_tet_volume(pair + 12 * t);
    is_beyond |= volume < 0.005 / band || volume > 0.04 * band;
  }
  return is_beyond;
}

START_TEST(hybrid_is_clip_beyond_the_range_that_a_model_of_yours_declares) {
  int left[3] = {0};
  ask(TETLAP_MODEL_19, pairs, VOLUMES, false, &inner);
  ask("hybrid=" TETLAP_MODEL_19, pairs, VOLUMES, false, &outer);
  ask("clip", pairs, VOLUMES, false, &other);
  for (int i = 0; i < PAIRS; i++) {
    if (inner.flags[i] & OVERLAP_DISJOINT || !(other.volume[i] > 0)) continue;
    const int place = is_beyond(pairs[i], 1) + is_beyond(pairs[i], 1.5);
    ck_assert_int_eq((inner.flags[i] & OVERLAP_BEYOND) != 0, place > 0);
    ck_assert_int_eq((outer.flags[i] & OVERLAP_BEYOND) != 0, place > 0);
    if (place == 0) ck_assert(outer.volume[i] == inner.volume[i]);
    if (place == 2) ck_assert(outer.flags[i] & OVERLAP_FALLBACK);
    if (place == 2) ck_assert_near(outer.volume[i], other.volume[i], 1e-15);
    if (place == 1 && inner.volume[i] != other.volume[i])
      ck_assert((outer.volume[i] - inner.volume[i]) * (outer.volume[i] - other.volume[i]) < 0);
    left[place]++;
  }
  ck_assert(left[0] > 3 && left[1] > 3 && left[2] > 3);
}
END_TEST

// Differences of V: the share of clip follows the doubt, the range and V itself.
START_TEST(hybrid_of_a_model_of_yours_is_differentiated_with_its_share) {
  static const char *const words[] = {"hybrid=" TETLAP_MODEL_18, "hybrid=" TETLAP_MODEL_19,
                                      "hybrid=both=" TETLAP_MODEL_18, "hybrid=keep=" TETLAP_MODEL_18};
  static double moved[PAIRS][SIZE];
  const double h = 2e-7;
  int blended = 0;
  ask(words[_i], pairs, GRADIENTS, false, &outer);
  for (int v = 0; v < SIZE; v++) {
    for (int s = 0; s < 2; s++) {
      memcpy(moved, pairs, sizeof moved);
      for (int i = 0; i < PAIRS; i++) moved[i][v] += s ? h : -h;
      ask(words[_i], moved, VOLUMES, false, s ? &other : &inner);
    }
    for (int i = 0; i < PAIRS; i++) {
      if (!(outer.flags[i] & OVERLAP_BLENDED) || !(inner.volume[i] > 0 && other.volume[i] > 0)) continue;
      ck_assert_near((other.volume[i] - inner.volume[i]) / (2 * h), outer.gradient[i][v], 1e-7);
      blended++;
    }
  }
  ck_assert_int_gt(blended, 10 * SIZE);
}
END_TEST

START_TEST(placed_and_derived_choose_the_centroid) {
  ask("tpn", pairs, VOLUMES, true, &inner);
  ask("placed=tpn", pairs, VOLUMES, true, &outer);
  ask("clip", pairs, VOLUMES, true, &other);
  int unlike = 0;
  for (int i = 0; i < PAIRS; i++) {
    ck_assert(outer.volume[i] == inner.volume[i]);
    if (!(other.volume[i] > 0 && inner.volume[i] > 0)) continue;
    ck_assert_int_eq(memcmp(outer.centroid[i], other.centroid[i], sizeof *outer.centroid), 0);
    unlike += fabs(inner.centroid[i][0] - other.centroid[i][0]) > 1e-3;
  }
  ck_assert_int_gt(unlike, PAIRS / 4);
  ask("derived=clip", pairs, VOLUMES, true, &outer); // its ∇V is that of a true volume
  for (int i = 0; i < PAIRS; i++)
    if (other.volume[i] > 1e-4) compare_centroids(outer.centroid[i], other.centroid[i], 1e-7);
  ck_assert(memcmp(outer.centroid, other.centroid, sizeof outer.centroid) != 0);
}
END_TEST

// Differences of V and ∇V in general position, of which clip has exact ones. The number fades nearly all.
START_TEST(derivatives_are_those_of_what_comes_out) {
  static const char *const words[] = {"both=clip", "fade:.9=clip", "coplanar=clip", "coplanar=fade:.9=geo"};
  static double moved[PAIRS][SIZE];
  const double h = 1e-6;
  int bent = 0;
  ask(words[_i], pairs, HESSIANS, false, &outer);
  for (int v = 0; v < SIZE; v += 5) {
    for (int s = 0; s < 2; s++) {
      memcpy(moved, pairs, sizeof moved);
      for (int i = 0; i < PAIRS; i++) moved[i][v] += s ? h : -h;
      ask(words[_i], moved, GRADIENTS, false, s ? &other : &inner);
    }
    for (int i = 0; i < PAIRS; i++) {
      if (outer.volume[i] < 1e-3 || !(inner.volume[i] > 0 && other.volume[i] > 0)) continue;
      ck_assert_near((other.volume[i] - inner.volume[i]) / (2 * h), outer.gradient[i][v], 1e-7);
      for (int w = 0; w < SIZE; w++)
        ck_assert_near((other.gradient[i][w] - inner.gradient[i][w]) / (2 * h), outer.hessian[i][w][v], 1e-4);
      bent++;
    }
  }
  ck_assert_int_gt(bent, 15);
}
END_TEST

START_TEST(a_network_is_used_as_another_is) {
  static const char *const words[][2] = {
      {"tpn-scene", "tpn-scene=" TETLAP_SOURCE_DIR "/net/weights/tpn-scene.safetensors"},
      {"hybrid", "hybrid:.005=geo-small"}};
  ask(words[_i][0], pairs, GRADIENTS, true, &inner);
  ask(words[_i][1], pairs, GRADIENTS, true, &outer);
  ck_assert_int_eq(memcmp(inner.volume, outer.volume, sizeof inner.volume), 0);
  ck_assert_int_eq(memcmp(inner.gradient, outer.gradient, sizeof inner.gradient), 0);
}
END_TEST

START_TEST(what_cannot_be_said_is_refused) {
  expect_refused("bth=geo", "'bth=' is none of what stands before a model: cut, keep, fade");
  expect_refused("both:3=geo", "'both' takes no number");
  expect_refused("fade:2=geo", "is 2; expected one between 0 and 1");
  expect_refused("fade:abc=geo", "'abc' before '=' is no number");
  expect_refused("fade:nan=geo", "'nan' before '=' is no number");
  expect_refused("fade:=geo", "'' before '=' is no number");
  expect_refused("both=", "a model is missing behind it");
  expect_refused("hybrid:0=geo", "expected");
  expect_refused("hybrid:5=tpn-scene", "takes no number: leave 5 out, as in hybrid=tpn-scene");
  expect_refused("hybrid:.01=" TETLAP_SOURCE_DIR "/net/weights/tpn.safetensors",
                 "is a TetrahedronPairNet, which gives no bound of its error");
  expect_refused("both=hybrid:5=tpn-scene", "leave 5 out");
  expect_refused("hybrid=both=geo", "where the network has a bound of its error, write both=hybrid=geo");
  expect_refused("hybrid=both=fade:.05=tpn-scene=" TETLAP_SOURCE_DIR "/net/weights/tpn-scene.safetensors",
                 "write both=fade:.05=hybrid=" TETLAP_SOURCE_DIR "/net/weights/tpn-scene.safetensors");
  expect_refused("hybrid:.1=both=hybrid:.01=geo", "write both=hybrid:.01=geo");
  expect_refused("hybrid=both=" TETLAP_MODEL_0, "tells no doubt: how far each V may be off, and no range");
  expect_refused("keep=geo", "'geo' gives no volume to disjoint pairs");
  expect_refused("derived=" TETLAP_MODEL_SPLIT, "gives no gradient");
  expect_refused("both=gea", "did you mean 'geo'");
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("wrap");
  tcase_add_checked_fixture(cases, draw, NULL);
  tcase_add_loop_test(cases, both_is_the_mean_of_both_orders_of_any_model, 0, 3);
  tcase_add_test(cases, cut_answers_disjoint_pairs_and_leaves_the_others_alone);
  tcase_add_loop_test(cases, fade_begins_at_touch, 0, 3);
  tcase_add_test(cases, coplanar_turns_to_clip_where_faces_lie_in_one_plane);
  tcase_add_loop_test(cases, what_clip_finds_enclosed_stays_enclosed, 0, 2);
  tcase_add_test(cases, hybrid_is_clip_where_a_model_of_yours_doubts);
  tcase_add_test(cases, hybrid_is_clip_beyond_the_range_that_a_model_of_yours_declares);
  tcase_add_loop_test(cases, hybrid_of_a_model_of_yours_is_differentiated_with_its_share, 0, 4);
  tcase_add_test(cases, placed_and_derived_choose_the_centroid);
  tcase_add_loop_test(cases, derivatives_are_those_of_what_comes_out, 0, 4);
  tcase_add_loop_test(cases, a_network_is_used_as_another_is, 0, 2);
  tcase_add_test(cases, what_cannot_be_said_is_refused);
  return suite_run("wrap", cases, 60);
}

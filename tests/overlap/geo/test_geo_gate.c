// SPDX-License-Identifier: GPL-3.0-or-later
// Where the overlap model `geo` begins: which pairs intersect, and a point inside, however the rounding
// falls.
#include "suite.h"

#include <string.h>

#include "base/random.h"
#include "datagen/hard.h"
#include "overlap/exact/exact.h"
#include "overlap/geo/frame.h"
#include "overlap/pair/invariant.h"

START_TEST(the_gate_agrees_with_exact_in_every_class) {
  int inside = 0, empty = 0;
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    for (int member = 0; member < 300; member++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      OverlapGeoGate gate;
      OverlapGeoOutcome outcome = overlap_geo_gate(&gate, pair.x);
      double volume;
      unsigned flags;
      ck_assert_ok(
          overlap_exact_ops.eval_pair(NULL, pair.x, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
      // what the gate leaves to exact is right; overlaps thinner than rounding may be missed, none invented
      if (outcome == OVERLAP_GEO_UNFIT) continue;
      bool is_missed =
          outcome == OVERLAP_GEO_EMPTY && volume <= 1e-15 * overlap_invariant_smaller_volume(pair.x);
      ck_assert_msg((volume > 0) == (outcome == OVERLAP_GEO_INSIDE) || is_missed,
                    "%s, member %d: the gate says %d, V = %g", datagen_hard_classes[c].name, member, outcome,
                    volume);
      if (outcome == OVERLAP_GEO_INSIDE) ck_assert(gate.is_enclosed || !(flags & OVERLAP_ENCLOSED));
      *(outcome == OVERLAP_GEO_INSIDE ? &inside : &empty) += 1;
    }
  ck_assert_int_gt(inside, 3000);
  ck_assert_int_gt(empty, 3000);
}
END_TEST

START_TEST(only_flat_and_sliver_shaped_tetrahedra_are_left_to_exact) {
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++) {
    bool is_flat =
        strstr(datagen_hard_classes[c].name, "sliver") || strcmp(datagen_hard_classes[c].name, "flat") == 0;
    for (int member = 0; member < 300; member++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      OverlapGeoFrame frame;
      bool is_unfit = overlap_geo_frame(&frame, pair.x) == OVERLAP_GEO_UNFIT;
      ck_assert_msg(!is_unfit || is_flat, "%s, member %d", datagen_hard_classes[c].name, member);
      ck_assert_msg(is_unfit || !strstr(datagen_hard_classes[c].name, "sliver"), "member %d", member);
    }
  }
}
END_TEST

// Of two equal tetrahedra all planes coincide; `x` in one order of vertices of the second. The gate must find
// the whole of one in the other.
static void check_equal(const double tet[12], int order) {
  double x[24];
  memcpy(x, tet, 12 * sizeof *x);
  datagen_hard_permute(tet, order, x + 12);
  OverlapGeoGate gate;
  OverlapGeoOutcome outcome = overlap_geo_gate(&gate, x);
  ck_assert_msg(outcome == OVERLAP_GEO_INSIDE && gate.is_enclosed, "order %d: outcome %d, enclosed %d", order,
                outcome, gate.is_enclosed);
  for (int k = 0; k < 8; k++) ck_assert_near(gate.slack[k], 0.25, 1e-9);
}

// Found by tools/fuzz: det/L³ = 2e-5, so that a vertex on a plane seems to be 5e-12 beyond it.
START_TEST(equal_slivers_overlap_whole_in_every_order) {
  static const double sliver[12] = {0x1.6c8912a8b91eap+28, 0x1.0a394314fb5ecp+24, -0x1.2c83882049612p+24,
                                    0x1.15d8a25f810b7p+24, 0x1.34ed8a02ad56fp+27, 0x1.1b3ce7fe14007p+28,
                                    0x1.0dd000047eaacp+28, 0x1.b2106aefa6639p+25, 0x1.fd36bd116e788p+25,
                                    0x1.3078aa1e494ccp+26, 0x1.1ae1ca5ccf563p+28, 0x1.88fe23e0a4fb7p+26};
  for (int order = 0; order < 24; order++) check_equal(sliver, order);
}
END_TEST

START_TEST(equal_tetrahedra_of_any_flatness_overlap_whole_in_every_order) {
  Random random = random_seeded(61, 0);
  int seen = 0;
  for (int k = 0; k < 4000; k++) {
    double tet[12] = {0}, axes[9], height = pow(10, -4 * random_uniform(&random));
    random_rotation(&random, axes);
    for (int v = 0; v < 4; v++)
      for (int a = 0; a < 3; a++) {
        double length = (a == 2 ? height : 1) * random_uniform(&random);
        for (int c = 0; c < 3; c++) tet[3 * v + c] += length * axes[3 * a + c];
      }
    OverlapGeoGate gate;
    double twice[24];
    memcpy(twice, tet, sizeof tet), memcpy(twice + 12, tet, sizeof tet);
    if (overlap_geo_gate(&gate, twice) == OVERLAP_GEO_UNFIT) continue;
    for (int order = 0; order < 24; order++) check_equal(tet, order);
    seen++;
  }
  ck_assert_int_gt(seen, 3000);
}
END_TEST

static double exact_volume(const double x[24]) {
  double volume;
  unsigned flags;
  ck_assert_ok(overlap_exact_ops.eval_pair(NULL, x, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
  return volume;
}

// The gate must find the pair's overlap in each order of vertices and tetrahedra.
static void check_found(const double x[24], const char *what) {
  for (int order = 0; order < 2 * 24 * 24; order++) {
    double swapped[24], y[24];
    overlap_ops_swap(x, swapped);
    const double *from = order & 1 ? swapped : x;
    datagen_hard_permute(from, order / 2 % 24, y);
    datagen_hard_permute(from + 12, order / 48, y + 12);
    OverlapGeoGate gate;
    OverlapGeoOutcome outcome = overlap_geo_gate(&gate, y);
    ck_assert_msg(outcome == OVERLAP_GEO_INSIDE, "%s, order %d: outcome %d", what, order, outcome);
  }
}

// Found by tools/fuzz: faces nearly in one plane, so that where edges cross them is known to 1e-8 only.
START_TEST(crossings_at_a_shallow_slope_are_found_in_every_order) {
  static const double pairs[2][24] = {
      {0x1.3424061d02a49p+20, 0x1.f85ee039e87d1p+25, 0x1.e84807eeac681p+19, 0x1.34240755660f6p+20,
       0x1.f85ee0408efe3p+25, 0x1.e84806d6a0428p+19, 0x1.3424022ce2a92p+20, 0x1.f85ee03c6e9dfp+25,
       0x1.e848175c32a3ep+19, 0x1.34240382f7958p+20, 0x1.f85ee058fdf68p+25, 0x1.e8480f0889627p+19,
       0x1.34240693f1b48p+20, 0x1.f85ee0426fbeap+25, 0x1.e8480a7d7f8a6p+19, 0x1.342407555ea26p+20,
       0x1.f85ee0408efe3p+25, 0x1.e84806d6a0428p+19, 0x1.3424022ce3a93p+20, 0x1.f85ee03c6e9dfp+25,
       0x1.e848175c32a3ep+19, 0x1.34240382f8958p+20, 0x1.f85ee058fdf68p+25, 0x1.e8480f0889627p+19},
      {0x1.9b1p-2,
       0x1.0bb0000000001p-1,
       0x1.31f000fcp-2,
       0x1.98p-2,
       0x1.4000000000001p-1,
       0x1.c0000000004p-3,
       0x1.22p-1,
       0x1.58p-3,
       0x1.e8000000002p-2,
       0x1.b2p-1,
       0x1.bcp-1,
       0x1.f4000000002p-2,
       0x1.014p-1,
       0x1.2f8p-1,
       0x1.6bp-3,
       0x1.98p-2,
       0x1.4000000000001p-1,
       0x1.c00001cp-3,
       0x1.22p-1,
       0x1.58p-3,
       0x1.e7fffffffffffp-2,
       0x1.b2p-1,
       0x1.bcp-1,
       0x1.f4p-2},
  };
  for (int k = 0; k < 2; k++) {
    ck_assert_double_gt(exact_volume(pairs[k]), 1e-7 * overlap_invariant_smaller_volume(pairs[k]));
    check_found(pairs[k], k == 0 ? "shallow" : "nearly equal faces");
  }
}
END_TEST

// Two tetrahedra base to base, the second's base turned into the first about a line across it by an angle
// from 1 down to 1e-9.
static void draw_turned(Random *random, double x[24]) {
  double angle = pow(10, -9 * random_uniform(random));
  for (int i = 0; i < 24; i++) x[i] = random_uniform(random);
  for (int v = 0; v < 3; v++) {
    x[3 * v + 2] = 0;
    x[12 + 3 * v + 2] = angle * (x[12 + 3 * v] - 0.5);
  }
  x[11] += 0.2, x[23] = -0.2 - x[23];
}

START_TEST(bases_turned_against_each_other_are_found_in_every_order) {
  Random random = random_seeded(62, 0);
  int seen = 0;
  for (int k = 0; k < 100; k++) {
    double x[24];
    draw_turned(&random, x);
    OverlapGeoGate gate;
    if (overlap_geo_gate(&gate, x) == OVERLAP_GEO_UNFIT) continue;
    if (!(exact_volume(x) > 1e-11 * overlap_invariant_smaller_volume(x))) continue;
    check_found(x, "turned");
    seen++;
  }
  ck_assert_int_gt(seen, 30);
}
END_TEST

// What is wrong with the sum of a tetrahedron's four slacks is the net force of the pair.
static void check_sums(const OverlapGeoFrame *frame, int k) {
  for (int t = 0; t < 8; t += 4) {
    double sum = frame->slack[t] + frame->slack[t + 1] + frame->slack[t + 2] + frame->slack[t + 3];
    ck_assert_msg(fabs(sum - 1) <= 1e-15, "slice %d: the slacks sum to 1 + %g", k, sum - 1);
  }
}

// The first found by tools/fuzz.
START_TEST(slacks_sum_to_one_in_the_thinnest_slices) {
  static const double found[24] = {0x1.bcp-1,
                                   0x1.4effffff5a8p+25,
                                   0x1.5c3fffffccep+26,
                                   0x1.0fc0010f91401p+27,
                                   0x1.78dfffff45dp+25,
                                   0x1.5c3fffffccep+26,
                                   0x1.36f5ffffc87c1p+27,
                                   0x1.72ffffff7988p+25,
                                   0x1.4e2fffffd676p+26,
                                   0x1.0fbfffffd1401p+27,
                                   0x1.4effffff5a8p+25,
                                   0x1.5c3fffffccep+26,
                                   0x1.f500000000008p+24,
                                   0x1.078p+26,
                                   0x1.114p+26,
                                   0x1.36f5ffffc87c1p+27,
                                   0x1.72ffffff7988p+25,
                                   0x1.4e2fffffd676p+26,
                                   0x1.1100000000002p+26,
                                   0x1.4fp+25,
                                   0x1.5c4p+26,
                                   0x1.9840000000002p+26,
                                   0x1.bep+25,
                                   0x1.228p+26};
  OverlapGeoFrame frame;
  ck_assert_int_eq(overlap_geo_frame(&frame, found), OVERLAP_GEO_INSIDE);
  check_sums(&frame, -1);
  Random random = random_seeded(63, 0);
  double thinnest = 1;
  for (int k = 0; k < 300; k++) {
    double x[24];
    draw_turned(&random, x);
    if (overlap_geo_frame(&frame, x) != OVERLAP_GEO_INSIDE) continue;
    check_sums(&frame, k);
    for (int p = 0; p < 8; p++) thinnest = fmin(thinnest, frame.slack[p]);
  }
  ck_assert_double_lt(thinnest, 1e-9);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("geo_gate");
  tcase_add_test(cases, the_gate_agrees_with_exact_in_every_class);
  tcase_add_test(cases, only_flat_and_sliver_shaped_tetrahedra_are_left_to_exact);
  tcase_add_test(cases, equal_slivers_overlap_whole_in_every_order);
  tcase_add_test(cases, equal_tetrahedra_of_any_flatness_overlap_whole_in_every_order);
  tcase_add_test(cases, crossings_at_a_shallow_slope_are_found_in_every_order);
  tcase_add_test(cases, bases_turned_against_each_other_are_found_in_every_order);
  tcase_add_test(cases, slacks_sum_to_one_in_the_thinnest_slices);
  return suite_run("geo gate", cases, 60);
}

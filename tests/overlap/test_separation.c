// SPDX-License-Identifier: GPL-3.0-or-later
// contact/separation: sign and size of the separation of two tetrahedra.
#include "suite.h"

#include <string.h>

#include "base/random.h"
#include "base/vec3.h"
#include "overlap/models.h"
#include "overlap/separation.h"

static const double CORNER[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

static void place(double pair[24], const double b[12]) {
  memcpy(pair, CORNER, sizeof CORNER);
  memcpy(pair + 12, b, 12 * sizeof *b);
}

// A random tetrahedron around the origin and one `apart` away in a random direction.
static void random_pair(Random *random, double apart, double pair[24]) {
  double direction[3];
  random_direction(random, direction);
  for (int k = 0; k < 24; k++)
    pair[k] = random_between(random, -1, 1) + (k >= 12 ? apart * direction[k % 3] : 0);
}

START_TEST(face_to_vertex_is_the_distance) {
  double pair[24];
  place(pair, (double[]){0.2, 0.2, -0.25, 0.2, 0.2, -1, 0.3, 0.2, -1, 0.2, 0.3, -1});
  ck_assert_near(overlap_separation_pair(pair, INFINITY), 0.25, 1e-15);
  place(pair, (double[]){0.2, 0.2, 0.125, 0.2, 0.2, -1, 0.3, 0.2, -1, 0.2, 0.3, -1});
  ck_assert_near(overlap_separation_pair(pair, INFINITY), -0.125, 1e-15);
}
END_TEST

START_TEST(crossed_edges_are_their_distance) {
  // An edge along x below the edge along y.
  double pair[24] = {0,  -1, 1,   0, 1, 1,   0.5, 0,   2,  -0.5, 0,    2,
                     -1, 0,  0.5, 1, 0, 0.5, 0,   0.5, -1, 0,    -0.5, -1};
  ck_assert_near(overlap_separation_pair(pair, INFINITY), 0.5, 1e-15);
}
END_TEST

START_TEST(the_sign_says_whether_the_interiors_meet) {
  OverlapModel exact;
  ck_assert_ok(overlap_models_create(&exact, "exact"));
  Random random = random_seeded(11, 0);
  int apart = 0, certain = 0;
  for (int k = 0; k < 4000; k++) {
    double pair[24], volume;
    unsigned flags;
    random_pair(&random, random_between(&random, 0, 2), pair);
    ck_assert_ok(
        exact.ops->eval_pair(exact.self, pair, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
    double separation = overlap_separation_pair(pair, INFINITY);
    if (separation < -1e-12)
      ck_assert_msg(volume > 0, "pair %d: separation %g but no overlap", k, separation);
    if (separation > 1e-12)
      ck_assert_msg(volume == 0, "pair %d: separation %g but overlap %g", k, separation, volume);
    bool is_certain = overlap_separation_is_certain(pair);
    if (is_certain) ck_assert(separation > -1e-14);
    apart += separation > 0, certain += is_certain;
  }
  ck_assert_int_gt(apart, 1000);
  ck_assert_int_gt(4000 - apart, 1000);
  ck_assert_int_gt(certain, apart / 2);
  overlap_model_destroy(&exact);
}
END_TEST

START_TEST(nothing_is_certain_about_overlap) {
  OverlapModel exact;
  ck_assert_ok(overlap_models_create(&exact, "exact"));
  Random random = random_seeded(12, 0);
  for (int k = 0; k < 4000; k++) {
    // Touching to rounding: B's vertices are moved onto A's face plane z = 0, rotated and far from the
    // origin.
    double pair[24], R[9], volume;
    unsigned flags;
    random_pair(&random, 0, pair);
    memcpy(pair, CORNER, sizeof CORNER);
    double highest = -INFINITY;
    for (int v = 4; v < 8; v++) highest = fmax(highest, pair[3 * v + 2]);
    for (int v = 4; v < 8; v++) pair[3 * v + 2] -= highest;
    random_rotation(&random, R);
    for (int v = 0; v < 8; v++) {
      double x[3] = {pair[3 * v], pair[3 * v + 1], pair[3 * v + 2]};
      for (int c = 0; c < 3; c++)
        pair[3 * v + c] = R[3 * c] * x[0] + R[3 * c + 1] * x[1] + R[3 * c + 2] * x[2] + (k % 2 ? 1000 : 0);
    }
    ck_assert_ok(
        exact.ops->eval_pair(exact.self, pair, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
    if (volume > 0) ck_assert(!overlap_separation_is_certain(pair));
  }
  overlap_model_destroy(&exact);
}
END_TEST

// A small one just inside or outside of a corner of one that is up to 2^40 times larger, far from its first
// vertex: what is certain must be so although differences over the pair's extent lose the small one's digits.
START_TEST(certainty_holds_at_any_ratio_of_sizes) {
  OverlapModel exact;
  ck_assert_ok(overlap_models_create(&exact, "exact"));
  Random random = random_seeded(15, 0);
  int certain = 0, overlapping = 0;
  for (int k = 0; k < 4000; k++) {
    double pair[24], volume, size = ldexp(1, -k % 40), corner[3];
    unsigned flags;
    random_pair(&random, 0, pair);
    for (int c = 0; c < 3; c++) corner[c] = pair[9 + c] + size * random_between(&random, -1, 1);
    for (int v = 12; v < 24; v++) pair[v] = corner[v % 3] + size * random_between(&random, -1, 1);
    double shrunk[24]; // exact decides without a look at the faces
    memcpy(shrunk, pair, sizeof shrunk);
    for (int v = 0; v < 24; v++) shrunk[v] *= 0x1p-300;
    ck_assert_ok(
        exact.ops->eval_pair(exact.self, shrunk, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
    bool is_disjoint = flags == OVERLAP_DISJOINT;
    ck_assert(!overlap_separation_is_certain(shrunk));
    if (overlap_separation_is_certain(pair)) ck_assert(is_disjoint), certain++;
    overlapping += !is_disjoint;
  }
  ck_assert_int_gt(certain, 500);
  ck_assert_int_gt(overlapping, 500);
  overlap_model_destroy(&exact);
}
END_TEST

// Of any number of pairs, and never where one pair at a time would see an overlap or a flat one.
START_TEST(many_at_once_are_found_as_one_by_one) {
  enum { COUNT = 1000 };
  static double pairs[COUNT][24];
  static bool is_apart[COUNT + 1];
  Random random = random_seeded(16, 0);
  int found = 0, different = 0;
  for (int k = 0; k < COUNT; k++) {
    random_pair(&random, random_between(&random, 0, 3), pairs[k]);
    if (k % 7 == 0) memcpy(pairs[k] + 15, pairs[k] + 12, 3 * sizeof **pairs); // flat
  }
  for (int count = COUNT; count >= COUNT - 20; count--) {
    for (int k = 0; k <= COUNT; k++) is_apart[k] = false;
    overlap_separation_find(count, pairs[0], is_apart);
    found = different = 0;
    for (int k = 0; k < count; k++) {
      if (k % 7 == 0) ck_assert(!is_apart[k]);
      if (is_apart[k]) ck_assert(overlap_separation_pair(pairs[k], INFINITY) > 0);
      found += is_apart[k], different += is_apart[k] != overlap_separation_is_certain(pairs[k]);
    }
    ck_assert(!is_apart[count]);
  }
  ck_assert_int_gt(found, COUNT / 4);
  ck_assert_int_le(different, 5);
}
END_TEST

START_TEST(a_flat_one_is_never_certainly_apart) {
  double pair[24];
  place(pair, (double[]){5, 5, 5, 6, 5, 5, 5, 6, 5, 5, 5, 6});
  ck_assert(overlap_separation_is_certain(pair));
  for (int t = 0; t < 2; t++)
    for (int c = 0; c < 3; c++) {
      double flat[24];
      memcpy(flat, pair, sizeof flat);
      for (int v = 0; v < 4; v++) flat[12 * t + 3 * v + c] = 7;
      ck_assert(!overlap_separation_is_certain(flat));
    }
}
END_TEST

// No axis separates by more than the distance: of no two points.
START_TEST(never_more_than_the_distance_of_two_points) {
  Random random = random_seeded(13, 0);
  for (int k = 0; k < 500; k++) {
    double pair[24];
    random_pair(&random, 3, pair);
    double separation = overlap_separation_pair(pair, INFINITY);
    for (int s = 0; s < 50; s++) {
      Vec3 point[2];
      for (int t = 0; t < 2; t++) {
        double weight[4], sum = 0;
        for (int v = 0; v < 4; v++) sum += weight[v] = -log(1 - random_uniform(&random));
        point[t] = (Vec3){0, 0, 0};
        for (int v = 0; v < 4; v++)
          point[t] = vec3_add(point[t], vec3_scale(weight[v] / sum, vec3_at(pair + 12 * t + 3 * v)));
      }
      ck_assert(separation <= vec3_length(vec3_sub(point[0], point[1])));
    }
  }
}
END_TEST

START_TEST(swapping_and_moving_change_nothing) {
  Random random = random_seeded(14, 0);
  for (int k = 0; k < 500; k++) {
    double pair[24], swapped[24], moved[24], R[9];
    random_pair(&random, random_between(&random, 0, 3), pair);
    memcpy(swapped, pair + 12, sizeof swapped / 2), memcpy(swapped + 12, pair, sizeof swapped / 2);
    random_rotation(&random, R);
    for (int v = 0; v < 8; v++)
      for (int c = 0; c < 3; c++)
        moved[3 * v + c] =
            10 + R[3 * c] * pair[3 * v] + R[3 * c + 1] * pair[3 * v + 1] + R[3 * c + 2] * pair[3 * v + 2];
    double separation = overlap_separation_pair(pair, INFINITY);
    ck_assert_near(overlap_separation_pair(swapped, INFINITY), separation, 1e-13);
    ck_assert_near(overlap_separation_pair(moved, INFINITY), separation, 1e-12);
  }
}
END_TEST

START_TEST(an_early_end_is_a_lower_bound_above_what_was_enough) {
  Random random = random_seeded(15, 0);
  for (int k = 0; k < 1000; k++) {
    double pair[24];
    random_pair(&random, 2, pair);
    double whole = overlap_separation_pair(pair, INFINITY), enough = random_between(&random, -0.5, 1);
    double early = overlap_separation_pair(pair, enough);
    ck_assert(early <= whole);
    ck_assert(early == whole || early > enough);
  }
}
END_TEST

START_TEST(a_halfspace_is_met_by_the_lowest_vertex) {
  static const double POINT[3] = {5, 5, -0.5}, UP[3] = {0, 0, 1}, DOWN[3] = {0, 0, -1};
  ck_assert_near(overlap_separation_halfspace(CORNER, POINT, UP), 0.5, 0);
  ck_assert_near(overlap_separation_halfspace(CORNER, POINT, DOWN), -1.5, 0);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("separation");
  tcase_add_test(cases, face_to_vertex_is_the_distance);
  tcase_add_test(cases, crossed_edges_are_their_distance);
  tcase_add_test(cases, the_sign_says_whether_the_interiors_meet);
  tcase_add_test(cases, nothing_is_certain_about_overlap);
  tcase_add_test(cases, certainty_holds_at_any_ratio_of_sizes);
  tcase_add_test(cases, many_at_once_are_found_as_one_by_one);
  tcase_add_test(cases, a_flat_one_is_never_certainly_apart);
  tcase_add_test(cases, never_more_than_the_distance_of_two_points);
  tcase_add_test(cases, swapping_and_moving_change_nothing);
  tcase_add_test(cases, an_early_end_is_a_lower_bound_above_what_was_enough);
  tcase_add_test(cases, a_halfspace_is_met_by_the_lowest_vertex);
  return suite_run("separation", cases, 60);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include <string.h>

#include "base/random.h"
#include "base/vec3.h"
#include "overlap/clip/clip.h"
#include "overlap/tpn/normalise.h"
#include "suite.h"

// The two that are maps of space come first.
static const OverlapTpnNormalisation kinds[] = {OVERLAP_TPN_NORMALISE_UNIT, OVERLAP_TPN_NORMALISE_PCA,
                                                OVERLAP_TPN_NORMALISE_SORTED, OVERLAP_TPN_NORMALISE_UNSCALED,
                                                OVERLAP_TPN_NORMALISE_AXIS};
enum { KINDS = sizeof kinds / sizeof *kinds };

static void draw_pair(Random *random, double pair[24]) {
  for (int i = 0; i < 24; i++) pair[i] = random_uniform(random);
}

static double volume_of(const double pair[24]) {
  double volume;
  unsigned flags;
  ck_assert_ok(overlap_clip_ops.eval_pair(NULL, pair, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
  return volume;
}

START_TEST(first_tetrahedron_becomes_the_unit_simplex) {
  const double pair[24] = {1, 1, 1, 3, 1, 1, 1, 4, 1, 1, 1, 5, 1, 1, 1, 2, 1, 1, 1, 2.5, 1, 3, 4, 5};
  OverlapTpnNormalised normalised;
  ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_UNIT, pair, &normalised));
  ck_assert_near(normalised.factor, 24, 1e-14);
  const double expected[12] = {0, 0, 0, 0.5, 0, 0, 0, 0.5, 0, 1, 1, 1};
  for (int i = 0; i < 12; i++) ck_assert_near(normalised.pair[12 + i], expected[i], 1e-15);
}
END_TEST

START_TEST(principal_axes_of_a_long_tetrahedron_are_its_own) {
  // long along z, then y, then x; centroid (0, 0, 0) by construction
  const double pair[24] = {-1, 0, -3, 1, 0, -3, 0, -2, 3, 0, 2, 3, 0, 0, 1, 1, 0, 1, 0, 1, 1, 0, 0, 2};
  OverlapTpnNormalised normalised;
  ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_PCA, pair, &normalised));
  ck_assert_near(normalised.principal[0], 9, 1e-14);
  ck_assert_near(normalised.principal[1], 2, 1e-14);
  ck_assert_near(normalised.principal[2], 0.5, 1e-14);
  for (int v = 0; v < 8; v++) {
    ck_assert_near(fabs(normalised.pair[3 * v]), fabs(pair[3 * v + 2]), 1e-14);
    ck_assert_near(fabs(normalised.pair[3 * v + 1]), fabs(pair[3 * v + 1]), 1e-14);
  }
}
END_TEST

START_TEST(volume_is_the_factor_times_the_normalised_volume) {
  Random random = random_seeded(1, 0);
  double pair[24];
  int with_volume = 0;
  for (int n = 0; n < 400; n++)
    for (int k = 0; k < 2; k++) {
      OverlapTpnNormalised normalised;
      draw_pair(&random, pair);
      ck_assert(overlap_tpn_normalise(kinds[k], pair, &normalised));
      double volume = volume_of(pair);
      ck_assert_near(normalised.factor * volume_of(normalised.pair), volume, 1e-9 * volume + 1e-15);
      with_volume += volume > 0;
    }
  ck_assert_int_gt(with_volume, 200);
}
END_TEST

START_TEST(unscaled_is_unit_with_a_factor_of_one) {
  Random random = random_seeded(9, 0);
  double pair[24];
  for (int n = 0; n < 50; n++) {
    OverlapTpnNormalised unit, unscaled;
    draw_pair(&random, pair);
    ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_UNIT, pair, &unit));
    ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_UNSCALED, pair, &unscaled));
    ck_assert_double_eq(unscaled.factor, 1);
    ck_assert_mem_eq(unscaled.pair, unit.pair, sizeof unit.pair);
  }
}
END_TEST

START_TEST(rigid_motion_leaves_all_normalised_pairs_unchanged) {
  Random random = random_seeded(2, 0);
  double pair[24], moved[24], r[9];
  for (int n = 0; n < 200; n++)
    for (int k = 0; k < KINDS; k++) {
      OverlapTpnNormalised before, after;
      draw_pair(&random, pair);
      random_rotation(&random, r);
      for (int v = 0; v < 8; v++)
        for (int i = 0; i < 3; i++) {
          moved[3 * v + i] = 5;
          for (int j = 0; j < 3; j++) moved[3 * v + i] += r[3 * i + j] * pair[3 * v + j];
        }
      ck_assert(overlap_tpn_normalise(kinds[k], pair, &before));
      ck_assert(overlap_tpn_normalise(kinds[k], moved, &after));
      double size = 1;
      for (int i = 0; i < 24; i++) size = fmax(size, fabs(before.pair[i]));
      for (int i = 0; i < 24; i++) ck_assert_near(after.pair[i], before.pair[i], 1e-9 * size * size);
    }
}
END_TEST

START_TEST(sorted_pair_does_not_depend_on_the_order_of_vertices) {
  static const OverlapTpnNormalisation sorting[] = {OVERLAP_TPN_NORMALISE_SORTED, OVERLAP_TPN_NORMALISE_AXIS};
  static const int orders[4][4] = {{1, 2, 3, 0}, {2, 0, 3, 1}, {3, 2, 1, 0}, {0, 2, 1, 3}};
  Random random = random_seeded(6, 0);
  double pair[24], shuffled[24];
  for (int n = 0; n < 200; n++) {
    OverlapTpnNormalised before, after;
    draw_pair(&random, pair);
    const int *first = orders[random_below(&random, 4)], *second = orders[random_below(&random, 4)];
    for (int v = 0; v < 4; v++) {
      memcpy(shuffled + 3 * v, pair + 3 * first[v], 3 * sizeof(double));
      memcpy(shuffled + 12 + 3 * v, pair + 12 + 3 * second[v], 3 * sizeof(double));
    }
    for (int k = 0; k < 2; k++) {
      ck_assert(overlap_tpn_normalise(sorting[k], pair, &before));
      ck_assert(overlap_tpn_normalise(sorting[k], shuffled, &after));
      for (int i = 0; i < 24; i++) ck_assert_near(after.pair[i], before.pair[i], 1e-9);
    }
  }
}
END_TEST

START_TEST(sorted_pair_by_hand) {
  // the other's centroid, (0, 0, 1.25), is nearest to the fourth vertex, and equally far from the first
  // three; z is 10, 1, −3 and −3 in the frame's barycentric coordinate of that vertex
  const double pair[24] = {1, 0, 0, -1, 1, 0, -1, -1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 10, 1, 0, -3, -1, 0, -3};
  OverlapTpnNormalised normalised;
  ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_SORTED, pair, &normalised));
  ck_assert_int_eq(normalised.order[0], 3);
  ck_assert_int_eq(normalised.order[4], 5);
  ck_assert_int_eq(normalised.order[5], 4);
  for (int i = 0; i < 3; i++) ck_assert(normalised.pair[15 + i] == 0); // the first's first vertex is its own
  // (0, 0, 10) has the coordinates −9 · (1/2, 1/4, 1/4) in the other three
  double first = 0;
  for (int i = 12; i < 15; i++) first = fmin(first, normalised.pair[i]);
  ck_assert_near(first, -3 * (1 + log(1.5)), 1e-14);
}
END_TEST

static void exchange(const double pair[24], double exchanged[24]) {
  memcpy(exchanged, pair + 12, 12 * sizeof(double));
  memcpy(exchanged + 12, pair, 12 * sizeof(double));
}

// Equal to the bit; each place holds the same vertex.
static void check_exchange(const double pair[24]) {
  OverlapTpnNormalised before, after;
  double exchanged[24];
  exchange(pair, exchanged);
  ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_AXIS, pair, &before));
  ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_AXIS, exchanged, &after));
  ck_assert_mem_eq(after.pair, before.pair, sizeof before.pair);
  ck_assert_double_eq(after.factor, before.factor);
  for (int v = 0; v < 8; v++) ck_assert_int_eq(after.order[v], before.order[v] ^ 4);
}

START_TEST(pair_along_its_axis_does_not_depend_on_which_comes_first) {
  Random random = random_seeded(7, 0);
  double pair[24];
  int exchanged = 0;
  for (int n = 0; n < 200; n++) {
    OverlapTpnNormalised normalised;
    draw_pair(&random, pair);
    check_exchange(pair);
    ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_AXIS, pair, &normalised));
    exchanged += normalised.order[0] >= 4;
  }
  ck_assert(exchanged > 50 && exchanged < 150);
  // the second is a mirror image of the first: both reach equally far and are equally large; mirrors at x = ½
  // and z = ½
  for (int c = 0; c < 3; c += 2) {
    draw_pair(&random, pair);
    memcpy(pair + 12, pair, 12 * sizeof(double));
    for (int v = 4; v < 8; v++) pair[3 * v + c] = 1 - pair[3 * v + c];
    check_exchange(pair);
  }
  // the greatest vertices have the same x and y
  check_exchange((double[]){0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, -.5, 0, 1, 0, 0, 0, -1});
}
END_TEST

// Of two that touch in a face, the first has that face, and it is the plane of the third coordinate, on whose
// far side all of the second lies. With a gap another axis may separate them better.
START_TEST(separating_face_is_the_first_plane_of_the_third_coordinate) {
  Random random = random_seeded(8, 0);
  double pair[24], other[24];
  for (int n = 0; n < 100; n++) {
    OverlapTpnNormalised normalised;
    draw_pair(&random, pair);
    double gap = n % 2 ? random_uniform(&random) : 0;
    // the first's last three vertices are in the plane z = 0, the second touches or is beyond it with a
    // vertex
    pair[2] = 1, pair[5] = pair[8] = pair[11] = 0;
    for (int v = 4; v < 8; v++) pair[3 * v + 2] = -gap - random_uniform(&random);
    for (int i = 12; i < 15; i++)
      pair[i] = i == 14 ? -gap : (pair[3 + i - 12] + pair[6 + i - 12] + pair[9 + i - 12]) / 3;
    exchange(pair, other);
    ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_AXIS, n % 3 ? pair : other, &normalised));
    if (gap == 0) ck_assert_int_eq(normalised.order[0] / 4, n % 3 ? 0 : 1);
    ck_assert(gap == 0 ? fabs(normalised.pair[14]) < 1e-12 : normalised.pair[14] < 0);
    for (int v = 5; v < 8 && gap == 0; v++)
      ck_assert(normalised.pair[3 * v + 2] <= normalised.pair[3 * v - 1]);
  }
}
END_TEST

// Where no face's plane separates, that along two edges does: the height is 0 on the first's edge, 1 at its
// farther vertex, and the nearer one has the slope.
START_TEST(separating_edges_have_one_height) {
  const double pair[24] = {.5,  -.5, -2,  1,  0,   0,  .5,  .5, -1,  0,  0,    0,
                           .75, 0,   2.1, .5, .25, .1, .25, 0,  1.1, .5, -.25, .1};
  static const int first[4] = {1, 3, 2, 0};
  OverlapTpnNormalised normalised;
  ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_AXIS, pair, &normalised));
  ck_assert_int_eq(normalised.order[0] + normalised.order[1], first[0] + first[1]);
  for (int v = 2; v < 4; v++) ck_assert_int_eq(normalised.order[v], first[v]);
  ck_assert_int_eq(normalised.order[6], 6);
  ck_assert_int_eq(normalised.order[7], 4);
  const double height[4] = {-.05, -.05 + .5, -.55, -1.05};
  for (int v = 0; v < 4; v++) ck_assert_near(normalised.pair[14 + 3 * v], height[v], 1e-14);
}
END_TEST

// By the separating axis theorem, and only then.
START_TEST(pair_is_disjoint_where_the_fifth_height_is_not_positive) {
  Random random = random_seeded(10, 0);
  double pair[24];
  int disjoint[2] = {0}, overlapping[2] = {0};
  for (int n = 0; n < 2000; n++) {
    OverlapTpnNormalised normalised;
    draw_pair(&random, pair);
    ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_AXIS, pair, &normalised));
    bool is_edges = normalised.run > 0, is_disjoint = volume_of(pair) <= 0;
    ck_assert_int_eq(normalised.pair[14] <= 0, is_disjoint);
    ck_assert_int_eq(normalised.pair[17] > normalised.pair[14], is_edges);
    disjoint[is_edges] += is_disjoint, overlapping[is_edges] += !is_disjoint;
  }
  for (int k = 0; k < 2; k++) ck_assert(disjoint[k] > 100 && overlapping[k] > 100);
}
END_TEST

START_TEST(flat_tetrahedron_does_not_come_first_along_an_axis) {
  double pair[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, exchanged[24];
  OverlapTpnNormalised normalised;
  ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_AXIS, pair, &normalised));
  for (int v = 0; v < 4; v++) ck_assert_int_ge(normalised.order[v], 4);
  exchange(pair, exchanged);
  ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_AXIS, exchanged, &normalised));
  for (int v = 0; v < 4; v++) ck_assert_int_lt(normalised.order[v], 4);
  memcpy(exchanged, pair, 12 * sizeof(double));
  memcpy(exchanged + 12, pair, 12 * sizeof(double));
  ck_assert(!overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_AXIS, exchanged, &normalised));
}
END_TEST

// A smooth function of the normalised pair, in place of a network.
static double function_of(const double x[24], double gradient[24]) {
  double value = 1;
  for (int i = 0; i < 24; i++) {
    value += sin(x[i] + 0.3 * i) + 0.1 * x[i] * x[(i + 7) % 24];
    gradient[i] = cos(x[i] + 0.3 * i) + 0.1 * (x[(i + 7) % 24] + x[(i + 17) % 24]);
  }
  return value;
}

static double chain(OverlapTpnNormalisation kind, const double pair[24]) {
  OverlapTpnNormalised normalised;
  double unused[24];
  ck_assert(overlap_tpn_normalise(kind, pair, &normalised));
  return normalised.factor * function_of(normalised.pair, unused);
}

START_TEST(gradient_is_that_of_the_whole_chain) {
  Random random = random_seeded(3, 0);
  double pair[24], inner[24], gradient[24];
  for (int n = 0; n < 50; n++)
    for (int k = 0; k < KINDS; k++) {
      OverlapTpnNormalised normalised;
      do draw_pair(&random, pair);
      while (!overlap_tpn_normalise(kinds[k], pair, &normalised) || !(normalised.matrix[0] < 10) ||
             fabs(vec3_det4(vec3_at(pair), vec3_at(pair + 3), vec3_at(pair + 6), vec3_at(pair + 9))) < 0.1);
      double value = function_of(normalised.pair, inner), size = 0;
      overlap_tpn_normalise_pull(&normalised, value, inner, gradient);
      for (int i = 0; i < 24; i++) size = fmax(size, fabs(gradient[i]));
      for (int i = 0; i < 24; i++) {
        double step = 1e-6, kept = pair[i];
        pair[i] = kept + step;
        double above = chain(kinds[k], pair);
        pair[i] = kept - step;
        double below = chain(kinds[k], pair);
        pair[i] = kept;
        ck_assert_near(gradient[i], (above - below) / (2 * step), 1e-5 * size);
      }
    }
}
END_TEST

START_TEST(gradient_is_bounded_where_principal_values_are_equal) {
  // a regular tetrahedron: all three values are equal
  const double pair[24] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  OverlapTpnNormalised normalised;
  double inner[24], gradient[24], total[3] = {0};
  ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_PCA, pair, &normalised));
  ck_assert_near(normalised.principal[0], normalised.principal[2], 1e-15);
  double value = function_of(normalised.pair, inner);
  overlap_tpn_normalise_pull(&normalised, value, inner, gradient);
  for (int i = 0; i < 24; i++) {
    ck_assert(fabs(gradient[i]) < 10);
    total[i % 3] += gradient[i];
  }
  for (int c = 0; c < 3; c++) ck_assert_near(total[c], 0, 1e-13);
}
END_TEST

START_TEST(flat_first_tetrahedron_has_no_unit_frame) {
  double pair[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  OverlapTpnNormalised normalised;
  ck_assert(!overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_UNIT, pair, &normalised));
  ck_assert(overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_PCA, pair, &normalised));
  memset(pair, 0, 12 * sizeof(double));
  ck_assert(!overlap_tpn_normalise(OVERLAP_TPN_NORMALISE_PCA, pair, &normalised));
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("normalise");
  tcase_add_test(test_case, first_tetrahedron_becomes_the_unit_simplex);
  tcase_add_test(test_case, principal_axes_of_a_long_tetrahedron_are_its_own);
  tcase_add_test(test_case, volume_is_the_factor_times_the_normalised_volume);
  tcase_add_test(test_case, unscaled_is_unit_with_a_factor_of_one);
  tcase_add_test(test_case, sorted_pair_does_not_depend_on_the_order_of_vertices);
  tcase_add_test(test_case, sorted_pair_by_hand);
  tcase_add_test(test_case, pair_along_its_axis_does_not_depend_on_which_comes_first);
  tcase_add_test(test_case, separating_face_is_the_first_plane_of_the_third_coordinate);
  tcase_add_test(test_case, separating_edges_have_one_height);
  tcase_add_test(test_case, pair_is_disjoint_where_the_fifth_height_is_not_positive);
  tcase_add_test(test_case, flat_tetrahedron_does_not_come_first_along_an_axis);
  tcase_add_test(test_case, rigid_motion_leaves_all_normalised_pairs_unchanged);
  tcase_add_test(test_case, gradient_is_that_of_the_whole_chain);
  tcase_add_test(test_case, gradient_is_bounded_where_principal_values_are_equal);
  tcase_add_test(test_case, flat_first_tetrahedron_has_no_unit_frame);
  return suite_run("normalise", test_case, 20);
}

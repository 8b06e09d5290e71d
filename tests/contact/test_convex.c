// SPDX-License-Identifier: GPL-3.0-or-later
// contact/convex: a tetrahedron against a box and against the prism that stands for a cylinder.
#include <string.h>

#include "suite.h"

#include "base/random.h"
#include "base/vec3.h"
#include "contact/shape/convex.h"
#include "contact/shape/halfspace.h"
#include "overlap/models.h"

static const double HALF[3] = {0.5, 0.4, 0.3};

static double whole_volume(const double tet[12]) {
  return fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6;
}

static void random_tet(Random *random, double spread, double size, double tet[12]) {
  double middle[3];
  for (int c = 0; c < 3; c++) middle[c] = spread * random_between(random, -1, 1);
  for (int k = 0; k < 12; k++) tet[k] = middle[k % 3] + size * random_between(random, -1, 1);
}

static double volume_in(const ContactConvex *convex, const double tet[12]) {
  double volume;
  contact_convex_overlap(convex, tet, &volume, NULL);
  return volume;
}

// 0: the box; 1: a prism of 48 faces; 2: one of 8.
static ContactConvex solid(int i) {
  ContactConvex convex;
  if (i == 0)
    contact_convex_make_box(&convex, HALF);
  else
    contact_convex_make_prism(&convex, 0.5, 0.4, i == 1 ? 48 : 8);
  return convex;
}

START_TEST(a_tetrahedron_inside_counts_whole_and_one_around_holds_the_solid) {
  ContactConvex convex = solid(_i);
  double whole = _i == 0 ? 8 * HALF[0] * HALF[1] * HALF[2] : M_PI * 0.25 * 0.8;
  const double around[12] = {-9, -9, -9, 40, -9, -9, -9, 40, -9, -9, -9, 40};
  double volume, gradient[12];
  contact_convex_overlap(&convex, around, &volume, gradient);
  ck_assert_near(volume, whole, 1e-13);
  for (int k = 0; k < 12; k++) ck_assert_near(gradient[k], 0, 1e-13);
  Random random = random_seeded(1, 0);
  for (int trial = 0; trial < 100; trial++) {
    double tet[12];
    random_tet(&random, 0.1, 0.1, tet);
    ck_assert_near(volume_in(&convex, tet), whole_volume(tet), 1e-16);
  }
}
END_TEST

// Cut by one plane only, it is a half-space, whose closed form is another.
START_TEST(one_face_is_a_halfspace) {
  const double huge[3] = {50, 50, 0.3}, point[3] = {0, 0, 0.3}, normal[3] = {0, 0, 1};
  ContactConvex convex;
  contact_convex_make_box(&convex, huge);
  Random random = random_seeded(2, 0);
  int cut = 0;
  for (int trial = 0; trial < 500; trial++) {
    double tet[12], volume[2], gradient[2][12];
    random_tet(&random, 0.1, 0.3, tet);
    for (int v = 0; v < 4; v++) tet[3 * v + 2] += 0.3;
    contact_convex_overlap(&convex, tet, &volume[0], gradient[0]);
    contact_halfspace_overlap(tet, point, normal, &volume[1], gradient[1]);
    cut += volume[1] > 0 && volume[1] < whole_volume(tet);
    ck_assert_near(volume[0], volume[1], 1e-15);
    for (int k = 0; k < 12; k++) ck_assert_near(gradient[0][k], gradient[1][k], 1e-13);
  }
  ck_assert_int_gt(cut, 300);
}
END_TEST

// A box is six tetrahedra: what the exact model gives for each adds up to V, but for its own rounding.
START_TEST(a_box_is_the_sum_of_its_tetrahedra_as_the_exact_model_sees_them) {
  static const int paths[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  ContactConvex convex = solid(0);
  OverlapModel exact;
  ck_assert_ok(overlap_models_create(&exact, "exact"));
  Random random = random_seeded(3, 0);
  int overlapping = 0;
  for (int trial = 0; trial < 300; trial++) {
    double pairs[6][24], volumes[6], gradients[6][24], sum = 0, slope[12] = {0};
    random_tet(&random, 0.6, trial % 2 ? 0.2 : 0.6, pairs[0]);
    for (int p = 0; p < 6; p++) {
      double corner[3] = {-HALF[0], -HALF[1], -HALF[2]};
      memmove(pairs[p], pairs[0], 12 * sizeof(double));
      for (int v = 0; v < 4; v++) {
        memcpy(pairs[p] + 12 + 3 * v, corner, sizeof corner);
        if (v < 3) corner[paths[p][v]] = HALF[paths[p][v]];
      }
    }
    OverlapBatch batch = {.pair_count = 6, .pairs = pairs[0], .volume = volumes, .gradient = gradients[0]};
    ck_assert_ok(overlap_model_eval(&exact, &batch));
    for (int p = 0; p < 6; p++) {
      sum += volumes[p];
      for (int k = 0; k < 12; k++) slope[k] += gradients[p][k];
    }
    double volume, gradient[12];
    contact_convex_overlap(&convex, pairs[0], &volume, gradient);
    overlapping += volume > 0;
    ck_assert_near(volume, sum, 1e-14);
    for (int k = 0; k < 12; k++) ck_assert_near(gradient[k], slope[k], 1e-12);
  }
  ck_assert_int_gt(overlapping, 100);
  overlap_model_destroy(&exact);
}
END_TEST

// Against random points: a standard deviation of √(p(1 − p)/N) of the tetrahedron, four of them allowed; and
// the prism's own error.
START_TEST(a_cylinder_is_met_as_random_points_meet_it) {
  enum { POINTS = 40000 };
  ContactConvex convex = solid(1);
  Random random = random_seeded(4, 0);
  int overlapping = 0;
  for (int trial = 0; trial < 40; trial++) {
    double tet[12];
    random_tet(&random, 0.5, 0.5, tet);
    int inside = 0;
    for (int i = 0; i < POINTS; i++) {
      double weights[4], sum = 0, x[3] = {0};
      for (int v = 0; v < 4; v++) sum += weights[v] = -log(1 - random_between(&random, 0, 1));
      for (int k = 0; k < 12; k++) x[k % 3] += weights[k / 3] / sum * tet[k];
      inside += x[0] * x[0] + x[1] * x[1] <= 0.25 && fabs(x[2]) <= 0.4;
    }
    double share = (double)inside / POINTS, whole = whole_volume(tet);
    double deviation = sqrt(fmax(share * (1 - share), 1.0 / POINTS) / POINTS);
    overlapping += inside > 0;
    // the surface in the tetrahedron is less than that of the cylinder
    double surface = 2 * M_PI * 0.5 * 0.8 * 0.5 * 0.00144;
    ck_assert_near(volume_in(&convex, tet), share * whole,
                   4 * deviation * whole + fmin(surface, 0.02 * whole));
  }
  ck_assert_int_gt(overlapping, 15);
}
END_TEST

START_TEST(the_gradient_is_the_derivative_of_the_volume) {
  ContactConvex convex = solid(_i);
  Random random = random_seeded(5, (uint64_t)_i);
  int overlapping = 0;
  for (int trial = 0; trial < 300; trial++) {
    double tet[12], volume, gradient[12], h = 1e-6;
    random_tet(&random, 0.6, trial % 2 ? 0.2 : 0.6, tet);
    if (trial % 3 == 0) // a mirror image
      for (int v = 0; v < 4; v++) tet[3 * v] = -tet[3 * v];
    contact_convex_overlap(&convex, tet, &volume, gradient);
    overlapping += volume > 0;
    for (int k = 0; k < 12; k++) {
      double kept = tet[k], high, low;
      tet[k] = kept + h;
      contact_convex_overlap(&convex, tet, &high, NULL);
      tet[k] = kept - h;
      contact_convex_overlap(&convex, tet, &low, NULL);
      tet[k] = kept;
      ck_assert_near(gradient[k], (high - low) / (2 * h), 1e-8);
    }
  }
  ck_assert_int_gt(overlapping, 100);
}
END_TEST

START_TEST(they_overlap_where_no_axis_separates_them) {
  ContactConvex convex = solid(_i);
  Random random = random_seeded(6, (uint64_t)_i);
  int apart = 0, touching = 0;
  for (int trial = 0; trial < 4000; trial++) {
    double tet[12];
    random_tet(&random, 0.8, 0.25, tet);
    double volume = volume_in(&convex, tet), gap = contact_convex_separation(&convex, tet, INFINITY);
    apart += gap > 0, touching += volume > 0;
    if (fabs(gap) < 1e-7) continue;
    ck_assert(volume > 0 ? gap < 0 : gap > 0);
    ck_assert(contact_convex_separation(&convex, tet, 0.01) <= gap + 1e-15);
  }
  ck_assert_int_gt(apart, 500);
  ck_assert_int_gt(touching, 500);
}
END_TEST

// A face flush with the solid's: V is that of the rest, and nothing is torn.
START_TEST(faces_that_coincide_are_no_trouble) {
  ContactConvex convex = solid(0);
  const double inside[12] = {-0.1, -0.1, 0.3, 0.2, -0.1, 0.3, -0.1, 0.2, 0.3, 0, 0, 0};
  const double outside[12] = {-0.1, -0.1, 0.3, 0.2, -0.1, 0.3, -0.1, 0.2, 0.3, 0, 0, 0.6};
  double volume, gradient[12];
  contact_convex_overlap(&convex, inside, &volume, gradient);
  ck_assert_near(volume, whole_volume(inside), 1e-16);
  for (int k = 0; k < 12; k++) ck_assert(isfinite(gradient[k]));
  contact_convex_overlap(&convex, outside, &volume, gradient);
  ck_assert_double_eq(volume, 0);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("convex");
  tcase_add_loop_test(test_case, a_tetrahedron_inside_counts_whole_and_one_around_holds_the_solid, 0, 3);
  tcase_add_test(test_case, one_face_is_a_halfspace);
  tcase_add_test(test_case, a_box_is_the_sum_of_its_tetrahedra_as_the_exact_model_sees_them);
  tcase_add_test(test_case, a_cylinder_is_met_as_random_points_meet_it);
  tcase_add_loop_test(test_case, the_gradient_is_the_derivative_of_the_volume, 0, 3);
  tcase_add_loop_test(test_case, they_overlap_where_no_axis_separates_them, 0, 3);
  tcase_add_test(test_case, faces_that_coincide_are_no_trouble);
  return suite_run("convex", test_case, 60);
}

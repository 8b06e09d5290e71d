// SPDX-License-Identifier: GPL-3.0-or-later
// contact/halfspace: the part of a tetrahedron below a plane. The oracle is an overlap model of a different
// kind, given a tetrahedron so large that near the plane it is the half-space.
#include "suite.h"

#include <string.h>

#include "base/random.h"
#include "base/vec3.h"
#include "contact/shape/halfspace.h"
#include "overlap/exact/exact.h"

static const double corner[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

typedef struct Case {
  double tet[12], point[3], normal[3];
} Case;

// A tetrahedron of about unit size and a plane through its middle.
static Case random_case(uint64_t stream) {
  Random random = random_seeded(11, stream);
  Case it;
  Vec3 middle = {0, 0, 0};
  do {
    for (int i = 0; i < 12; i++) it.tet[i] = random_uniform(&random);
  } while (!(fabs(vec3_det4(vec3_at(it.tet), vec3_at(it.tet + 3), vec3_at(it.tet + 6), vec3_at(it.tet + 9))) >
             0.05));
  for (int i = 0; i < 4; i++)
    middle = vec3_add(middle, vec3_scale(random_between(&random, 0.1, 0.4), vec3_at(it.tet + 3 * i)));
  vec3_store(it.point, middle);
  random_direction(&random, it.normal);
  return it;
}

static double size_of(const double tet[12]) {
  return fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6;
}

static int below_count(const Case *it) {
  int below = 0;
  for (int i = 0; i < 4; i++)
    below += vec3_dot(vec3_at(it->normal), vec3_sub(vec3_at(it->tet + 3 * i), vec3_at(it->point))) < 0;
  return below;
}

static double volume_of(const Case *it) {
  double volume;
  contact_halfspace_overlap(it->tet, it->point, it->normal, &volume, NULL);
  return volume;
}

START_TEST(a_corner_below_a_level_has_the_volume_a_hand_computes) {
  const double up[3] = {0, 0, 1};
  double volume, gradient[12];
  for (int k = 1; k < 8; k++) {
    double level[3] = {0, 0, k / 8.0}, above = 1 - k / 8.0;
    contact_halfspace_overlap(corner, level, up, &volume, gradient);
    ck_assert_near(volume, (1 - above * above * above) / 6, 1e-16);
    const double down[3] = {0, 0, -1};
    contact_halfspace_overlap(corner, level, down, &volume, gradient);
    ck_assert_near(volume, above * above * above / 6, 1e-16);
    double lift = 0; // raising the tetrahedron adds the section to the part above
    for (int i = 0; i < 4; i++) lift += gradient[3 * i + 2];
    ck_assert_near(lift, above * above / 2, 1e-15);
  }
}
END_TEST

START_TEST(a_wedge_has_the_volume_a_hand_computes) {
  // x + y ≤ 1/2 in the corner: vertices 0 and 3 below, 1 and 2 above
  const double root = 0.70710678118654752, normal[3] = {root, root, 0}, point[3] = {0.5, 0, 0};
  double volume;
  contact_halfspace_overlap(corner, point, normal, &volume, NULL);
  ck_assert_near(volume, 1.0 / 12, 1e-16); // ∫₀^½ t (1 − t) dt
}
END_TEST

START_TEST(all_below_is_the_whole_and_none_below_is_nothing) {
  const double up[3] = {0, 0, 1}, low[3] = {0, 0, -1}, high[3] = {0, 0, 2}, touching[3] = {0, 0, 0};
  double volume, gradient[12];
  contact_halfspace_overlap(corner, high, up, &volume, gradient);
  ck_assert_double_eq(volume, 1.0 / 6);
  ck_assert_near(gradient[11], 1.0 / 6, 1e-16);
  contact_halfspace_overlap(corner, low, up, &volume, gradient);
  ck_assert_double_eq(volume, 0);
  contact_halfspace_overlap(corner, touching, up, &volume, gradient);
  ck_assert_double_eq(volume, 0);
  for (int i = 0; i < 12; i++) ck_assert_double_eq(gradient[i], 0);
}
END_TEST

START_TEST(the_two_sides_of_a_plane_make_the_whole) {
  int seen[5] = {0};
  for (uint64_t k = 0; k < 500; k++) {
    Case it = random_case(k), other = it;
    vec3_store(other.normal, vec3_scale(-1, vec3_at(it.normal)));
    ck_assert_near(volume_of(&it) + volume_of(&other), size_of(it.tet), 1e-15);
    seen[below_count(&it)]++;
  }
  for (int below = 1; below < 4; below++) ck_assert_int_gt(seen[below], 50);
}
END_TEST

START_TEST(it_agrees_with_the_exact_overlap_with_a_huge_tetrahedron) {
  for (uint64_t k = 0; k < 200; k++) {
    Case it = random_case(k);
    Vec3 n = vec3_at(it.normal), point = vec3_at(it.point);
    Vec3 a = vec3_cross(n, fabs(n.x) < 0.6 ? (Vec3){1, 0, 0} : (Vec3){0, 1, 0});
    a = vec3_scale(1 / vec3_length(a), a);
    Vec3 b = vec3_cross(n, a);
    double pair[24], volume, gradient[12], expected, expected_gradient[24];
    memcpy(pair, it.tet, sizeof it.tet);
    vec3_store(pair + 12, vec3_add(point, vec3_scale(32, a)));
    vec3_store(pair + 15, vec3_add(point, vec3_add(vec3_scale(-16, a), vec3_scale(32, b))));
    vec3_store(pair + 18, vec3_add(point, vec3_add(vec3_scale(-16, a), vec3_scale(-32, b))));
    vec3_store(pair + 21, vec3_sub(point, vec3_scale(64, n)));
    unsigned flags;
    ck_assert_ok(overlap_exact_ops.eval_pair(
        NULL, pair, &(OverlapAnswer){.volume = &expected, .gradient = expected_gradient, .flags = &flags}));
    contact_halfspace_overlap(it.tet, it.point, it.normal, &volume, gradient);
    ck_assert_near(volume, expected, 1e-14);
    for (int i = 0; i < 12; i++) ck_assert_near(gradient[i], expected_gradient[i], 1e-12);
  }
}
END_TEST

START_TEST(the_gradient_is_the_derivative_of_the_volume) {
  const double h = 1e-6;
  for (uint64_t k = 0; k < 300; k++) {
    Case it = random_case(k);
    double volume, gradient[12];
    contact_halfspace_overlap(it.tet, it.point, it.normal, &volume, gradient);
    for (int i = 0; i < 12; i++) {
      Case up = it, down = it;
      up.tet[i] += h, down.tet[i] -= h;
      ck_assert_near(gradient[i], (volume_of(&up) - volume_of(&down)) / (2 * h), 2e-8);
    }
  }
}
END_TEST

START_TEST(the_parts_of_a_subdivision_sum_to_the_whole) {
  for (uint64_t k = 0; k < 200; k++) {
    Case it = random_case(k);
    Vec3 inner = {0, 0, 0};
    for (int i = 0; i < 4; i++) inner = vec3_add(inner, vec3_scale(0.25, vec3_at(it.tet + 3 * i)));
    double sum = 0;
    for (int i = 0; i < 4; i++) {
      Case part = it;
      vec3_store(part.tet + 3 * i, inner);
      sum += volume_of(&part);
    }
    ck_assert_near(sum, volume_of(&it), 1e-15);
  }
}
END_TEST

// Heights of 1e-3, 1e-6, … 1e-15 of one, two and three vertices, on either side and on both: against the
// rational model, relative to V. The plane z = 0 and its heights are exact.
START_TEST(vertices_near_the_plane_cost_no_digits) {
  const double point[3] = {0, 0, 0}, up[3] = {0, 0, 1};
  for (int decade = 3; decade <= 15; decade += 3)
    for (int signs = 0; signs < 27; signs++) {
      double tet[12] = {0.1, 0.2, 0, 0.9, 0.1, 0, 0.3, 0.8, 0, 0.4, 0.3, -0.5}, tiny = pow(10, -decade);
      for (int i = 0, rest = signs; i < 3; i++, rest /= 3) tet[3 * i + 2] = tiny * (1 + i) * (rest % 3 - 1);
      if (decade % 2) tet[11] = 0.5; // the rest above the plane, or below it
      double pair[24] = {0}, volume, gradient[12], expected, expected_gradient[24];
      const double ground[12] = {-8, -8, 0, 16, -8, 0, -8, 16, 0, 0, 0, -16};
      memcpy(pair, tet, sizeof tet);
      memcpy(pair + 12, ground, sizeof ground);
      unsigned flags;
      ck_assert_ok(overlap_exact_ops.eval_pair(
          NULL, pair, &(OverlapAnswer){.volume = &expected, .gradient = expected_gradient, .flags = &flags}));
      contact_halfspace_overlap(tet, point, up, &volume, gradient);
      ck_assert_near(volume, expected, 1e-14 * expected);
      if (signs == 13) continue; // the face lies in the plane: one-sided
      for (int i = 0; i < 12; i++) ck_assert_near(gradient[i], expected_gradient[i], 1e-14);
    }
}
END_TEST

START_TEST(volume_scales_with_the_cube_and_needs_no_orientation) {
  for (uint64_t k = 0; k < 100; k++) {
    Case it = random_case(k), turned = it;
    double volume = volume_of(&it);
    memcpy(turned.tet, it.tet + 3, 3 * sizeof *it.tet), memcpy(turned.tet + 3, it.tet, 3 * sizeof *it.tet);
    ck_assert_near(volume_of(&turned), volume, 1e-16);
    for (int power = -30; power <= 30; power += 60) {
      Case scaled = it;
      for (int i = 0; i < 12; i++) scaled.tet[i] = ldexp(it.tet[i], power);
      for (int i = 0; i < 3; i++) scaled.point[i] = ldexp(it.point[i], power);
      ck_assert_double_eq(volume_of(&scaled), ldexp(volume, 3 * power));
    }
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("halfspace");
  tcase_add_test(cases, a_corner_below_a_level_has_the_volume_a_hand_computes);
  tcase_add_test(cases, a_wedge_has_the_volume_a_hand_computes);
  tcase_add_test(cases, all_below_is_the_whole_and_none_below_is_nothing);
  tcase_add_test(cases, the_two_sides_of_a_plane_make_the_whole);
  tcase_add_test(cases, it_agrees_with_the_exact_overlap_with_a_huge_tetrahedron);
  tcase_add_test(cases, the_gradient_is_the_derivative_of_the_volume);
  tcase_add_test(cases, the_parts_of_a_subdivision_sum_to_the_whole);
  tcase_add_test(cases, vertices_near_the_plane_cost_no_digits);
  tcase_add_test(cases, volume_scales_with_the_cube_and_needs_no_orientation);
  return suite_run("halfspace", cases, 20);
}

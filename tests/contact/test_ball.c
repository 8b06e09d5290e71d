// SPDX-License-Identifier: GPL-3.0-or-later
// contact/ball: a tetrahedron inside a ball, in closed form.
#include <string.h>

#include "suite.h"

#include "base/random.h"
#include "base/vec3.h"
#include "contact/shape/ball.h"

static const double CENTRE[3] = {0.3, -0.2, 0.1};

static double whole_volume(const double tet[12]) {
  return fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6;
}

static void random_tet(Random *random, double size, double tet[12]) {
  double middle[3];
  for (int c = 0; c < 3; c++) middle[c] = random_between(random, -1, 1);
  for (int k = 0; k < 12; k++) tet[k] = middle[k % 3] + size * random_between(random, -1, 1);
}

static double volume_of(const double tet[12], double radius) {
  double volume;
  contact_ball_overlap(tet, CENTRE, radius, &volume, NULL);
  return volume;
}

START_TEST(a_tetrahedron_inside_counts_whole) {
  Random random = random_seeded(1, 0);
  for (int trial = 0; trial < 100; trial++) {
    double tet[12];
    random_tet(&random, 0.5, tet);
    ck_assert_near(volume_of(tet, 10), whole_volume(tet), 1e-13);
  }
}
END_TEST

START_TEST(a_tetrahedron_around_holds_the_ball) {
  const double tet[12] = {-9, -9, -9, 40, -9, -9, -9, 40, -9, -9, -9, 40};
  double volume, gradient[12];
  contact_ball_overlap(tet, CENTRE, 1.5, &volume, gradient);
  ck_assert_near(volume, 4.0 / 3 * M_PI * 1.5 * 1.5 * 1.5, 1e-12);
  for (int k = 0; k < 12; k++) ck_assert_near(gradient[k], 0, 1e-12);
}
END_TEST

// An eighth, and caps cut off by one face: of height h, π h² (3R − h)/3.
START_TEST(corners_at_the_centre_and_caps_are_as_in_the_book) {
  double tet[12] = {0, 0, 0, 9, 0, 0, 0, 9, 0, 0, 0, 9};
  for (int k = 0; k < 12; k++) tet[k] += CENTRE[k % 3];
  ck_assert_near(volume_of(tet, 1.2), M_PI / 6 * 1.2 * 1.2 * 1.2, 1e-13);
  for (int k = 1; k < 20; k++) {
    double height = 0.1 * k;
    double below[12] = {-40, -40, height - 1, 90, -40, height - 1, -40, 90, height - 1, 0, 0, -60};
    for (int c = 0; c < 12; c++) below[c] += CENTRE[c % 3];
    double cap = M_PI * height * height * (3 - height) / 3;
    ck_assert_near(volume_of(below, 1), cap, 1e-11);
  }
}
END_TEST

START_TEST(volumes_agree_with_counting_points) {
  Random random = random_seeded(2, 0);
  for (int trial = 0; trial < 20; trial++) {
    double tet[12];
    int inside = 0, count = 200000;
    random_tet(&random, 1, tet);
    for (int n = 0; n < count; n++) {
      double s[3] = {random_uniform(&random), random_uniform(&random), random_uniform(&random)};
      for (int a = 0; a < 2; a++) // ascending: the spacings of three uniform numbers are uniform in a simplex
        for (int b = 0; b < 2 - a; b++)
          if (s[b] > s[b + 1]) {
            double kept = s[b];
            s[b] = s[b + 1], s[b + 1] = kept;
          }
      const double weights[4] = {s[0], s[1] - s[0], s[2] - s[1], 1 - s[2]};
      double square = 0;
      for (int c = 0; c < 3; c++) {
        double x = -CENTRE[c];
        for (int v = 0; v < 4; v++) x += weights[v] * tet[3 * v + c];
        square += x * x;
      }
      inside += square < 0.8 * 0.8;
    }
    double share = (double)inside / count, spread = sqrt(share * (1 - share) / count) + 1.0 / count;
    ck_assert_near(volume_of(tet, 0.8) / whole_volume(tet), share, 5 * spread);
  }
}
END_TEST

START_TEST(the_gradient_is_the_derivative_of_the_volume) {
  Random random = random_seeded(3, 0);
  int cut = 0;
  for (int trial = 0; trial < 300; trial++) {
    double tet[12], gradient[12], volume, h = 1e-6;
    random_tet(&random, 0.7, tet);
    contact_ball_overlap(tet, CENTRE, 0.8, &volume, gradient);
    cut += volume > 0 && volume < whole_volume(tet) * (1 - 1e-9);
    for (int k = 0; k < 12; k++) {
      double moved[12];
      memcpy(moved, tet, sizeof moved);
      moved[k] += h;
      double high = volume_of(moved, 0.8);
      moved[k] -= 2 * h;
      ck_assert_near(gradient[k], (high - volume_of(moved, 0.8)) / (2 * h), 1e-7);
    }
  }
  ck_assert_int_gt(cut, 100);
}
END_TEST

// Turning the pair changes nothing, so the moment about the centre vanishes; and either orientation counts.
START_TEST(the_gradient_has_no_moment_about_the_centre) {
  Random random = random_seeded(4, 0);
  for (int trial = 0; trial < 200; trial++) {
    double tet[12], gradient[12], volume;
    random_tet(&random, 0.7, tet);
    contact_ball_overlap(tet, CENTRE, 0.8, &volume, gradient);
    Vec3 moment = {0, 0, 0};
    for (int v = 0; v < 4; v++) {
      Vec3 arm = vec3_sub(vec3_at(tet + 3 * v), vec3_at(CENTRE));
      moment = vec3_add(moment, vec3_cross(arm, vec3_at(gradient + 3 * v)));
    }
    ck_assert_near(vec3_length(moment), 0, 1e-13);
    double swapped[12];
    memcpy(swapped, tet, sizeof swapped);
    memcpy(swapped, tet + 3, 3 * sizeof(double));
    memcpy(swapped + 3, tet, 3 * sizeof(double));
    ck_assert_near(volume_of(swapped, 0.8), volume, 1e-14);
  }
}
END_TEST

START_TEST(a_subdivision_adds_up) {
  Random random = random_seeded(5, 0);
  for (int trial = 0; trial < 200; trial++) {
    double tet[12], sum = 0, inner[3] = {0, 0, 0};
    random_tet(&random, 0.9, tet);
    for (int k = 0; k < 12; k++) inner[k % 3] += tet[k] / 4;
    for (int v = 0; v < 4; v++) {
      double part[12];
      memcpy(part, tet, sizeof part);
      memcpy(part + 3 * v, inner, sizeof inner);
      sum += volume_of(part, 0.8);
    }
    ck_assert_near(sum, volume_of(tet, 0.8), 1e-13);
  }
}
END_TEST

START_TEST(planes_and_edges_through_the_centre_are_no_special_case) {
  // The centre on a face, on an edge, at a vertex; planes that touch the sphere above an edge or a vertex.
  const double shifts[][3] = {{0.25, 0.25, 0}, {0.5, 0, 0},   {0, 0, 0},   {0.5, 0, -0.1},
                              {0.25, 0.25, 1}, {0.5, 0, 0.2}, {0, 0, 0.2}, {1, 0, 0.1}};
  for (int s = 0; s < 8; s++) {
    double tet[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, near[12], gradient[12], volume;
    for (int k = 0; k < 12; k++) tet[k] += CENTRE[k % 3] - shifts[s][k % 3];
    contact_ball_overlap(tet, CENTRE, 0.2, &volume, gradient);
    ck_assert(isfinite(volume) && volume >= 0 && volume <= 4.0 / 3 * M_PI * 0.008);
    Random random = random_seeded(6, (uint64_t)s);
    for (int k = 0; k < 12; k++) {
      ck_assert(isfinite(gradient[k]));
      near[k] = tet[k] + 1e-9 * random_between(&random, -1, 1);
    }
    ck_assert_near(volume_of(near, 0.2), volume, 1e-9);
  }
}
END_TEST

// Whether matrix + shift has a Cholesky factor.
static bool is_definite(const double matrix[144], double shift) {
  double factor[144];
  for (int i = 0; i < 12; i++)
    for (int j = 0; j <= i; j++) {
      double sum = matrix[12 * i + j] + (i == j ? shift : 0);
      for (int k = 0; k < j; k++) sum -= factor[12 * i + k] * factor[12 * j + k];
      if (i == j && !(sum > 0)) return false;
      factor[12 * i + j] = i == j ? sqrt(sum) : sum / factor[12 * j + j];
    }
  return true;
}

// Beside a ball a hundred times as large, cells squashed to a tenth and a hundredth: by differences alone
// their eigenvalues went down to minus the largest entry.
START_TEST(flat_tetrahedra_press_along_no_direction_that_pulls) {
  Random random = random_seeded(11, 0);
  int met = 0;
  for (int trial = 0; trial < 1000; trial++) {
    double tet[12], volume, energy, gradient[12], hessian[144], largest = 0, size = 0.01, rest = 1e-6 / 12;
    double centre[3] = {random_between(&random, -0.015, 0.015), random_between(&random, -0.015, 0.015),
                        1 - random_between(&random, 0, 0.0025)};
    for (int k = 0; k < 12; k++) tet[k] = size * random_between(&random, -0.5, 0.5);
    for (int c = 0; c < 3; c++) {
      double mean = 0.3 * tet[c] + 0.3 * tet[3 + c] + 0.4 * tet[6 + c];
      tet[9 + c] = mean + (trial % 2 ? 0.1 : 0.01) * (tet[9 + c] - mean);
    }
    contact_ball_press(tet, centre, 1, rest, &volume, &energy, gradient, hessian);
    if (!(volume > 0)) continue;
    met++;
    for (int k = 0; k < 144; k++) largest = fmax(largest, fabs(hessian[k]));
    double bound = rest / whole_volume(tet) * volume;
    ck_assert(is_definite(hessian, bound + 2e-5 * largest));
  }
  ck_assert_int_gt(met, 300);
}
END_TEST

START_TEST(separation_is_the_distance_less_the_radius) {
  double tet[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double centres[][4] = {// centre, distance from the tetrahedron
                               {0.2, 0.3, -2, 2},
                               {-3, -4, 0.5, 5},
                               {-1, -2, -2, 3},
                               {2, 2, 2, 5 / sqrt(3)}};
  for (int k = 0; k < 4; k++)
    ck_assert_near(contact_ball_separation(tet, centres[k], 0.5), centres[k][3] - 0.5, 1e-14);
  ck_assert_near(contact_ball_separation(tet, (double[]){0.1, 0.1, 0.1}, 0.5), -0.5, 0);
  // No overlap without negative separation, and the other way round.
  Random random = random_seeded(8, 0);
  for (int trial = 0; trial < 1000; trial++) {
    double small[12];
    random_tet(&random, 0.4, small);
    double separation = contact_ball_separation(small, CENTRE, 0.8), volume = volume_of(small, 0.8);
    if (separation >= 0) ck_assert(volume == 0);
    if (separation < -1e-3) ck_assert(volume > 0);
  }
}
END_TEST

START_TEST(the_nearest_point_is_as_far_as_the_separation_says) {
  Random random = random_seeded(9, 0);
  int corners = 0, inner = 0;
  for (int trial = 0; trial < 2000; trial++) {
    double tet[12], weights[4], sum = 0, point[3] = {0, 0, 0};
    random_tet(&random, 0.7, tet);
    contact_ball_nearest(tet, CENTRE, weights);
    for (int v = 0; v < 4; v++) {
      sum += weights[v];
      ck_assert_double_ge(weights[v], 0);
      corners += weights[v] == 1;
      vec3_accumulate(point, vec3_scale(weights[v], vec3_at(tet + 3 * v)));
    }
    ck_assert_near(sum, 1, 1e-14);
    double separation = contact_ball_separation(tet, CENTRE, 0.8);
    inner += separation == -0.8;
    if (separation == -0.8) continue;
    ck_assert_near(vec3_length(vec3_sub(vec3_at(point), vec3_at(CENTRE))) - 0.8, separation, 1e-12);
  }
  ck_assert_int_gt(corners, 10);
  ck_assert_int_gt(inner, 3);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("ball");
  tcase_add_test(test_case, a_tetrahedron_inside_counts_whole);
  tcase_add_test(test_case, a_tetrahedron_around_holds_the_ball);
  tcase_add_test(test_case, corners_at_the_centre_and_caps_are_as_in_the_book);
  tcase_add_test(test_case, volumes_agree_with_counting_points);
  tcase_add_test(test_case, the_gradient_is_the_derivative_of_the_volume);
  tcase_add_test(test_case, the_gradient_has_no_moment_about_the_centre);
  tcase_add_test(test_case, a_subdivision_adds_up);
  tcase_add_test(test_case, planes_and_edges_through_the_centre_are_no_special_case);
  tcase_add_test(test_case, flat_tetrahedra_press_along_no_direction_that_pulls);
  tcase_add_test(test_case, separation_is_the_distance_less_the_radius);
  tcase_add_test(test_case, the_nearest_point_is_as_far_as_the_separation_says);
  return suite_run("ball", test_case, 60);
}

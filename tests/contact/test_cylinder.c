// SPDX-License-Identifier: GPL-3.0-or-later
// contact/shape/cylinder: tetrahedra against a cylinder with flat ends.
#include <math.h>
#include <string.h>

#include "suite.h"

#include "base/random.h"
#include "base/vec3.h"
#include "contact/shape/cylinder.h"

// A roller, a disc whose ends are nearer than its side in the middle, and a roller shrunk by a depth of 0.1.
static const ContactCylinder CYLINDERS[3] = {{0.5, 0.7, 0.5}, {0.6, 0.2, 0.6}, {0.4, 0.5, 0.5}};

static double whole_volume(const double tet[12]) {
  return fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6;
}

static void random_tet(Random *random, double size, double reach, double tet[12]) {
  double middle[3];
  for (int c = 0; c < 3; c++) middle[c] = random_between(random, -reach, reach);
  for (int k = 0; k < 12; k++) tet[k] = middle[k % 3] + random_between(random, -size, size);
}

static double press(const ContactCylinder *cylinder, const double tet[12], double rest, double gradient[12]) {
  double volume, energy, own[12];
  contact_cylinder_press(cylinder, tet, rest, &volume, &energy, gradient ? gradient : own, NULL);
  return energy;
}

// U = ∫ of the volume deeper than t: π (R² − 2 K t) 2 (H − t).
static double energy_of_whole(const ContactCylinder *cylinder) {
  double square = cylinder->radius * cylinder->radius, k = cylinder->round, h = cylinder->half_length;
  double t = fmin(square / (2 * k), h);
  return 2 * M_PI * (square * h * t - (square + 2 * k * h) * t * t / 2 + 2 * k * t * t * t / 3);
}

START_TEST(a_cylinder_within_a_tetrahedron_is_whole) {
  const ContactCylinder *cylinder = &CYLINDERS[_i];
  double tet[12] = {-4, -3, -5, 9, -2, -3, -3, 8, -4, 0.3, 0.4, 9}, volume, gradient[12];
  double whole = 2 * M_PI * cylinder->radius * cylinder->radius * cylinder->half_length;
  contact_cylinder_overlap(cylinder, tet, &volume, gradient);
  ck_assert_near(volume, whole, 1e-12 * whole);
  for (int k = 0; k < 12; k++) ck_assert_near(gradient[k], 0, 1e-12);
  ck_assert_near(press(cylinder, tet, whole_volume(tet), NULL), energy_of_whole(cylinder), 1e-12);
}
END_TEST

static void middle_of(const double *a, const double *b, double middle[3]) {
  for (int c = 0; c < 3; c++) middle[c] = 0.5 * (a[c] + b[c]);
}

// Into four corners and an octahedron about the diagonal from node 4 to node 9.
static void split(const double tet[12], double parts[8][12]) {
  static const int ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  static const int corners[8][4] = {{0, 4, 5, 6}, {1, 4, 7, 8}, {2, 5, 7, 9}, {3, 6, 8, 9},
                                    {4, 9, 5, 6}, {4, 9, 6, 8}, {4, 9, 8, 7}, {4, 9, 7, 5}};
  double nodes[10][3];
  memcpy(nodes, tet, 12 * sizeof *tet);
  for (int e = 0; e < 6; e++) middle_of(tet + 3 * ends[e][0], tet + 3 * ends[e][1], nodes[4 + e]);
  for (int p = 0; p < 8; p++)
    for (int v = 0; v < 4; v++) memcpy(parts[p] + 3 * v, nodes[corners[p][v]], 3 * sizeof(double));
}

START_TEST(parts_of_a_tetrahedron_sum_to_the_whole) {
  Random random = random_seeded(7, (uint64_t)_i);
  int met = 0;
  for (int trial = 0; trial < 300; trial++) {
    double tet[12], parts[8][12], sum = 0, volumes = 0, volume, part;
    random_tet(&random, trial % 2 ? 0.3 : 1.5, 0.6, tet);
    split(tet, parts);
    for (int p = 0; p < 8; p++) {
      contact_cylinder_overlap(&CYLINDERS[_i], parts[p], &part, NULL);
      volumes += part;
      sum += press(&CYLINDERS[_i], parts[p], whole_volume(parts[p]), NULL);
    }
    contact_cylinder_overlap(&CYLINDERS[_i], tet, &volume, NULL);
    ck_assert_near(volume, volumes, 1e-11 * whole_volume(tet) + 1e-14);
    ck_assert_near(press(&CYLINDERS[_i], tet, whole_volume(tet), NULL), sum,
                   1e-11 * whole_volume(tet) + 1e-14);
    met += volume > 0;
  }
  ck_assert_int_gt(met, 150);
}
END_TEST

START_TEST(forces_are_the_gradient_of_the_energy_and_of_the_volume) {
  Random random = random_seeded(8, (uint64_t)_i);
  const ContactCylinder *cylinder = &CYLINDERS[_i];
  int met = 0;
  for (int trial = 0; trial < 100; trial++) {
    double tet[12], gradient[12], sweep[12], volume, high, low, h = 1e-6, rest = 0.1;
    random_tet(&random, 0.4, 0.6, tet);
    if (whole_volume(tet) < 0.002) continue;
    press(cylinder, tet, rest, gradient);
    contact_cylinder_overlap(cylinder, tet, &volume, sweep);
    met += volume > 0;
    for (int k = 0; k < 12; k++) {
      double kept = tet[k];
      tet[k] = kept + h;
      double up = press(cylinder, tet, rest, NULL);
      contact_cylinder_overlap(cylinder, tet, &high, NULL);
      tet[k] = kept - h;
      double down = press(cylinder, tet, rest, NULL);
      contact_cylinder_overlap(cylinder, tet, &low, NULL);
      tet[k] = kept;
      ck_assert_near(gradient[k], (up - down) / (2 * h), 1e-6);
      ck_assert_near(sweep[k], (high - low) / (2 * h), 1e-6);
    }
  }
  ck_assert_int_gt(met, 40);
}
END_TEST

// What no prism does: turned about the axis by any angle the energy is the same, so a roller rolls without
// losing or gaining, and the force turns with it.
START_TEST(a_turn_about_the_axis_changes_nothing) {
  Random random = random_seeded(9, (uint64_t)_i);
  for (int trial = 0; trial < 200; trial++) {
    double tet[12], turned[12], before[12], after[12], angle = random_between(&random, 0, 7);
    double c = cos(angle), s = sin(angle);
    random_tet(&random, 0.3, 0.6, tet);
    for (int v = 0; v < 4; v++) {
      const double *x = tet + 3 * v;
      turned[3 * v] = c * x[0] - s * x[1], turned[3 * v + 1] = s * x[0] + c * x[1], turned[3 * v + 2] = x[2];
    }
    double rest = whole_volume(tet), energy = press(&CYLINDERS[_i], tet, rest, before);
    ck_assert_near(press(&CYLINDERS[_i], turned, rest, after), energy, 1e-13);
    for (int v = 0; v < 4; v++)
      ck_assert_near(c * before[3 * v] - s * before[3 * v + 1], after[3 * v], 1e-11);
  }
}
END_TEST

// Faces along the axis, as of a slice of ground under a roller, within rounding of it and exactly so.
START_TEST(faces_along_the_axis_cost_no_digits) {
  const ContactCylinder cylinder = {1, 0.6, 1};
  for (int k = 0; k < 12; k++) {
    double tilt = k == 0 ? 0 : pow(10, -k - 3), volume, straight;
    const double tet[12] = {0.9, -0.1, -0.1, 0.9, 0.1, -0.1, 0.9, 0.01, 0.1, 1.1, 0, 0};
    double tilted[12];
    memcpy(tilted, tet, sizeof tilted);
    tilted[6] += tilt;
    contact_cylinder_overlap(&cylinder, tet, &straight, NULL);
    contact_cylinder_overlap(&cylinder, tilted, &volume, NULL);
    ck_assert_near(volume, straight, 0.02 * tilt + 1e-15);
    ck_assert_double_gt(volume, 1e-4);
  }
}
END_TEST

START_TEST(the_matrix_is_the_gradient_of_the_force) {
  Random random = random_seeded(10, (uint64_t)_i);
  int met = 0;
  for (int trial = 0; trial < 30; trial++) {
    double tet[12], gradient[12], hessian[144], high[12], low[12], volume, energy, h = 1e-6;
    random_tet(&random, 0.4, 0.5, tet);
    if (whole_volume(tet) < 0.005) continue;
    contact_cylinder_press(&CYLINDERS[_i], tet, 0.1, &volume, &energy, gradient, hessian);
    met += volume > 0;
    for (int k = 0; k < 12; k++) {
      double kept = tet[k];
      tet[k] = kept + h;
      press(&CYLINDERS[_i], tet, 0.1, high);
      tet[k] = kept - h;
      press(&CYLINDERS[_i], tet, 0.1, low);
      tet[k] = kept;
      for (int r = 0; r < 12; r++) ck_assert_near(hessian[12 * r + k], (high[r] - low[r]) / (2 * h), 2e-4);
    }
  }
  ck_assert_int_gt(met, 10);
}
END_TEST

START_TEST(separation_is_the_distance_from_the_side_or_an_end) {
  const double tet[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double shifts[4][4] = {
      {1, -0.2, 0, 0.5}, {-0.2, -0.3, 1, 0.3}, {-0.2, -0.3, 0.1, -0.5}, {0.3, 0.4, 0, 0}};
  for (int k = 0; k < 4; k++) {
    double moved[12];
    for (int i = 0; i < 12; i++) moved[i] = tet[i] + shifts[k][i % 3];
    ck_assert_near(contact_cylinder_separation(&CYLINDERS[0], moved), shifts[k][3], 1e-15);
  }
}
END_TEST

// One tetrahedron of six, between radius 1 and 1.3, of the cell k of `count` round the axis and of length
// `length`: its corners on the cylinder's side are the side's own.
static void cell_of_ring(int count, int k, double length, int part, double tet[12]) {
  static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  int at[3] = {0, 0, 0};
  for (int v = 0; v < 4; v++) {
    double angle = 2 * M_PI * (k + at[0]) / count + 0.3, r = 1 + 0.3 * at[1];
    tet[3 * v] = r * cos(angle), tet[3 * v + 1] = r * sin(angle), tet[3 * v + 2] = 0.1 + length * at[2];
    if (v < 3) at[orders[part][v]] = 1;
  }
}

// A ring round a drum, its corners on the drum: it holds of the drum what is between the chords and the arcs.
START_TEST(a_ring_with_its_corners_on_the_side_holds_the_segments) {
  const ContactCylinder cylinder = {1, 0.6, 1};
  int count = 7 + 13 * _i;
  double length = 0.03, angle = 2 * M_PI / count, segment = 0.5 * (angle - sin(angle)) * length, sum = 0;
  for (int k = 0; k < count; k++) {
    double cell = 0, energy = 0, volume, gradient[12], tet[12];
    for (int part = 0; part < 6; part++) {
      cell_of_ring(count, k, length, part, tet);
      contact_cylinder_overlap(&cylinder, tet, &volume, gradient);
      cell += volume;
      for (int i = 0; i < 12; i++) ck_assert_double_lt(fabs(gradient[i]), 0.1);
      energy += press(&cylinder, tet, whole_volume(tet), NULL);
    }
    ck_assert_near(cell, segment, 1e-7 * segment + 1e-15);
    ck_assert_double_ge(energy, 0);
    ck_assert_double_lt(energy, cell * angle * angle / 8);
    sum += cell;
  }
  ck_assert_near(sum, count * segment, 1e-8 * count * segment + 1e-15);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("cylinder");
  tcase_add_loop_test(cases, a_cylinder_within_a_tetrahedron_is_whole, 0, 3);
  tcase_add_loop_test(cases, parts_of_a_tetrahedron_sum_to_the_whole, 0, 3);
  tcase_add_loop_test(cases, forces_are_the_gradient_of_the_energy_and_of_the_volume, 0, 3);
  tcase_add_loop_test(cases, a_turn_about_the_axis_changes_nothing, 0, 3);
  tcase_add_test(cases, faces_along_the_axis_cost_no_digits);
  tcase_add_loop_test(cases, a_ring_with_its_corners_on_the_side_holds_the_segments, 0, 8);
  tcase_add_loop_test(cases, the_matrix_is_the_gradient_of_the_force, 0, 3);
  tcase_add_test(cases, separation_is_the_distance_from_the_side_or_an_end);
  return suite_run("cylinder", cases, 60);
}

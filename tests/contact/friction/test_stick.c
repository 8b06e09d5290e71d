// SPDX-License-Identifier: GPL-3.0-or-later
// contact/friction/stick on pairs made by hand: forces, energies and the matrix.
#include "contact/friction/stick_pair.h"

START_TEST(what_is_moved_a_little_is_held_by_a_spring) {
  Fixture *f = start(1, true);
  double way = 1e-4, k = STIFFNESS * AREA;
  shift(f, 0, way, 0, 0.3 * way); // the way along the normal is no slip
  eval(f);
  ck_assert_near(pull_of(f).x, -k * way, 1e-12 * k);
  ck_assert_near(pull_of(f).y, 0, 1e-12 * k);
  ck_assert_near(pull_of(f).z, 0, 1e-12 * k);
  ck_assert_int_eq(f->stick.slip_count, 0);
  ck_assert_near(f->stick.areas[0][0], AREA, 1e-12 * AREA);
  ck_assert_near(f->stick.areas[0][1], 0, 1e-12 * AREA);
  ck_assert_near(f->stick.stored, 0.5 * k * way * way, 1e-12 * k);
  ck_assert_near(f->stick.spent, 0, 1e-12 * k);
  finish(f);
}
END_TEST

START_TEST(the_spring_is_cut_at_the_limit) {
  Fixture *f = start(1, true);
  double way = 0.1, k = STIFFNESS * AREA, elastic = MU * PRESS / k;
  ck_assert(elastic < 0.5 * way);
  shift(f, 0, 0, -way, 0);
  f->meet[1] -= way; // the same of A touches
  eval(f);
  ck_assert_near(pull_of(f).y, MU * PRESS, 1e-12 * PRESS);
  ck_assert_int_eq(f->stick.slip_count, 4);
  ck_assert_near(f->stick.areas[0][0], 0, 1e-12 * AREA);
  ck_assert_near(f->stick.areas[0][1], AREA, 1e-12 * AREA);
  ck_assert_near(f->stick.stored + f->stick.spent, 0.5 * k * elastic * elastic + MU * PRESS * (way - elastic),
                 1e-12);
  accept(f);
  shift(f, 0, 0, elastic, 0); // back until the spring is slack
  f->meet[1] += elastic;
  eval(f);
  ck_assert_near(pull_of(f).y, 0, 1e-9 * PRESS);
  ck_assert_int_eq(f->stick.slip_count, 0);
  finish(f);
}
END_TEST

// Nothing moves, so nothing does work: the spring stores the same, none is dissipated, and the pull follows
// the root of the area. Back at its area it is back at its pull.
START_TEST(an_area_that_changes_while_it_sticks_keeps_the_energy) {
  static const double SHARES[] = {2, 9, 3, 0.25, 0.5, 1};
  Fixture *f = start(1, true);
  double way = 1e-4, k = STIFFNESS * AREA, stored = 0.5 * k * way * way;
  shift(f, 0, way, 0, 0);
  eval(f);
  accept(f);
  for (int i = 0; i < 6; i++) {
    f->area = SHARES[i] * AREA;
    eval(f);
    ck_assert_near(pull_of(f).x, -k * way * sqrt(SHARES[i]), 1e-12 * k * way);
    ck_assert_near(f->stick.stored, stored, 1e-12 * stored);
    ck_assert_near(f->stick.spent, 0, 1e-12 * stored);
    accept(f);
  }
  finish(f);
}
END_TEST

// What an area that grows may pull at most is μN as ever; what is cut goes to dissipation, never back.
START_TEST(an_area_that_grows_at_the_limit_slips) {
  Fixture *f = start(1, true);
  double way = 0.1;
  shift(f, 0, way, 0, 0);
  eval(f);
  accept(f);
  f->area = 4 * AREA;
  eval(f);
  ck_assert_near(pull_of(f).x, -MU * PRESS, 1e-12 * PRESS);
  ck_assert_int_eq(f->stick.slip_count, 4);
  ck_assert_double_gt(f->stick.spent, 0);
  finish(f);
}
END_TEST

// The energies of motions and obstacles are integrated by the trapezoidal rule, and so is this.
START_TEST(a_press_that_grows_while_it_slides_dissipates_by_its_mean) {
  Fixture *f = start(1, true);
  double way = 0.1, k = STIFFNESS * AREA, stretched = 2 * MU * PRESS / k;
  shift(f, 0, way, 0, 0);
  eval(f);
  accept(f);
  f->force[2] = 3 * PRESS;
  shift(f, 0, way, 0, 0);
  f->meet[0] += way; // the same of A touches
  eval(f);
  ck_assert_near(f->stick.spent, 2 * MU * PRESS * (way - stretched), 1e-12);
  finish(f);
}
END_TEST

// Nothing moves, so no more is dissipated than the spring had: what it could have held says nothing of it.
START_TEST(a_press_that_falls_while_it_sticks_keeps_the_energy) {
  Fixture *f = start(1, true);
  double way = 1e-4, k = STIFFNESS * AREA, stored = 0.5 * k * way * way;
  shift(f, 0, way, 0, 0);
  eval(f);
  accept(f);
  f->force[2] = 1e-3 * PRESS;
  eval(f);
  ck_assert_int_eq(f->stick.slip_count, 4);
  ck_assert_near(f->stick.stored + f->stick.spent, stored, 1e-12 * stored);
  finish(f);
}
END_TEST

static Fixture *start_at_rest(double at_rest, double length) {
  Fixture *f = start(1, true);
  f->stick.laws[0].at_rest = at_rest;
  f->stick.laws[0].length = length;
  eval(f);
  accept(f);
  return f;
}

// Drags A by small ways; the largest pull on the way, and the work that the pull took.
static double drag(Fixture *f, double way, int count, double *work) {
  double most = 0;
  for (int i = 0; i < count; i++) {
    double before = pull_of(f).x;
    shift(f, 0, way, 0, 0);
    f->meet[0] += way; // the same of A touches
    eval(f);
    *work -= 0.5 * (before + pull_of(f).x) * way;
    most = fmax(most, -pull_of(f).x);
    accept(f);
  }
  return most;
}

// It holds up to μ_s N, and has fallen to μN once it has slid by D; what was put in is stored or dissipated.
START_TEST(what_breaks_away_slides_at_less) {
  const double lengths[] = {0, 2e-2}, rest = 0.8, k = STIFFNESS * AREA;
  for (int i = 0; i < 2; i++) {
    Fixture *f = start_at_rest(rest, lengths[i]);
    double elastic = rest * PRESS / k, chosen = 2 * (rest - MU) * PRESS / k, work = 0;
    double over = fmax(lengths[i], chosen), step = 1e-3 * elastic, spent = 0;
    double most = drag(f, step, 999, &work);
    ck_assert_near(most, 0.999 * rest * PRESS, 1e-9 * PRESS);
    ck_assert_int_eq(f->stick.slip_count, 0);
    most = drag(f, step, 2, &work);
    ck_assert_double_le(most, rest * PRESS);
    ck_assert_int_eq(f->stick.slip_count, 4);
    // Half of D later half of μ_s − μ is lost: the way less what the spring gives back.
    double half = 0.5 * over - 0.5 * (rest - MU) * PRESS / k;
    drag(f, step, (int)round(half / step) - 1, &work);
    ck_assert_near(-pull_of(f).x, 0.5 * (rest + MU) * PRESS, 2e-3 * PRESS);
    drag(f, step, (int)(over / step) + 10, &work);
    ck_assert_near(-pull_of(f).x, MU * PRESS, 1e-12 * PRESS);
    spent = *history_of(f).dissipated;
    ck_assert_near(spent + f->stick.stored, work, 1e-5 * work);
    finish(f);
  }
}
END_TEST

// What it held by μ_s N is dissipated, and then nothing.
START_TEST(what_breaks_away_slides_freely_without_friction) {
  Fixture *f = start_at_rest(0.8, 0);
  f->stick.laws[0].friction = 0;
  eval(f);
  accept(f);
  double k = STIFFNESS * AREA, step = 0.1 * PRESS / k, work = 0;
  drag(f, step, 40, &work);
  ck_assert_near(pull_of(f).x, 0, 1e-12 * PRESS);
  double spent = *history_of(f).dissipated;
  ck_assert_double_gt(spent, 0);
  drag(f, step, 10, &work);
  ck_assert_near(*history_of(f).dissipated, spent, 1e-12 * spent);
  finish(f);
}
END_TEST

// One step across it all: no more is dissipated than by small ones, so that nothing seems to be gained.
START_TEST(a_long_step_dissipates_as_many_short_ones) {
  double spent[2];
  for (int i = 0; i < 2; i++) {
    Fixture *f = start_at_rest(0.8, 0);
    double work = 0, way = 0.1;
    drag(f, i ? way : way / 1000, i ? 1 : 1000, &work);
    ck_assert_near(-pull_of(f).x, MU * PRESS, 1e-12 * PRESS);
    spent[i] = *history_of(f).dissipated;
    finish(f);
  }
  ck_assert_near(spent[1], spent[0], 1e-3 * spent[0]);
}
END_TEST

// The same without μ_s where the press goes from 1 to `SHARES` on the way, and the slip begins in the middle
// of that, or turns round.
START_TEST(a_long_step_dissipates_as_many_short_ones_at_a_press_that_changes) {
  static const double SHARES[] = {0.1, 3}, BEFORE[] = {0, 5e-3, -0.1};
  const int counts[] = {1, 1000};
  for (int c = 0; c < 6; c++) {
    double spent[2], way = c % 2 ? 0.1 : 0.02;
    for (int i = 0; i < 2; i++) {
      Fixture *f = start(1, true);
      double work = 0;
      drag(f, BEFORE[c / 2], 1, &work);
      double first = *history_of(f).dissipated;
      for (int k = 0; k < counts[i]; k++) {
        f->force[2] = PRESS * (1 + (SHARES[c % 2] - 1) * (k + 1) / counts[i]);
        drag(f, way / counts[i], 1, &work);
      }
      spent[i] = *history_of(f).dissipated - first;
      finish(f);
    }
    ck_assert_double_gt(spent[1], 0);
    ck_assert_near(spent[0], spent[1], 1e-9 * spent[1]);
  }
}
END_TEST

// Drawn back it sticks, and holds μ_s N again.
START_TEST(what_sticks_again_holds_as_before) {
  Fixture *f = start_at_rest(0.8, 0);
  double k = STIFFNESS * AREA, step = 1e-2 * PRESS / k, work = 0;
  drag(f, step, 400, &work);
  ck_assert_near(-pull_of(f).x, MU * PRESS, 1e-12 * PRESS);
  ck_assert_near(history_of(f).entries[0].weak, 1, 0);
  drag(f, -step, 10, &work);
  ck_assert_near(history_of(f).entries[0].weak, 0, 0);
  ck_assert_near(drag(f, step, 60, &work), 0.8 * PRESS, step * k);
  finish(f);
}
END_TEST

START_TEST(friction_at_rest_that_is_no_more_changes_nothing) {
  Fixture *one = start_at_rest(0, 0), *other = start_at_rest(MU, 1e-3);
  double work[2] = {0, 0};
  drag(one, 3e-3, 20, &work[0]);
  drag(other, 3e-3, 20, &work[1]);
  ck_assert(memcmp(&one->stick.forces[0], &other->stick.forces[0], sizeof(double[3])) == 0);
  ck_assert(*history_of(one).dissipated == *history_of(other).dissipated);
  finish(one), finish(other);
}
END_TEST

START_TEST(forces_and_torques_of_a_pair_balance) {
  for (int k = 0; k < 3; k++) {
    Fixture *f = start(0.5 * k, true);
    shift(f, 0, 2e-4, 3e-4, 1e-4);
    eval(f);
    double force[24] = {0};
    Vec3 sum = {0, 0, 0}, torque = {0, 0, 0};
    contact_stick_add_force(&f->stick, force);
    for (int v = 0; v < 8; v++) {
      sum = vec3_add(sum, vec3_at(force + 3 * v));
      torque = vec3_add(torque, vec3_cross(vec3_at(f->x + 3 * v), vec3_at(force + 3 * v)));
    }
    ck_assert(vec3_length(pull_of(f)) > 1e-3);
    ck_assert_near(vec3_length(sum), 0, 1e-14);
    ck_assert_near(vec3_length(torque), 0, 1e-14);
    finish(f);
  }
}
END_TEST

START_TEST(a_common_rotation_carries_forces_along_however_large_the_step) {
  const double degrees[] = {1, 10, 30, 120};
  for (int d = 0; d < 4; d++) {
    Fixture *f = start(0.5, true);
    double R[9];
    make_rotation(degrees[d] * M_PI / 180, R);
    shift(f, 0, 2e-3, -1e-3, 0);
    eval(f);
    accept(f);
    eval(f); // F of both sides is exact here: nothing but a shift
    Vec3 expected = pull_of(f);
    for (int step = 0; step < 12; step++) {
      rotate(f, R);
      eval(f);
      accept(f);
      double kept[3];
      vec3_store(kept, expected);
      expected = turn(R, kept);
      ck_assert_near(vec3_length(vec3_sub(pull_of(f), expected)), 0, 1e-12 * vec3_length(expected));
    }
    ck_assert(vec3_length(expected) > 0.1);
    finish(f);
  }
}
END_TEST

typedef struct Dense {
  double matrix[24][24];
} Dense;

static void add_outer(void *self, int count, const int *vertices, const double *w, double scale) {
  Dense *dense = self;
  for (int i = 0; i < 3 * count; i++)
    for (int j = 0; j < 3 * count; j++)
      dense->matrix[3 * vertices[i / 3] + i % 3][3 * vertices[j / 3] + j % 3] += scale * w[i] * w[j];
}

// With the force, area and x̄ of the pair held, and no history, the matrix is the derivative of the pull on A,
// and where that is zero of all forces (the weights λ depend on the positions too).
static void check_matrix(Fixture *f, double step, double tolerance) {
  Dense dense = {0};
  double largest = 0, before[24];
  memcpy(before, f->x, sizeof before);
  eval(f);
  ck_assert_ok(contact_stick_add_stiffness(&f->stick,
                                           &(ContactStiffnessSink){.self = &dense, .add_outer = add_outer}));
  for (int i = 0; i < 24; i++) largest = suite_larger(largest, dense.matrix[i][i]);
  ck_assert(largest > 0);
  for (int j = 0; j < 24; j++) {
    double force[2][24] = {0};
    for (int k = 0; k < 2; k++) {
      memcpy(f->x, before, sizeof before);
      f->x[j] += k ? -step : step;
      eval(f);
      contact_stick_add_force(&f->stick, force[k]);
    }
    double slopes[24], sums[2][3] = {0};
    for (int i = 0; i < 24; i++) {
      slopes[i] = (force[1][i] - force[0][i]) / (2 * step);
      if (i < 12) sums[0][i % 3] += dense.matrix[i][j], sums[1][i % 3] += slopes[i];
      if (!f->stick.slip_count) ck_assert_near(dense.matrix[i][j], slopes[i], tolerance * largest);
    }
    for (int c = 0; c < 3; c++) ck_assert_near(sums[0][c], sums[1][c], tolerance * largest);
  }
  memcpy(f->x, before, sizeof before);
}

START_TEST(the_matrix_is_the_derivative_in_stick) {
  for (int k = 0; k < 3; k++) {
    Fixture *f = start(0.5 * k, true);
    check_matrix(f, 1e-6, 1e-5);
    finish(f);
  }
}
END_TEST

// Only the tangent across the slip is left of it.
START_TEST(the_matrix_is_the_derivative_in_slip) {
  Fixture *f = start(1, false);
  f->obstacle[0] = 0.3, f->obstacle[1] = 0.2;
  eval(f);
  ck_assert_int_eq(f->stick.slip_count, 4);
  check_matrix(f, 1e-6, 2e-5);
  finish(f);
}
END_TEST

// Straight slip is exact whatever the steps; the spring is not counted twice.
START_TEST(a_way_in_many_steps_dissipates_as_much_as_in_one) {
  const int steps[] = {1, 7, 100};
  const double way = 0.2, k = STIFFNESS * AREA, elastic = MU * PRESS / k;
  for (int i = 0; i < 3; i++) {
    Fixture *f = start(1, false);
    for (int s = 0; s < steps[i]; s++) {
      f->obstacle[1] = way / steps[i];
      eval(f);
      ck_assert(f->stick.spent >= -1e-15);
      accept(f);
    }
    ck_assert_near(*history_of(f).dissipated, MU * PRESS * (way - elastic), 1e-10);
    finish(f);
  }
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("stick");
  tcase_add_test(test_case, what_is_moved_a_little_is_held_by_a_spring);
  tcase_add_test(test_case, the_spring_is_cut_at_the_limit);
  tcase_add_test(test_case, an_area_that_changes_while_it_sticks_keeps_the_energy);
  tcase_add_test(test_case, an_area_that_grows_at_the_limit_slips);
  tcase_add_test(test_case, a_press_that_grows_while_it_slides_dissipates_by_its_mean);
  tcase_add_test(test_case, a_press_that_falls_while_it_sticks_keeps_the_energy);
  tcase_add_test(test_case, what_breaks_away_slides_at_less);
  tcase_add_test(test_case, a_long_step_dissipates_as_many_short_ones);
  tcase_add_test(test_case, a_long_step_dissipates_as_many_short_ones_at_a_press_that_changes);
  tcase_add_test(test_case, what_breaks_away_slides_freely_without_friction);
  tcase_add_test(test_case, what_sticks_again_holds_as_before);
  tcase_add_test(test_case, friction_at_rest_that_is_no_more_changes_nothing);
  tcase_add_test(test_case, forces_and_torques_of_a_pair_balance);
  tcase_add_test(test_case, a_common_rotation_carries_forces_along_however_large_the_step);
  tcase_add_test(test_case, the_matrix_is_the_derivative_in_stick);
  tcase_add_test(test_case, the_matrix_is_the_derivative_in_slip);
  tcase_add_test(test_case, a_way_in_many_steps_dissipates_as_much_as_in_one);
  return suite_run("stick", test_case, 30);
}

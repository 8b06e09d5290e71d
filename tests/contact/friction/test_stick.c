// SPDX-License-Identifier: GPL-3.0-or-later
// contact/friction/stick on pairs made by hand: two tetrahedra that share a point, pressed by a force that is
// given.
#include "suite.h"

#include <string.h>

#include "base/vec3.h"
#include "contact/friction/stick_told.h"

static const double MU = 0.5, STIFFNESS = 2e4; // [Pa/m]
static const double AREA = 0.03, PRESS = 12;   // [m²], [N]

// A above, B below, both around the origin; x̄ is a point of space that both cover.
static const double REST[24] = {-0.5, -0.4, -0.3, 0.9, -0.2, -0.2, -0.1, 1.1,  -0.25, 0.1, 0.2, 0.9,
                                -0.6, -0.5, 0.3,  0.2, 1.0,  0.25, 0.8,  -0.3, 0.2,   0.0, 0.1, -0.8};
static const int TETS[2][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}};
static const double MEET[3] = {0.1, 0.05, 0.02};

typedef struct Fixture {
  ContactStick stick;
  double before[24], *history; // of the last accepted state
  size_t history_count;
  double x[24];
  double meet[3], force[3]; // x̄ and what presses A
  double area;              // that the pair covers
  bool has_body_below;      // else an obstacle without elements
  double obstacle[3];       // way of that since the last accepted state
} Fixture;

// Barycentric coordinates of p.
static void locate(const double *x, const int tet[4], const double *p, double lambda[4]) {
  Vec3 corner[4];
  for (int v = 0; v < 4; v++) corner[v] = vec3_at(x + 3 * tet[v]);
  double whole = vec3_det4(corner[0], corner[1], corner[2], corner[3]);
  for (int v = 0; v < 4; v++) {
    Vec3 other[4] = {corner[0], corner[1], corner[2], corner[3]};
    other[v] = vec3_at(p);
    lambda[v] = vec3_det4(other[0], other[1], other[2], other[3]) / whole;
  }
}

static ContactStickHistory history_of(const Fixture *f) {
  return contact_stick_history_view(1, f->history, f->history_count);
}

static void eval_pairs(Fixture *f, int count, const bool *is_resting) {
  const ContactStickLast last = {.positions = f->before, .history = history_of(f)};
  ck_assert_ok(contact_stick_eval(&f->stick, &last, count, f->x, is_resting));
}

static void eval(Fixture *f) {
  ck_assert_ok(contact_stick_reserve(&f->stick, 1));
  ContactStickPair *pair = &f->stick.pairs[0];
  *pair = (ContactStickPair){.tets = {0, f->has_body_below ? 1 : -1}, .area = f->area};
  memcpy(pair->force, f->force, sizeof f->force);
  for (int side = 0; side < 2; side++) locate(f->x, TETS[side], f->meet, pair->lambda[side]);
  vec3_store(pair->before, vec3_sub(vec3_at(f->meet), vec3_at(f->obstacle)));
  eval_pairs(f, 1, NULL);
}

static void accept_resting(Fixture *f, const bool *is_resting) {
  const ContactStickHistory history = history_of(f);
  size_t count = contact_stick_next_count(&f->stick, &history, is_resting);
  double *next = calloc(count, sizeof *next);
  ck_assert_ptr_nonnull(next);
  contact_stick_advance(&f->stick, &history, is_resting, next);
  free(f->history);
  f->history = next;
  f->history_count = count;
  memcpy(f->before, f->x, sizeof f->x);
}

static void accept(Fixture *f) {
  accept_resting(f, NULL);
  memset(f->obstacle, 0, sizeof f->obstacle);
}

static Fixture *start(double weight_above, bool has_body_below) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  ContactStickLaw law = {.friction = MU, .stiffness = STIFFNESS, .weight = {weight_above, 1 - weight_above}};
  ck_assert_ok(contact_stick_create(&f->stick, 8, REST, TETS, 1, &law));
  memcpy(f->x, REST, sizeof f->x);
  memcpy(f->before, REST, sizeof f->before);
  f->history_count = contact_stick_history_count(1, 0);
  f->history = calloc(f->history_count, sizeof *f->history);
  ck_assert_ptr_nonnull(f->history);
  memcpy(f->meet, MEET, sizeof f->meet);
  f->force[2] = PRESS;
  f->area = AREA;
  f->has_body_below = has_body_below;
  eval(f);
  accept(f);
  return f;
}

static void finish(Fixture *f) {
  contact_stick_destroy(&f->stick);
  free(f->history);
  free(f);
}

static void shift(Fixture *f, int tet, double x, double y, double z) {
  for (int v = 0; v < 4; v++) vec3_accumulate(f->x + 3 * TETS[tet][v], (Vec3){x, y, z});
}

static Vec3 pull_of(const Fixture *f) {
  return vec3_at(f->stick.forces[0]);
}

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

static Vec3 turn(const double R[9], const double *x) {
  return (Vec3){R[0] * x[0] + R[1] * x[1] + R[2] * x[2], R[3] * x[0] + R[4] * x[1] + R[5] * x[2],
                R[6] * x[0] + R[7] * x[1] + R[8] * x[2]};
}

// About the axis (1, 2, 2)/3.
static void make_rotation(double angle, double R[9]) {
  const double n[3] = {1.0 / 3, 2.0 / 3, 2.0 / 3}, c = cos(angle), s = sin(angle);
  const double cross[9] = {0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) R[3 * i + j] = c * (i == j) + (1 - c) * n[i] * n[j] + s * cross[3 * i + j];
}

static void rotate(Fixture *f, const double R[9]) {
  for (int v = 0; v < 8; v++) vec3_store(f->x + 3 * v, turn(R, f->x + 3 * v));
  vec3_store(f->meet, turn(R, f->meet));
  vec3_store(f->force, turn(R, f->force));
}

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

START_TEST(evaluating_leaves_no_trace) {
  Fixture *f = start(1, true);
  shift(f, 0, 1e-3, 0, 0);
  eval(f);
  accept(f);
  eval(f);
  Vec3 first = pull_of(f);
  shift(f, 0, 0.2, 0.3, 0);
  eval(f);
  ck_assert(vec3_length(vec3_sub(pull_of(f), first)) > 0.1);
  memcpy(f->x, f->before, sizeof f->x);
  eval(f);
  Vec3 again = pull_of(f);
  ck_assert_int_eq(memcmp(&first, &again, sizeof first), 0);
  finish(f);
}
END_TEST

START_TEST(a_history_that_is_copied_goes_on_to_the_bit) {
  Fixture *f = start(0.5, true), *other = start(0.5, true);
  shift(f, 0, 1e-3, 7e-4, 0);
  eval(f);
  accept(f);
  ck_assert_int_eq(history_of(f).entry_count, 8);
  free(other->history);
  other->history_count = f->history_count;
  other->history = malloc(f->history_count * sizeof *f->history);
  memcpy(other->history, f->history, f->history_count * sizeof *f->history);
  memcpy(other->before, f->before, sizeof f->before);
  memcpy(other->x, f->x, sizeof f->x);
  shift(f, 0, 1e-4, 0, 0);
  shift(other, 0, 1e-4, 0, 0);
  eval(f);
  eval(other);
  ck_assert_int_eq(memcmp(f->stick.forces, other->stick.forces, sizeof *f->stick.forces), 0);
  ck_assert_int_eq(memcmp(f->stick.pulls, other->stick.pulls, sizeof *f->stick.pulls), 0);
  ck_assert(f->stick.stored == other->stick.stored && f->stick.spent == other->stick.spent);
  finish(f);
  finish(other);
}
END_TEST

START_TEST(numbers_that_are_no_history_are_refused) {
  Fixture *f = start(0.5, true);
  ck_assert_ok(contact_stick_history_check(1, 8, f->history, f->history_count));
  ck_assert_int_eq(contact_stick_history_check(1, 8, f->history, f->history_count - 1), STATUS_INPUT);
  ck_assert_int_eq(contact_stick_history_check(1, 7, f->history, f->history_count), STATUS_INPUT);
  ck_assert_int_eq(contact_stick_history_check(1, 8, f->history, 3), STATUS_INPUT);
  finish(f);
}
END_TEST

START_TEST(what_lifts_off_loses_its_spring) {
  Fixture *f = start(1, true);
  shift(f, 0, 2e-3, 0, 0);
  eval(f);
  double stored = f->stick.stored;
  accept(f);
  ck_assert_int_eq(history_of(f).entry_count, 4);
  eval_pairs(f, 0, NULL);
  ck_assert(stored > 0);
  ck_assert_near(f->stick.spent, stored, 1e-12 * stored);
  ck_assert_near(f->stick.stored, 0, 0);
  accept(f);
  ck_assert_near(*history_of(f).dissipated, stored, 1e-12 * stored);
  for (int e = 0; e < history_of(f).entry_count; e++) {
    ck_assert_double_eq(history_of(f).entries[e].energy, 0);
    ck_assert_double_eq(history_of(f).entries[e].limit, 0);
  }
  finish(f);
}
END_TEST

typedef struct Sums {
  double weights[8][2], slips[8][3], ways[8], works[8];
  double work; // of all vertices
} Sums;

// What is told at the state that was evaluated last.
static void tell(const Fixture *f, const bool *is_resting, Sums *sums) {
  static const double DEPTHS[8] = {0};
  const ContactStickHistory history = history_of(f);
  *sums = (Sums){0};
  contact_stick_tell(
      &f->stick, &history, is_resting, DEPTHS,
      &(ContactStickTold){
          .weights = sums->weights, .slips = sums->slips, .ways = sums->ways, .works = sums->works});
  for (int v = 0; v < 8; v++) sums->work += sums->works[v];
}

// There and back by more than the spring bears: the way is twice as long as the slip is short, and what the
// vertices dissipated is what the law did.
START_TEST(slip_way_and_work_are_told_at_the_vertices_of_the_slave) {
  Fixture *f = start(1, true);
  Sums sums;
  double way = 0.05, elastic = MU * PRESS / (STIFFNESS * AREA);
  shift(f, 0, way, 0, 0);
  f->meet[0] += way; // the same of A touches
  eval(f);
  tell(f, NULL, &sums);
  ck_assert_near(sums.work, f->stick.spent, 1e-12 * f->stick.spent);
  for (int v = 0; v < 8; v++) {
    ck_assert_near(sums.ways[v], v < 4 ? way - elastic : 0, 1e-12);
    ck_assert_near(sums.slips[v][0], v < 4 ? way - elastic : 0, 1e-12);
    ck_assert_double_gt(sums.weights[v][1], 0); // both sides slide
    ck_assert_double_eq(sums.weights[v][0], 0);
  }
  accept(f);
  shift(f, 0, -way, 0, 0);
  f->meet[0] -= way;
  eval(f);
  tell(f, NULL, &sums);
  ck_assert_near(sums.ways[0], 2 * way - 3 * elastic, 1e-12);
  ck_assert_near(sums.slips[0][0], elastic, 1e-12);
  ck_assert_near(sums.work, *history_of(f).dissipated + f->stick.spent, 1e-12 * sums.work);
  finish(f);
}
END_TEST

// What has left keeps its way and its work, with what its spring had stored; what comes back begins its slip
// anew.
START_TEST(way_and_work_outlast_the_contact_and_slip_does_not) {
  Fixture *f = start(1, true);
  Sums sums;
  double way = 0.05, elastic = MU * PRESS / (STIFFNESS * AREA);
  shift(f, 0, way, 0, 0);
  eval(f);
  accept(f);
  eval_pairs(f, 0, NULL);
  for (int k = 0; k < 3; k++) {
    tell(f, NULL, &sums);
    ck_assert_near(sums.work, *history_of(f).dissipated + f->stick.spent, 1e-12 * sums.work);
    ck_assert_near(sums.ways[0], way - elastic, 1e-12);
    ck_assert_near(sums.slips[0][0], 0, 0);
    accept(f);
    eval_pairs(f, 0, NULL);
  }
  ck_assert_int_eq(history_of(f).entry_count, 4);
  eval(f);
  tell(f, NULL, &sums);
  ck_assert_near(sums.slips[0][0], 0, 1e-12);
  ck_assert_near(sums.ways[0], way - elastic, 1e-12);
  ck_assert_near(sums.work, *history_of(f).dissipated + f->stick.spent, 1e-12 * sums.work);
  finish(f);
}
END_TEST

// The slip turns with the body, as the spring does.
START_TEST(slip_turns_with_its_body_and_stays_at_rest) {
  Fixture *f = start(1, true);
  const bool is_resting = true;
  Sums sums;
  double R[9], way = 0.05, elastic = MU * PRESS / (STIFFNESS * AREA);
  shift(f, 0, way, 0, 0);
  eval(f);
  accept(f);
  make_rotation(1, R);
  rotate(f, R);
  eval(f);
  tell(f, NULL, &sums);
  Vec3 expected = turn(R, (const double[]){way - elastic, 0, 0});
  ck_assert_near(vec3_length(vec3_sub(vec3_at(sums.slips[0]), expected)), 0, 1e-12);
  accept(f);
  eval_pairs(f, 0, &is_resting);
  tell(f, &is_resting, &sums);
  ck_assert_near(vec3_length(vec3_sub(vec3_at(sums.slips[0]), expected)), 0, 1e-12);
  ck_assert_near(sums.work, *history_of(f).dissipated, 1e-12 * sums.work);
  finish(f);
}
END_TEST

START_TEST(what_rests_keeps_its_history) {
  Fixture *f = start(1, true);
  const bool is_resting = true;
  shift(f, 0, 2e-3, 0, 0);
  eval(f);
  accept(f);
  double stretch[3], stored = f->stick.stored;
  Vec3 pull = pull_of(f);
  memcpy(stretch, history_of(f).entries[0].stretch, sizeof stretch);
  eval_pairs(f, 0, &is_resting);
  ck_assert_near(f->stick.stored, stored, 1e-15);
  ck_assert_near(f->stick.spent, 0, 0);
  ck_assert_near(pull_of(f).x, pull.x, 0);
  accept_resting(f, &is_resting);
  ck_assert_int_eq(history_of(f).entry_count, 4);
  ck_assert_int_eq(memcmp(stretch, history_of(f).entries[0].stretch, sizeof stretch), 0);
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
  tcase_add_test(test_case, evaluating_leaves_no_trace);
  tcase_add_test(test_case, a_history_that_is_copied_goes_on_to_the_bit);
  tcase_add_test(test_case, numbers_that_are_no_history_are_refused);
  tcase_add_test(test_case, what_lifts_off_loses_its_spring);
  tcase_add_test(test_case, slip_way_and_work_are_told_at_the_vertices_of_the_slave);
  tcase_add_test(test_case, way_and_work_outlast_the_contact_and_slip_does_not);
  tcase_add_test(test_case, slip_turns_with_its_body_and_stays_at_rest);
  tcase_add_test(test_case, what_rests_keeps_its_history);
  tcase_add_test(test_case, a_way_in_many_steps_dissipates_as_much_as_in_one);
  return suite_run("stick", test_case, 30);
}

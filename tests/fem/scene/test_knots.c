// SPDX-License-Identifier: GPL-3.0-or-later
// Motions and loads that change for less than a step: how far a step may go along a function, and runs in
// which something short happens after a long rest.
#include "scene.h"

#include "base/memory.h"
#include "fem/scene/drive.h"
#include "fem/scene/load.h"
#include "fem/scene/table.h"

static const FemForesight foresight = {.displacement = 1e-3, .velocity = 1e-3, .resolution = 1e-9};

// ---- Functions

START_TEST(a_table_is_constant_outside_and_straight_between_its_rows) {
  const double rows[] = {1, 5, -1, 2, 7, -1, 4, 3, 0};
  const FemTable table = {rows, 3, 3};
  const double at[][5] = {// time, values, rates
                          {0, 5, -1, 0, 0},      {1, 5, -1, 2, 0}, {1.5, 6, -1, 2, 0}, {2, 7, -1, -2, 0.5},
                          {3, 5, -0.5, -2, 0.5}, {4, 3, 0, 0, 0},  {9, 3, 0, 0, 0}};
  for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
    double values[2], rates[2];
    fem_table_eval(table, at[k][0], values, rates);
    for (int c = 0; c < 2; c++) {
      ck_assert_double_eq(values[c], at[k][1 + c]);
      ck_assert_double_eq(rates[c], at[k][3 + c]);
    }
  }
  ck_assert_double_eq(fem_table_next_row(table, 0), 1);
  ck_assert_double_eq(fem_table_next_row(table, 1), 2);
  ck_assert_double_eq(fem_table_next_row(table, 3.9), 4);
  ck_assert(isinf(fem_table_next_row(table, 4)));
}
END_TEST

static double horizon_of(const double *rows, int count, double time, double farthest) {
  FemConstraintDef def = {.table = (double *)rows, .table_count = count, .until = INFINITY};
  return fem_drive_horizon(&def, 1, &foresight, time, farthest);
}

START_TEST(a_step_ends_at_the_knots_of_a_pulse) {
  const double rows[] = {1, 0, 0, 0, 1.001, 0, 0, 1, 1.002, 0, 0, 0};
  ck_assert_double_eq(horizon_of(rows, 3, 0.5, 0.9), 0.9); // not yet
  ck_assert_double_eq(horizon_of(rows, 3, 0.5, 1), 1);
  ck_assert_double_eq(horizon_of(rows, 3, 0.5, 5), 1);
  ck_assert_double_eq(horizon_of(rows, 3, 1, 5), 1.001);
  ck_assert_double_eq(horizon_of(rows, 3, fem_signal_before(1), 5), 1.001);
  ck_assert_double_eq(horizon_of(rows, 3, 1.0004, 5), 1.001);
  ck_assert_double_eq(horizon_of(rows, 3, 1.001, 5), 1.002);
  ck_assert_double_eq(horizon_of(rows, 3, 1.002, 5), 5); // it is over
}
END_TEST

START_TEST(a_step_passes_what_lies_within_the_tolerance) {
  const double small[] = {1, 0, 0, 0, 1.001, 0, 0, 0.9e-3, 1.002, 0, 0, 0},
               larger[] = {1, 0, 0, 0, 1.001, 0, 0, 1.1e-3, 1.002, 0, 0, 0},
               straight[] = {0, 0, 0, 0, 1, 1, 2, 3, 1.5, 1.5, 3, 4.5, 3, 3, 6, 9};
  ck_assert_double_eq(horizon_of(small, 3, 0.5, 5), 5);
  ck_assert_double_eq(horizon_of(larger, 3, 0.5, 5), 1);
  ck_assert_double_eq(horizon_of(straight, 4, 0.1, 2.9), 2.9);
}
END_TEST

// A smooth curve of many rows is left to the integrator, which sees it at its steps' ends.
START_TEST(rows_that_follow_a_smooth_curve_do_not_end_steps) {
  enum { ROWS = 1000 };
  static double rows[4 * ROWS];
  for (int i = 0; i < ROWS; i++) rows[4 * i] = 1e-3 * i, rows[4 * i + 2] = 0.1 * sin(2e-3 * M_PI * i);
  for (double time = 0.0005; time < 0.8; time += 0.0999)
    ck_assert_double_eq(horizon_of(rows, ROWS, time, time + 0.1), time + 0.1);
  rows[4 * 420 + 2] += 0.01; // one value that is out of line
  ck_assert_double_eq(horizon_of(rows, ROWS, 0.4, 0.44), 0.419);
  ck_assert_double_eq(horizon_of(rows, ROWS, 0.419, 0.44), 0.42);
  ck_assert_double_eq(horizon_of(rows, ROWS, 0.42, 0.44), 0.421);
  ck_assert_double_eq(horizon_of(rows, ROWS, 0.421, 0.44), 0.44);
}
END_TEST

START_TEST(an_end_of_motion_is_a_knot_of_moving_and_of_turning) {
  FemConstraintDef def = {.velocity = {0, 1, 0}, .until = 2};
  ck_assert_double_eq(fem_drive_horizon(&def, 1, &foresight, 1, 5), 2);
  ck_assert_double_eq(fem_drive_horizon(&def, 1, &foresight, 2, 5), 5);
  def = (FemConstraintDef){.spin = 3, .axis = {0, 0, 1}, .until = 2};
  ck_assert_double_eq(fem_drive_horizon(&def, 1, &foresight, 1, 5), 2);
  ck_assert_double_eq(fem_drive_horizon(&def, 1, &foresight, 2, 5), 5);
  def.until = INFINITY;
  ck_assert_double_eq(fem_drive_horizon(&def, 1, &foresight, 1, 5), 5);
}
END_TEST

// Of acceleration a, a load that is unseen for a step h changes a velocity by a h times what it is off.
START_TEST(a_load_is_passed_by_the_velocity_that_it_would_give) {
  const double rows[] = {1, 0, 1.001, 1, 1.002, 0};
  FemLoadDef def = {.table = (double *)rows, .table_count = 3};
  ck_assert_double_eq(fem_load_horizon(&def, 0.9e-3, &foresight, 0.5, 1.5), 1.5);
  ck_assert_double_eq(fem_load_horizon(&def, 1.1e-3, &foresight, 0.5, 1.5), 1);
  ck_assert_double_eq(fem_load_horizon(&def, 0, &foresight, 0.5, 1.5), 1.5); // on nobody
  FemForesight statics = {.displacement = 1e-3, .resolution = 1e-9, .static_share = 1e-3};
  ck_assert_double_eq(fem_load_horizon(&def, 1e-9, &statics, 0.5, 1.5), 1);
}
END_TEST

START_TEST(a_formula_is_followed_to_its_kinks_and_where_it_bends) {
  Expression formula;
  ck_assert_ok(expression_parse(&formula, "t", "smooth((t-1)/0.01) - smooth((t-1.02)/0.01)"));
  FemConstraintDef def = {.formula = {NULL, &formula, NULL}, .until = INFINITY};
  ck_assert_double_eq(fem_drive_horizon(&def, 1, &foresight, 0.5, 50), 1);
  ck_assert_near(fem_drive_horizon(&def, 1, &foresight, 1, 50), 1.01, 1e-14);
  ck_assert_near(fem_drive_horizon(&def, 1, &foresight, 1.015, 50), 1.02, 1e-14);
  ck_assert_double_eq(fem_drive_horizon(&def, 1, &foresight, 1.03, 50), 50);
  ck_assert_ok(expression_parse(&formula, "t", "sin(t)"));
  double end = fem_drive_horizon(&def, 1, &foresight, 0, 50);
  ck_assert_double_ge(end, 0.3);
  ck_assert_double_le(end, 1.8); // (h/2)⁴/24 of the amplitude is 1e-3 at h = 0.8
  // Statics goes straight, and stops at kinks alone.
  FemForesight statics = {.displacement = 1e-3, .resolution = 1e-9, .static_share = 1e-3};
  ck_assert_double_eq(fem_drive_horizon(&def, 1, &statics, 0, 50), 50);
}
END_TEST

START_TEST(knots_closer_than_the_resolution_count_as_one) {
  const double spike[] = {1, 0, 0, 0, 1 + 1e-12, 0, 0, 1, 1 + 2e-12, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 1};
  ck_assert_double_eq(horizon_of(spike, 5, 0.5, 1.5), 1.5); // for no time
  ck_assert_double_eq(horizon_of(spike, 5, 0.5, 3), 2);
  const double jump[] = {1, 0, 0, 0, 1 + 1e-12, 0, 0, 1, 2, 0, 0, 1, 3, 0, 0, 0};
  double first = horizon_of(jump, 4, 0.5, 1.5);
  ck_assert_near(first, 1, 1e-9);
  ck_assert_double_eq(horizon_of(jump, 4, fem_signal_before(first), 1.5), 1.5);
  ck_assert_double_eq(horizon_of(jump, 4, first, 1.5), 1.5);
  ck_assert_double_eq(horizon_of(jump, 4, 1.5, 3), 2);
  ck_assert_double_eq(horizon_of(jump, 4, 2.5, 3), 3);
  // Just before the farthest time: a matter of the next step.
  ck_assert_double_eq(horizon_of(jump, 4, 1.5, 2 + 1e-10), 2 + 1e-10);
}
END_TEST

// ---- Runs

// Of the scene's energy. A push gives its impulse to a thousandth, so its energy to two; the audit's rule
// over the few steps of a push errs by as much again.
static const double MOST_GAIN = 5e-3;

static double momentum_of(const SceneRun *run) {
  int last = run->result.trajectory.frame_count - 1; // of a body that does not vibrate
  double span = run->result.trajectory.times[last] - run->result.trajectory.times[last - 1], mass = 0,
         sum = 0;
  for (int v = 0; v < run->model.vertex_count; v++) {
    double way = scene_position(run, last, v)[0] - scene_position(run, last - 1, v)[0];
    sum += run->model.mass[v] * way / span, mass += run->model.mass[v];
  }
  ck_assert_near(mass, 1, 1e-12);
  return sum;
}

static double struck_by(const char *const *overrides) {
  SceneRun run;
  scene_run(&run, "struck", overrides);
  double momentum = momentum_of(&run);
  ck_assert_double_le(scene_gain(&run), MOST_GAIN);
  ck_assert_double_eq(run.result.end_time, 1);
  scene_close(&run);
  return momentum;
}

#define TABLE "bodies.cube.loads[0].table="
#define FACTOR "bodies.cube.loads[0].factor="

// A force of 1e4 N on 1 kg: momentum is its integral. Steps had grown to 0.1 s, the push lasts 1e-4 s.
START_TEST(a_push_of_a_thousandth_of_a_step_gives_its_impulse) {
  ck_assert_near(struck_by(NULL), 0.5, 1e-3 * 0.5);
  ck_assert_near(struck_by((const char *[]){TABLE "[[0.5,0],[0.50001,1],[0.50009,1],[0.5001,0]]", NULL}), 0.9,
                 1e-3 * 0.9);
}
END_TEST

START_TEST(a_formula_that_jumps_gives_its_impulse) {
  ck_assert_near(struck_by((const char *[]){TABLE "null", FACTOR "step(t-0.5)-step(t-0.5001)", NULL}), 1,
                 1e-6);
  ck_assert_near(struck_by((const char *[]){TABLE "null", FACTOR "max(0, 1-2e4*abs(t-0.50005))", NULL}), 0.5,
                 1e-3 * 0.5);
}
END_TEST

START_TEST(knots_at_the_beginning_and_at_the_end_are_kept) {
  ck_assert_near(struck_by((const char *[]){TABLE "[[0,0],[0.00005,1],[0.0001,0],[1,0]]", NULL}), 0.5,
                 1e-3 * 0.5);
  // What begins at the end comes too late; the rounding of forces at rest is not nothing.
  ck_assert_near(struck_by((const char *[]){TABLE "[[0,0],[1,0],[1.0001,1]]", NULL}), 0, 1e-12);
}
END_TEST

START_TEST(a_load_that_rises_within_rounding_is_a_jump) {
  ck_assert_near(struck_by((const char *[]){TABLE "[[0.5,0],[0.50000000000001,1],[0.5001,0]]", NULL}), 0.5,
                 1e-3 * 0.5);
}
END_TEST

// The same load by a formula and by a thousand rows that follow it.
START_TEST(a_smooth_table_of_a_thousand_rows_costs_no_more_than_its_formula) {
  enum { ROWS = 1001 };
  double *rows = memory_zeroed((size_t)2 * ROWS, sizeof *rows);
  for (int i = 0; i < ROWS; i++) rows[2 * i] = 1e-3 * i, rows[2 * i + 1] = 1e-3 * sin(4e-3 * M_PI * i);
  SceneRun formula, table;
  scene_run(&formula, "struck", (const char *[]){TABLE "null", FACTOR "1e-3*sin(4*pi*t)", NULL});
  scene_open(&table, "struck", NULL);
  FemLoadDef *load = &table.scene.bodies[0].loads[0];
  memory_free(load->table);
  load->table = rows, load->table_count = ROWS;
  scene_run_from(&table, NULL);
  ck_assert_ok(table.status);
  ck_assert_double_le((double)table.result.integrator.steps, 1.25 * (double)formula.result.integrator.steps);
  // The rows cut corners of 1.6e-4 of the amplitude at most (Δ²ω²/8 of it, and as much in the integral).
  ck_assert_near(momentum_of(&table), momentum_of(&formula), 1e-3 * 10 / (4 * M_PI));
  scene_close(&formula), scene_close(&table);
}
END_TEST

static double pressed_by_tap(bool may_rest, const char *const *overrides) {
  SceneRun run;
  scene_open(&run, "tapped", overrides);
  run.scene.contact.rest_is_on = may_rest;
  scene_run_from(&run, NULL);
  ck_assert_ok(run.status);
  if (may_rest) ck_assert_double_ge(record_find_number(run.result.counters, "bodies_awakened"), 1);
  ck_assert_double_le(scene_gain(&run), 1e-3); // docs/stability.md
  double most = run.result.contact.force_max;
  scene_close(&run);
  return most;
}

// The ball is there for 3.4 ms, with steps of up to 1 s before.
START_TEST(a_tap_is_felt_awake_and_asleep) {
  double expected = pressed_by_tap(false, (const char *[]){"time.max_step=2e-4", "time.end=6.3", NULL});
  ck_assert_double_ge(expected, 60); // three times what it presses with in its first drop
  ck_assert_near(pressed_by_tap(true, NULL), expected, 0.05 * expected);
  ck_assert_near(pressed_by_tap(false, NULL), expected, 0.05 * expected);
}
END_TEST

// Bent beyond yield between two frames and let go: what stays is that of many small steps of load.
START_TEST(steps_of_load_end_at_the_peak_of_a_static_load) {
  double bend[2];
  const char *const frames[] = {"output.frames=1", "output.frames=20"};
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    scene_run(&run, "../../examples/25_plastic_bar",
              (const char *[]){frames[k], "time.max_step=null", "output.vtu=false", NULL});
    int tip = run.model.vertex_count - 1;
    bend[k] =
        scene_position(&run, run.result.trajectory.frame_count - 1, tip)[2] - run.model.rest[3 * tip + 2];
    scene_close(&run);
  }
  ck_assert_double_lt(bend[1], -1e-3);
  ck_assert_near(bend[0], bend[1], 0.05 * fabs(bend[1]));
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("knots");
  tcase_add_test(test_case, a_table_is_constant_outside_and_straight_between_its_rows);
  tcase_add_test(test_case, a_step_ends_at_the_knots_of_a_pulse);
  tcase_add_test(test_case, a_step_passes_what_lies_within_the_tolerance);
  tcase_add_test(test_case, rows_that_follow_a_smooth_curve_do_not_end_steps);
  tcase_add_test(test_case, an_end_of_motion_is_a_knot_of_moving_and_of_turning);
  tcase_add_test(test_case, a_load_is_passed_by_the_velocity_that_it_would_give);
  tcase_add_test(test_case, a_formula_is_followed_to_its_kinks_and_where_it_bends);
  tcase_add_test(test_case, knots_closer_than_the_resolution_count_as_one);
  tcase_add_test(test_case, a_push_of_a_thousandth_of_a_step_gives_its_impulse);
  tcase_add_test(test_case, a_formula_that_jumps_gives_its_impulse);
  tcase_add_test(test_case, knots_at_the_beginning_and_at_the_end_are_kept);
  tcase_add_test(test_case, a_load_that_rises_within_rounding_is_a_jump);
  tcase_add_test(test_case, a_smooth_table_of_a_thousand_rows_costs_no_more_than_its_formula);
  tcase_add_test(test_case, a_tap_is_felt_awake_and_asleep);
  tcase_add_test(test_case, steps_of_load_end_at_the_peak_of_a_static_load);
  return suite_run("knots", test_case, 60);
}

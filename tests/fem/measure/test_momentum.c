// SPDX-License-Identifier: GPL-3.0-or-later
// Momentum's balance: the forces that are written are those that moved the bodies.
#include "scene.h"

#include <string.h>

#include "fem/measure/momentum.h"

typedef struct Falling {
  SceneRun run;
  FemSystem system;
  FemState state;
  FemMomentum momentum;
  double *u, *v;
} Falling;

static const FemMomentumContact nothing = {0};

// A block that falls freely, at t = 0.
static void open_falling(Falling *falling) {
  scene_open(&falling->run, "free_fall", NULL);
  const FemModel *model = &falling->run.model;
  falling->u = calloc((size_t)model->free_count, sizeof(double));
  falling->v = calloc((size_t)model->free_count, sizeof(double));
  memcpy(falling->v, model->initial_velocity, (size_t)model->free_count * sizeof(double)); // nothing is fixed
  ck_assert_ok(fem_system_create(&falling->system, model));
  ck_assert_ok(fem_system_create_state(&falling->system, &falling->state));
  ck_assert_ok(fem_momentum_create(&falling->momentum, &falling->system));
  fem_system_scatter(&falling->system, 0, falling->u, falling->v, &falling->state);
  ck_assert_ok(fem_momentum_begin(&falling->momentum, &falling->state, &nothing));
}

// After 0.1 s at another speed downwards.
static void step(Falling *falling, double faster) {
  for (int i = 2; i < falling->run.model.free_count; i += 3) falling->v[i] -= faster;
  fem_system_scatter(&falling->system, 0.1, falling->u, falling->v, &falling->state);
  ck_assert_ok(fem_momentum_end(&falling->momentum, &falling->state, &nothing));
}

static void close_falling(Falling *falling) {
  fem_momentum_destroy(&falling->momentum);
  fem_state_destroy(&falling->state);
  fem_system_destroy(&falling->system);
  free(falling->u);
  free(falling->v);
  scene_close(&falling->run);
}

START_TEST(a_body_that_falls_as_gravity_wants_is_balanced) {
  Falling falling;
  int body = -1;
  open_falling(&falling);
  step(&falling, 0.981);
  ck_assert_near(fem_momentum_gap(&falling.momentum, 0.1, 0), 0, 1e-14);
  ck_assert_near(fem_momentum_largest_gap(&falling.momentum, 0.1, &body), 0, 1e-14);
  ck_assert_int_eq(body, 0);
  close_falling(&falling);
}
END_TEST

START_TEST(a_body_that_does_not_is_not) {
  Falling falling;
  double missing[3];
  open_falling(&falling);
  step(&falling, 0.5 * 0.981);
  fem_momentum_missing(&falling.momentum, 0.1, 0, missing);
  double weight = 9.81 * falling.run.model.bodies[0].mass;
  ck_assert_near(missing[2], -0.05 * weight, 1e-12 * weight);
  ck_assert_near(fem_momentum_gap(&falling.momentum, 0.1, 0), 0.5, 1e-12);
  close_falling(&falling);
}
END_TEST

START_TEST(a_gap_that_is_no_number_is_the_largest) {
  Falling falling;
  int body = -1;
  open_falling(&falling);
  step(&falling, 0.981);
  falling.momentum.next[0].impulse[1] = NAN;
  ck_assert(isnan(fem_momentum_largest_gap(&falling.momentum, 0.1, &body)));
  ck_assert_int_eq(body, 0);
  close_falling(&falling);
}
END_TEST

START_TEST(a_step_that_is_taken_back_leaves_no_trace) {
  Falling falling;
  open_falling(&falling);
  step(&falling, 0.5 * 0.981);
  step(&falling, 0.5 * 0.981); // the step anew, from the same beginning
  ck_assert_near(fem_momentum_gap(&falling.momentum, 0.1, 0), 0, 1e-14);
  fem_momentum_accept(&falling.momentum);
  double kept[FEM_MOMENTUM_KEPT], again[FEM_MOMENTUM_KEPT];
  fem_momentum_save(&falling.momentum, kept);
  ck_assert_near(kept[2], -0.981 * falling.run.model.bodies[0].mass, 1e-10);
  fem_momentum_load(&falling.momentum, kept);
  fem_momentum_save(&falling.momentum, again);
  for (int k = 0; k < FEM_MOMENTUM_KEPT; k++) ck_assert(kept[k] == again[k]);
  const double wrong[] = {1, -1, 0.5, NAN};
  ck_assert(fem_momentum_fits(&falling.momentum, kept));
  for (int k = 0; k < 4; k++) {
    kept[FEM_MOMENTUM_KEPT - 1] = wrong[k]; // the group of the only body
    ck_assert(!fem_momentum_fits(&falling.momentum, kept));
  }
  close_falling(&falling);
}
END_TEST

START_TEST(what_a_row_within_a_step_tells_lies_between_its_ends) {
  Falling falling;
  double missing[3];
  open_falling(&falling);
  step(&falling, 0.5 * 0.981);
  double weight = 9.81 * falling.run.model.bodies[0].mass;
  fem_momentum_missing(&falling.momentum, 0.025, 0, missing);
  ck_assert_near(missing[2], -0.0125 * weight, 1e-12 * weight);
  fem_momentum_missing(&falling.momentum, 0, 0, missing);
  ck_assert_near(missing[2], 0, 1e-12 * weight);
  fem_momentum_accept(&falling.momentum);
  fem_momentum_missing(&falling.momentum, 0.1, 0, missing);
  ck_assert_near(missing[2], -0.05 * weight, 1e-12 * weight);
  close_falling(&falling);
}
END_TEST

// Until t = 0.1 s all impulses are 0.1 s of weight, and the momentum that is reached 0.0981 m/s · mass.
START_TEST(a_step_too_long_for_its_forces_is_refused) {
  Falling falling;
  open_falling(&falling);
  step(&falling, 0.981);
  ck_assert(!fem_momentum_is_refused(&falling.momentum, 0.1));
  step(&falling, -2e-3 * 0.981);
  ck_assert(fem_momentum_is_refused(&falling.momentum, 0.1));
  ck_assert(!fem_momentum_is_refused(&falling.momentum, 1)); // a third of what a second allows
  fem_momentum_accept(&falling.momentum);                    // a step that adds nothing is not to blame
  ck_assert_ok(fem_momentum_end(&falling.momentum, &falling.state, &nothing));
  ck_assert(!fem_momentum_is_refused(&falling.momentum, 0.1));
  close_falling(&falling);
}
END_TEST

// The step to 0.1 s, after one that leaves `before` of all impulses missing, when `after` are; without
// gravity's weight in between there is nothing that a method of order 1 would recover.
static bool is_refused(double before, double after) {
  Falling falling;
  open_falling(&falling);
  step(&falling, (1 - after) * 0.981);
  FemMomentumBody *now = &falling.momentum.now[0], *next = &falling.momentum.next[0];
  for (int c = 0; c < 3; c++) now->p[c] = 0; // at rest at first: all impulses are the weight's
  now->impulse[2] = -before * next->size;
  now->change[2] = 0;
  next->force[2] = -9.81 * falling.run.model.bodies[0].mass;
  next->impulse[2] = -next->size;
  next->change[2] = -(1 - after) * next->size;
  bool answer = fem_momentum_is_refused(&falling.momentum, 0.1);
  close_falling(&falling);
  return answer;
}

// A step may leave 6e-4 of all impulses missing, or add a hundredth of the promise, or half of what is left
// to 9e-4.
START_TEST(at_the_edges_of_what_may_be_missing_a_step_just_stands) {
  static const double LESS = 1 - 1e-6, MORE = 1 + 1e-6;
  ck_assert(!is_refused(0, LESS * 6e-4));
  ck_assert(is_refused(0, MORE * 6e-4));
  ck_assert(!is_refused(7e-4, 7e-4 + LESS * 1e-4));
  ck_assert(is_refused(7e-4, 7e-4 + MORE * 1e-4));
  ck_assert(!is_refused(9e-4, 9e-4 + LESS * 1e-5));
  ck_assert(is_refused(9e-4, 9e-4 + MORE * 1e-5));
}
END_TEST

// Where a force rises in the step a method of order 1 lacks half of the rise times the step, which it
// recovers as the force falls; up to 1e-4 of all impulses are not counted.
START_TEST(what_order_1_recovers_is_not_counted_up_to_its_limit) {
  Falling falling;
  open_falling(&falling);
  step(&falling, 0.981);
  FemMomentumBody *now = &falling.momentum.now[0], *next = &falling.momentum.next[0];
  for (int c = 0; c < 3; c++) now->p[c] = 0;
  next->impulse[2] = -next->size;
  next->force[2] = -9.81 * falling.run.model.bodies[0].mass + 10 * next->size; // beyond its weight, upwards
  for (int is_more = 0; is_more < 2; is_more++) {
    next->change[2] = next->impulse[2] + (6e-4 + 1e-4) * (is_more ? 1 + 1e-6 : 1 - 1e-6) * next->size;
    ck_assert_int_eq(fem_momentum_is_refused(&falling.momentum, 0.1), is_more);
  }
  close_falling(&falling);
}
END_TEST

// From 5e-4 of all impulses on, and all the more the farther out the balance is, while anything but gravity
// acts; a step that is only looked at changes nothing.
START_TEST(velocities_are_held_the_closer_the_more_is_missing) {
  static const double MISSING[] = {0, 4e-4, 7e-4, 1e-3}, STRICTNESS[] = {1, 1, 0.6, 0.2};
  for (int i = 0; i < 4; i++) {
    Falling falling;
    open_falling(&falling);
    memset(falling.v, 0, (size_t)falling.run.model.free_count * sizeof *falling.v);
    fem_system_scatter(&falling.system, 0, falling.u, falling.v, &falling.state);
    ck_assert_ok(fem_momentum_begin(&falling.momentum, &falling.state, &nothing));
    step(&falling, (1 - MISSING[i]) * 0.981);
    ck_assert_double_eq(fem_momentum_strictness(&falling.momentum, 0.1), 1);
    fem_momentum_accept(&falling.momentum);
    ck_assert_double_eq(fem_momentum_strictness(&falling.momentum, 0.1), 1);
    falling.momentum.now[0].sum *= 1 + 1e-6; // as if something touched it
    ck_assert_near(fem_momentum_strictness(&falling.momentum, 0.1), STRICTNESS[i], 1e-9);
    ck_assert_double_eq(fem_momentum_strictness(&falling.momentum, 1), 1); // the same is less of a second's
    close_falling(&falling);
  }
}
END_TEST

static void expect_balance(const char *scene, const char *const *overrides, bool has_contact) {
  SceneRun run;
  scene_run(&run, scene, overrides);
  ck_assert_msg(run.result.momentum.gap <= 1e-3, "%s: %g", scene, run.result.momentum.gap);
  ck_assert_double_gt(run.result.momentum.gap, 0);
  ck_assert_int_eq(run.result.contact.force_max > 0, has_contact);
  scene_close(&run);
}

START_TEST(contact_reactions_and_loads_are_balanced) {
  expect_balance("drop", (const char *const[]){"time.end=0.15", NULL}, true);
  expect_balance("cantilever", (const char *const[]){"time.end=0.1", NULL}, false);
  expect_balance("rest_load", NULL, true); // sleeps and is pushed
}
END_TEST

// A stack lands on itself and on the ground, with friction, and steps that are too long for that are taken
// back: or else 8e-3 would be missing here. What a ball that is still in the air may yet transfer is no
// excuse.
START_TEST(a_stack_that_lands_is_balanced) {
  SceneRun run;
  scene_run(&run, "../../examples/15_sleepers",
            (const char *const[]){"time.end=0.07", "output.vtu=false", NULL});
  ck_assert_int_gt(run.result.retries.momentum, 0);
  ck_assert_msg(run.result.momentum.gap <= 1e-3, "%g", run.result.momentum.gap);
  ck_assert_double_gt(run.result.contact.force_max, 0);
  scene_close(&run);
}
END_TEST

// With tolerances and impulses of the fast body 7.5e-3 is missing of the cube's.
START_TEST(a_body_that_flies_past_does_not_loosen_what_others_are_held_to) {
  expect_balance("flyer", NULL, true);
}
END_TEST

// Friction leaves most of what is along the plane. Where all of it counted 3.2e-3 was missing of the
// impulses.
START_TEST(a_body_that_skids_is_held_to_what_acts_on_it) {
  expect_balance("drop",
                 (const char *const[]){"bodies.block.place.translate=[0, 0, 0.001]",
                                       "bodies.block.velocity=[6, 0, -1]", "contact.friction=0.1",
                                       "effects.gravity=[0, 0, 0]", "time.end=0.04", NULL},
                 true);
}
END_TEST

static long long nodal_steps(const char *velocity) {
  SceneRun run;
  scene_run(&run, "flyer",
            (const char *const[]){"contact.potential=nodal", "contact.stiffness=1e6", velocity, NULL});
  long long steps = run.result.integrator.steps;
  ck_assert_double_gt(run.result.contact.force_max, 0);
  scene_close(&run);
  return steps;
}

// Where no bound holds forces to the motion the tolerance does: 48 steps for 81 where all speeds counted.
START_TEST(nor_does_it_with_the_nodal_potential) {
  long long beside = nodal_steps("bodies.flyer.velocity=[60, 0, 0]"),
            at_rest = nodal_steps("bodies.flyer.velocity=[0, 0, 0]");
  ck_assert_msg(beside > 0.8 * (double)at_rest, "%lld steps, %lld beside one at rest", beside, at_rest);
}
END_TEST

// The first steps are of order 1, and then no more: what they lacked of the motion was not taken back
// (3.9e-3).
START_TEST(edges_that_meet_crosswise_are_balanced) {
  expect_balance("edges", NULL, true);
}
END_TEST

// Friction restarts the method 21 times, and each first step lacks a little: 1.3e-3 where each may add that.
START_TEST(edges_of_steel_that_rub_are_balanced) {
  expect_balance("edges",
                 (const char *const[]){"bodies.lower.material.young=2e11",
                                       "bodies.lower.material.density=7800",
                                       "bodies.upper.material.young=2e11",
                                       "bodies.upper.material.density=7800", "contact.friction=0.3", NULL},
                 true);
}
END_TEST

// No step lacks much here, but what they lack adds up: 1.2e-3 with one tolerance throughout.
START_TEST(a_ball_that_rolls_on_is_balanced) {
  expect_balance("bowl", NULL, true);
}
END_TEST

// Until the block bears something it is its obstacle's speed that says how much is little: 27 steps are taken
// back without.
START_TEST(what_an_obstacle_begins_to_press_is_balanced_without_ado) {
  SceneRun run;
  scene_run(&run, "indent", NULL);
  ck_assert_int_le(run.result.retries.momentum, 5);
  ck_assert_msg(run.result.momentum.gap <= 1e-3, "%g", run.result.momentum.gap);
  ck_assert_double_gt(run.result.contact.force_max, 0);
  scene_close(&run);
}
END_TEST

START_TEST(viscous_contact_is_part_of_what_is_written) {
  expect_balance(
      "bounce", (const char *const[]){"time.end=0.2", "contact.stiffness=1e7", "contact.viscosity=3e4", NULL},
      true);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("momentum");
  tcase_add_test(cases, a_body_that_falls_as_gravity_wants_is_balanced);
  tcase_add_test(cases, a_body_that_does_not_is_not);
  tcase_add_test(cases, a_gap_that_is_no_number_is_the_largest);
  tcase_add_test(cases, a_step_that_is_taken_back_leaves_no_trace);
  tcase_add_test(cases, contact_reactions_and_loads_are_balanced);
  tcase_add_test(cases, what_a_row_within_a_step_tells_lies_between_its_ends);
  tcase_add_test(cases, a_step_too_long_for_its_forces_is_refused);
  tcase_add_test(cases, at_the_edges_of_what_may_be_missing_a_step_just_stands);
  tcase_add_test(cases, what_order_1_recovers_is_not_counted_up_to_its_limit);
  tcase_add_test(cases, velocities_are_held_the_closer_the_more_is_missing);
  tcase_add_test(cases, a_stack_that_lands_is_balanced);
  tcase_add_test(cases, a_body_that_flies_past_does_not_loosen_what_others_are_held_to);
  tcase_add_test(cases, a_body_that_skids_is_held_to_what_acts_on_it);
  tcase_add_test(cases, nor_does_it_with_the_nodal_potential);
  tcase_add_test(cases, edges_that_meet_crosswise_are_balanced);
  tcase_add_test(cases, edges_of_steel_that_rub_are_balanced);
  tcase_add_test(cases, a_ball_that_rolls_on_is_balanced);
  tcase_add_test(cases, what_an_obstacle_begins_to_press_is_balanced_without_ado);
  tcase_add_test(cases, viscous_contact_is_part_of_what_is_written);
  return suite_run("momentum", cases, 60);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// fem/time/integrator.h when forces are refused, jump or have no matrix to go by: a smaller step, or an end
// with its reason.
#include "toy.h"

// x = cos 10 t. As with contact lists, trial positions beyond a margin about the last accepted one are
// refused; without it the steps are longer.
START_TEST(a_refused_evaluation_changes_nothing_but_the_step) {
  const double margins[2] = {0, 0.01};
  long long steps[2];
  for (int k = 0; k < 2; k++) {
    Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 100, .margin = margins[k], .accepted = 1};
    toy_open(&toy);
    double u = 1, v = 0, time = 0;
    FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-5, 1), &u, &v);
    while (time < 1) {
      const double *u_now, *v_now;
      toy_accept(&toy, time, &u, &v);
      ck_assert_ok(fem_integrator_step(integrator, &time));
      ck_assert_ok(fem_integrator_at(integrator, time, &u_now, &v_now));
      u = u_now[0], v = v_now[0];
      ck_assert_near(u, cos(10 * time), 5e-3);
    }
    FemIntegratorStats stats = fem_integrator_stats(integrator);
    steps[k] = stats.steps;
    ck_assert((toy.retries > 10) == (k == 1));
    ck_assert(stats.newton_failures >= toy.retries);
    fem_integrator_destroy(integrator);
    toy_close(&toy);
  }
  ck_assert(steps[1] > steps[0]);
}
END_TEST

START_TEST(a_force_that_keeps_refusing_ends_the_run_with_its_reason) {
  Toy toy = {.count = 3, .mass = 1, .link_stiffness = 10, .broken_after = 0.5, .failure = STATUS_RETRY};
  toy_open(&toy);
  double u[3] = {0.1, 0, 0}, v[3] = {0}, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-6, 1), u, v);
  Status status;
  int steps = 0;
  while ((status = fem_integrator_step(integrator, &time)) == STATUS_OK) ck_assert_int_lt(++steps, 10000);
  ck_assert_int_eq(status, STATUS_SOLVER);
  ck_assert(time > 0.45 && time <= 0.5);
  ck_assert_ptr_nonnull(strstr(status_message(), "the force broke"));
  ck_assert_ptr_nonnull(strstr(status_message(), "of body 'chain'"));
  ck_assert_ptr_nonnull(strstr(status_message(), "max_step"));
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

// Where a value has no digits left for the tolerance, it is named, and is larger than that of the others.
START_TEST(an_absurd_value_is_named) {
  Toy toy = {.count = 3, .mass = 1, .link_stiffness = 10};
  toy_open(&toy);
  double u[3] = {0}, v[3] = {1, 1e30, 1}, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-6, 1), u, v);
  ck_assert_int_eq(fem_integrator_step(integrator, &time), STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), "velocity (1e+30 m/s) of vertex 1 of body 'chain'"), "%s",
                status_message());
  ck_assert_ptr_nonnull(strstr(status_message(), "Try a smaller value"));
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

START_TEST(a_fatal_force_comes_out_as_it_is) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 10, .broken_after = 0.5, .failure = STATUS_IO};
  toy_open(&toy);
  double u = 0.1, v = 0, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-6, 1), &u, &v);
  Status status;
  while ((status = fem_integrator_step(integrator, &time)) == STATUS_OK) ck_assert(time <= 0.5);
  ck_assert_int_eq(status, STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), "the force broke"));
  ck_assert_int_eq(fem_integrator_step(integrator, &time), STATUS_SOLVER); // and stays so
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

// A constant force towards x = 0 from both sides: no solution near x = 0 but rattling.
START_TEST(a_jump_of_the_force_never_hangs) {
  Toy toy = {.count = 1, .mass = 1, .friction = 1e3, .damper = 1};
  toy_open(&toy);
  double u = 0.1, v = 0, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-6, 10), &u, &v);
  Status status = STATUS_OK;
  long long steps = 0;
  while (time < 10 && (status = fem_integrator_step(integrator, &time)) == STATUS_OK)
    ck_assert_int_lt((int)++steps, 1000000);
  if (status != STATUS_OK) {
    ck_assert_int_eq(status, STATUS_SOLVER);
    ck_assert_ptr_nonnull(strstr(status_message(), "Worst: "));
    ck_assert_ptr_nonnull(strstr(status_message(), "Try "));
  }
  ck_assert(time > 0.01); // it got as far as the jump
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

START_TEST(a_run_that_crawls_is_given_up) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 1e20}; // 10⁹ radians in the run
  toy_open(&toy);
  double u = 1, v = 0, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-9, 1), &u, &v);
  Status status;
  long long steps = 0;
  while ((status = fem_integrator_step(integrator, &time)) == STATUS_OK) ck_assert_int_lt((int)++steps, 3000);
  ck_assert_int_eq(status, STATUS_SOLVER);
  ck_assert(time < 1e-5);
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

// Whoever takes every other step back makes no way, however long the steps are.
START_TEST(a_run_whose_steps_are_taken_back_is_given_up) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 10};
  toy_open(&toy);
  double u = 1, v = 0, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-4, 1), &u, &v);
  Status status;
  long long steps = 0;
  while ((status = fem_integrator_step(integrator, &time)) == STATUS_OK) {
    ck_assert_int_lt((int)++steps, 3000);
    ck_assert_ok(fem_integrator_restart(integrator, 0, &u, &v, 0));
  }
  ck_assert_int_eq(status, STATUS_SOLVER);
  ck_assert_ptr_nonnull(strstr(status_message(), "stalls"));
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

// Checkpoints and stages begin a new integrator long before a window of the stall is over.
START_TEST(a_crawl_through_many_integrators_is_given_up) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 1e8};
  toy_open(&toy);
  FemStall stall = fem_stall_begin(0.5, 1, 1);
  FemIntegratorDef def = def_of(1e-9, 1);
  def.stall = &stall;
  double u = 1, v = 0, time = 0.5;
  Status status = STATUS_OK;
  for (int part = 0; part < 20 && status == STATUS_OK; part++) {
    FemIntegrator *integrator;
    ck_assert_ok(fem_integrator_create(&integrator, &toy.system, &toy.state, &fem_solver_cholmod, &def));
    ck_assert_ok(fem_integrator_restart(integrator, time, &u, &v, 0));
    for (int k = 0; k < 300 && status == STATUS_OK; k++) status = fem_integrator_step(integrator, &time);
    const double *u_now, *v_now;
    ck_assert_ok(fem_integrator_at(integrator, time, &u_now, &v_now));
    u = *u_now, v = *v_now;
    fem_integrator_destroy(integrator);
  }
  ck_assert_int_eq(status, STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), "stalls") != NULL, "%s", status_message());
  ck_assert(time < 0.6);
  toy_close(&toy);
}
END_TEST

// ẍ = 10⁴ x: S = −10⁴ + c² is positive definite only for steps shorter than a hundredth.
START_TEST(a_matrix_that_is_not_positive_definite_shortens_the_step) {
  for (int s = 0; s < KIND_COUNT; s += 2) { // the condensed solvers
    Toy toy = {.count = 1, .mass = 1, .wall_stiffness = -1e4};
    toy_open(&toy);
    FemIntegratorDef def = def_of(1e-8, 0.06);
    def.initial_step = def.max_step = 0.03;
    double u = 1e-6, v = 1e-4;
    FemIntegrator *integrator = start(&toy, KINDS[s], def, &u, &v);
    finish(integrator, 0.06, 1, &u, &v);
    ck_assert_int_gt((int)fem_integrator_solver_stats(integrator)->failed_factorisations, 0);
    ck_assert_int_gt((int)fem_integrator_stats(integrator).newton_failures, 0);
    ck_assert_near(u, 1e-6 * exp(6), 2e-5);
    fem_integrator_destroy(integrator);
    toy_close(&toy);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("integrator failures");
  tcase_add_test(cases, a_refused_evaluation_changes_nothing_but_the_step);
  tcase_add_test(cases, a_force_that_keeps_refusing_ends_the_run_with_its_reason);
  tcase_add_test(cases, an_absurd_value_is_named);
  tcase_add_test(cases, a_fatal_force_comes_out_as_it_is);
  tcase_add_test(cases, a_jump_of_the_force_never_hangs);
  tcase_add_test(cases, a_run_that_crawls_is_given_up);
  tcase_add_test(cases, a_run_whose_steps_are_taken_back_is_given_up);
  tcase_add_test(cases, a_crawl_through_many_integrators_is_given_up);
  tcase_add_test(cases, a_matrix_that_is_not_positive_definite_shortens_the_step);
  return suite_run("integrator failures", cases, 60);
}

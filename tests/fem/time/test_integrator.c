// SPDX-License-Identifier: GPL-3.0-or-later
// fem/time/integrator.h: orders, states between steps, restarts, on systems with closed forms.
#include "toy.h"

START_TEST(free_fall_is_exact_but_for_the_first_steps) {
  Toy toy = {.count = 1, .mass = 2, .gravity = -9.81};
  toy_open(&toy);
  double u = 3, v = 4;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-7, 2), &u, &v);
  finish(integrator, 2, 1, &u, &v);
  ck_assert_near(u, 3 + 4 * 2 - 0.5 * 9.81 * 4, 5e-7);
  ck_assert_near(v, 4 - 9.81 * 2, 1e-9);
  FemIntegratorStats stats = fem_integrator_stats(integrator);
  ck_assert_int_lt((int)stats.steps, 60); // at order 2 nothing limits the step but max_step
  ck_assert_int_eq(stats.last_order, 2);
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

START_TEST(the_shortest_step_is_what_times_are_resolved_to_or_what_is_asked) {
  for (int i = 0; i < 2; i++) {
    Toy toy = {.count = 1, .mass = 2, .gravity = -9.81};
    toy_open(&toy);
    FemIntegratorDef def = def_of(1e-7, 2);
    def.min_step = i == 0 ? 0 : 1e-6;
    double u = 3, v = 4;
    FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def, &u, &v);
    ck_assert_near(fem_integrator_shortest_step(integrator), i == 0 ? 2e-12 : 1e-6, 1e-24);
    fem_integrator_destroy(integrator);
    toy_close(&toy);
  }
}
END_TEST

// The state changes by half of the tolerance in 1e-8 s, which is what IDA would begin with; what is left to
// it is lengthened, what it would make longer is not.
START_TEST(a_start_is_not_shorter_than_asked) {
  static const double LEAST[] = {0, 1e-6, 1e-12};
  for (int i = 0; i < 3; i++) {
    Toy toy = {.count = 1, .mass = 2, .gravity = -9.81};
    toy_open(&toy);
    FemIntegratorDef def = def_of(1e-7, 2);
    def.least_start = LEAST[i];
    double u = 3, v = 4, time;
    FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def, &u, &v);
    ck_assert_ok(fem_integrator_step(integrator, &time));
    if (i == 1)
      ck_assert_near(time, 1e-6, 1e-18);
    else
      ck_assert_double_lt(time, 1e-7);
    fem_integrator_destroy(integrator);
    toy_close(&toy);
  }
}
END_TEST

// Error at t = 1 of x = cos(10 t) with steps that only max_step limits.
static double oscillator_error(int max_order, double step) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 100};
  toy_open(&toy);
  FemIntegratorDef def = def_of(1, 1); // loose: never refuses a step
  def.max_order = max_order;
  def.max_step = step;
  def.initial_step = max_order == 2 ? 0.01 * step : step;
  double u = 1, v = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def, &u, &v);
  finish(integrator, 1, 1, &u, &v);
  ck_assert_int_eq((int)fem_integrator_stats(integrator).error_test_failures, 0);
  fem_integrator_destroy(integrator);
  toy_close(&toy);
  return fabs(u - cos(10.0));
}

START_TEST(an_oscillator_converges_with_the_order_of_the_method) {
  double first = oscillator_error(1, 2e-4) / oscillator_error(1, 1e-4);
  double second = oscillator_error(2, 2e-3) / oscillator_error(2, 1e-3);
  ck_assert_near(first, 2, 0.1);
  ck_assert_near(second, 4, 0.4);
}
END_TEST

START_TEST(an_oscillator_never_gains_energy) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 100};
  toy_open(&toy);
  double u = 1, v = 0, time = 0, energy = 50;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-4, 10), &u, &v);
  while (time < 10) {
    const double *u_now, *v_now;
    ck_assert_ok(fem_integrator_step(integrator, &time));
    ck_assert_ok(fem_integrator_at(integrator, time, &u_now, &v_now));
    double now = 50 * u_now[0] * u_now[0] + 0.5 * v_now[0] * v_now[0];
    ck_assert_msg(now <= energy * (1 + 2e-5), "at t = %g the energy rose from %.9g to %.9g", time, energy,
                  now);
    energy = fmin(now, energy);
  }
  ck_assert(energy > 30); // and loses little
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

// Steps of one length leave a rest to the end: two equal ones take it.
START_TEST(no_step_to_the_end_is_short_because_little_is_left) {
  static const double LONGEST = 1e-2, LEFT[] = {1e-9, 1e-6, 1e-3, 5e-3, 9.99e-3};
  for (int i = 0; i < 5; i++) {
    Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 1};
    toy_open(&toy);
    double end = 20 * LONGEST + LEFT[i], u = 1, v = 0, time = 0, before = 0, last = 0;
    FemIntegratorDef def = def_of(1, end); // loose: never refuses a step
    def.max_step = def.initial_step = LONGEST;
    FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def, &u, &v);
    for (; time < end; before = time) {
      ck_assert_ok(fem_integrator_step(integrator, &time));
      last = time - before;
      ck_assert_double_ge(last, 0.499 * LONGEST);
      ck_assert_double_le(last, 1.001 * LONGEST);
    }
    ck_assert_int_eq((int)fem_integrator_stats(integrator).steps, 21);
    fem_integrator_destroy(integrator);
    toy_close(&toy);
  }
}
END_TEST

// m ẍ + d ẋ + k x = 0, x(0) = 1, ẋ(0) = 0, by every solver.
START_TEST(a_damped_oscillator_decays_as_it_should) {
  double m = 2, k = 200, d = 4, end = 1.5;
  double decay = d / (2 * m), omega = sqrt(k / m - decay * decay);
  double exact = exp(-decay * end) * (cos(omega * end) + decay / omega * sin(omega * end));
  double exact_v = -exp(-decay * end) * (k / m) / omega * sin(omega * end);
  for (int s = 0; s < KIND_COUNT; s++) {
    Toy toy = {.count = 1, .mass = m, .wall_stiffness = k, .damper = d};
    toy_open(&toy);
    double u = 1, v = 0;
    FemIntegrator *integrator = start(&toy, KINDS[s], def_of(1e-7, end), &u, &v);
    finish(integrator, end, 1, &u, &v);
    ck_assert_near(u, exact, 2e-4);
    ck_assert_near(v, exact_v, 2e-3);
    FemIntegratorStats stats = fem_integrator_stats(integrator);
    ck_assert(stats.setups * 5 < stats.newton_iterations); // a set-up serves many steps
    // Without one, K and D are factorised at another c.
    ck_assert(stats.setups <= fem_integrator_solver_stats(integrator)->factorisations);
    ck_assert_int_eq((int)fem_integrator_solver_stats(integrator)->analyses, 1);
    fem_integrator_destroy(integrator);
    toy_close(&toy);
  }
}
END_TEST

// Three masses between fixed ends: mode p has ω² = (2 k/m)(1 − cos(p π/4)) and shape sin(p π i/4).
START_TEST(a_chain_swings_in_its_modes) {
  const double pi = 3.14159265358979323846;
  for (int s = 0; s < KIND_COUNT; s++)
    for (int p = 1; p <= 3; p++) {
      Toy toy = {.count = 3, .mass = 0.5, .link_stiffness = 30};
      toy_open(&toy);
      double omega = sqrt(2 * 30 / 0.5 * (1 - cos(p * pi / 4))), u[3], v[3] = {0};
      for (int i = 0; i < 3; i++) u[i] = 0.01 * sin(p * pi * (i + 1) / 4);
      FemIntegrator *integrator = start(&toy, KINDS[s], def_of(1e-9, 1), u, v);
      finish(integrator, 1, 3, u, v);
      for (int i = 0; i < 3; i++) {
        double shape = 0.01 * sin(p * pi * (i + 1) / 4);
        ck_assert_near(u[i], shape * cos(omega), 3e-6 * omega);
        ck_assert_near(v[i], -shape * omega * sin(omega), 3e-6 * omega * omega);
      }
      fem_integrator_destroy(integrator);
      toy_close(&toy);
    }
}
END_TEST

START_TEST(interpolation_meets_the_steps_and_keeps_to_the_last_one) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 100};
  toy_open(&toy);
  const double *u_at, *v_at;
  double u = 1, v = 0, time = 0, before = 0, u_before = 1;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-6, 1), &u, &v);
  ck_assert_ok(fem_integrator_at(integrator, 0, &u_at, &v_at));
  ck_assert(u_at[0] == 1 && v_at[0] == 0);
  while (time < 1) {
    ck_assert_ok(fem_integrator_step(integrator, &time));
    ck_assert_ok(fem_integrator_at(integrator, time, &u_at, &v_at));
    u = u_at[0];
    ck_assert_near(u, cos(10 * time), 2e-3);
    ck_assert_ok(fem_integrator_at(integrator, 0.5 * (before + time), &u_at, &v_at));
    ck_assert_near(u_at[0], cos(5 * (before + time)), 2e-3);
    ck_assert_ok(fem_integrator_at(integrator, before, &u_at, &v_at));
    ck_assert_near(u_at[0], u_before, 1e-4);
    before = time, u_before = u;
  }
  ck_assert_int_eq(fem_integrator_at(integrator, 0.5, &u_at, &v_at), STATUS_SOLVER);
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

// Goes on to t = 0.7, then back to t = 0.3 with the integrator's own arrays as source.
START_TEST(a_restart_from_an_earlier_state_repeats_the_run) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 100};
  toy_open(&toy);
  double u = 1, v = 0, time = 0;
  FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-7, 1), &u, &v);
  while (time < 0.3) ck_assert_ok(fem_integrator_step(integrator, &time));
  const double *u_now, *v_now, kept_time = time;
  ck_assert_ok(fem_integrator_at(integrator, kept_time, &u_now, &v_now));
  double kept_u = u_now[0], kept_v = v_now[0];
  while (time < 0.7) ck_assert_ok(fem_integrator_step(integrator, &time));
  FemIntegratorStats before = fem_integrator_stats(integrator);
  ck_assert_ok(fem_integrator_restart(integrator, kept_time, &kept_u, &kept_v, 1e-5));
  ck_assert_near(fem_integrator_stats(integrator).current_step, 1e-5, 0);
  ck_assert_ok(fem_integrator_step(integrator, &time));
  ck_assert_near(time, kept_time + 1e-5, 1e-14);
  ck_assert_ok(fem_integrator_at(integrator, time, &u_now, &v_now));
  ck_assert_near(v_now[0], kept_v - 1e-5 * 100 * kept_u, 2e-7);            // h² |v̈| = 1e-10 · 1e3
  ck_assert_ok(fem_integrator_restart(integrator, time, u_now, v_now, 0)); // its own arrays
  finish(integrator, 1, 1, &u, &v);
  ck_assert_near(u, cos(10.0), 2e-4);
  FemIntegratorStats after = fem_integrator_stats(integrator);
  ck_assert_int_eq((int)after.restarts, 2);
  ck_assert(after.steps > before.steps && after.residuals > before.residuals);
  ck_assert(after.setups > before.setups);
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

// A ball falls from 1 m on a one-sided spring, whose stiffness jumps at touch: the error test alone meets it.
START_TEST(a_bouncing_ball_gains_no_energy) {
  for (double stiffness = 1e4; stiffness <= 1e8; stiffness *= 100) {
    Toy toy = {.count = 1, .mass = 1, .gravity = -9.81, .floor_stiffness = stiffness};
    toy_open(&toy);
    double u = 1, v = 0, time = 0, highest_energy = 0, lowest = 1, end = 2, first_touch = 0;
    int touches = 0, steps = 0;
    FemIntegrator *integrator = start(&toy, FEM_SOLVER_CHOLMOD, def_of(1e-5, end), &u, &v);
    while (time < end) {
      const double *u_now, *v_now;
      double before = u;
      ck_assert_ok(fem_integrator_step(integrator, &time));
      ck_assert_ok(fem_integrator_at(integrator, time, &u_now, &v_now));
      u = u_now[0], v = v_now[0];
      double spring = 0.5 * stiffness * fmin(u, 0) * fmin(u, 0);
      highest_energy = suite_larger(highest_energy, 0.5 * v * v + 9.81 * u + spring);
      lowest = fmin(lowest, u);
      ck_assert_int_lt(++steps, 20000);
      touches += before > 0 && u <= 0;
      if (touches == 1 && first_touch == 0) first_touch = time;
    }
    printf("k = %g: %d steps, gain %.2g\n", stiffness, steps, highest_energy / 9.81 - 1);
    ck_assert_near(first_touch, sqrt(2 / 9.81), 1e-3);
    ck_assert_int_eq(touches, 2); // the second about 2 √(2h/g) after the first
    ck_assert_near(lowest, -sqrt(2 * 9.81 / stiffness),
                   0.05 * sqrt(2 * 9.81 / stiffness) + 2 * 9.81 / stiffness);
    ck_assert_msg(highest_energy <= 9.81 * (1 + 1e-3), "gain %.3g at κ = %g", highest_energy / 9.81 - 1,
                  stiffness);
    fem_integrator_destroy(integrator);
    toy_close(&toy);
  }
}
END_TEST

START_TEST(what_makes_no_sense_is_refused) {
  Toy toy = {.count = 1, .mass = 1, .wall_stiffness = 1};
  toy_open(&toy);
  FemIntegratorDef good = def_of(1e-6, 1);
  FemIntegratorDef bad[6] = {good, good, good, good, good, good};
  bad[0].displacement_tolerance = 0;
  bad[1].velocity_tolerance = NAN;
  bad[2].end = -1;
  bad[3].max_step = 1e-3, bad[3].min_step = 1e-2;
  bad[4].max_order = 3;
  bad[5].initial_step = NAN;
  for (int k = 0; k < 6; k++) {
    FemIntegrator *integrator;
    ck_assert_int_eq(
        fem_integrator_create(&integrator, &toy.system, &toy.state, &fem_solver_cholmod, &bad[k]),
        STATUS_INPUT);
    ck_assert_ptr_null(integrator);
  }
  FemIntegrator *integrator;
  double u = NAN, v = 0;
  ck_assert_ok(fem_integrator_create(&integrator, &toy.system, &toy.state, &fem_solver_cholmod, &good));
  ck_assert_int_eq(fem_integrator_restart(integrator, 0, &u, &v, 0), STATUS_SOLVER);
  fem_integrator_destroy(integrator);
  toy_close(&toy);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("integrator");
  tcase_add_test(cases, free_fall_is_exact_but_for_the_first_steps);
  tcase_add_test(cases, the_shortest_step_is_what_times_are_resolved_to_or_what_is_asked);
  tcase_add_test(cases, a_start_is_not_shorter_than_asked);
  tcase_add_test(cases, an_oscillator_converges_with_the_order_of_the_method);
  tcase_add_test(cases, an_oscillator_never_gains_energy);
  tcase_add_test(cases, no_step_to_the_end_is_short_because_little_is_left);
  tcase_add_test(cases, a_damped_oscillator_decays_as_it_should);
  tcase_add_test(cases, a_chain_swings_in_its_modes);
  tcase_add_test(cases, interpolation_meets_the_steps_and_keeps_to_the_last_one);
  tcase_add_test(cases, a_restart_from_an_earlier_state_repeats_the_run);
  tcase_add_test(cases, a_bouncing_ball_gains_no_energy);
  tcase_add_test(cases, what_makes_no_sense_is_refused);
  return suite_run("integrator", cases, 60);
}

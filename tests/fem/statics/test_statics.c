// SPDX-License-Identifier: GPL-3.0-or-later
// Static scenes: equilibria against theory, half the unknowns of a motion, and what is said where there is no
// equilibrium.
#include "static_solve.h"

#include <stdio.h>

#include "fem/model/limits.h"
#include "fem/statics/statics.h"

static void run_text(SceneRun *run, const char *text) {
  scene_open_text(run, text);
  scene_run_from(run, NULL);
}

static void run_well(SceneRun *run, const char *text) {
  run_text(run, text);
  ck_assert_msg(run->status == STATUS_OK, "%s", status_message());
  ck_assert(run->result.equilibrium.residual <= run->result.equilibrium.residual_allowed);
}

static const char *const BEAM = "bodies:\n"
                                "  - name: beam\n"
                                "    mesh: {box: {size: [0.5, 0.1, 0.1], cells: [10, 2, 2]}}\n"
                                "    material: {law: linear, young: 3e6, poisson: 0.3, density: 1000}\n"
                                "    fixed: [{group: x_min}]\n"
                                "    loads: [{group: x_max, force: [0, 0, -5]}]\n"
                                "output: {frames: 1}\n";

START_TEST(a_static_scene_has_half_the_unknowns) {
  SceneRun still, moving;
  char text[1024];
  snprintf(text, sizeof text, "time: {end: 1e-3, static: true}\n%s", BEAM);
  run_well(&still, text);
  snprintf(text, sizeof text, "time: {end: 1e-3}\n%s", BEAM);
  run_text(&moving, text);
  ck_assert_int_eq(moving.status, STATUS_OK);
  ck_assert_int_eq(still.result.state_unknowns, still.model.free_count);
  ck_assert_int_eq(moving.result.state_unknowns, 2 * still.result.state_unknowns);
  scene_close(&still);
  scene_close(&moving);
}
END_TEST

START_TEST(a_linear_body_is_in_equilibrium_after_one_solve) {
  SceneRun run;
  char text[1024];
  snprintf(text, sizeof text, "time: {end: 1, static: true}\n%s", BEAM);
  run_well(&run, text);
  double *u = solve_linear_static(&run.model);
  for (int a = 0; a < run.model.vertex_count; a++)
    for (int c = 0; c < 3; c++)
      ck_assert_near(scene_position(&run, 1, a)[c] - run.model.rest[3 * a + c], u[3 * a + c], 1e-9);
  ck_assert_int_le(run.result.integrator.newton_iterations, 2);
  ck_assert_int_eq(run.result.equilibrium.relaxation_steps, 0);
  // The load is there from the start, where nothing balances it: what holds the beam until then lets go along
  // the step and takes half of F u, so that work and energy agree.
  const FemAudit *audit = &run.result.energy.audit;
  ck_assert(audit->work > 0);
  ck_assert_near(audit->total, audit->first, 1e-6 * audit->scale);
  ck_assert_near(audit->driven_work, -audit->work, 1e-6 * audit->scale);
  ck_assert_double_lt(audit->open, 1e-6 * audit->scale); // the work is known
  free(u);
  scene_close(&run);
}
END_TEST

// A block is pressed on the ground, and a load pulls at its foot until it slips. The force rises less with
// the way once it slips, so the trapezoidal rule gives too little work: that is open, not energy out of
// nothing.
START_TEST(what_a_load_does_where_slip_begins_is_open) {
  double open[2];
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    char text[1024];
    snprintf(text, sizeof text,
             "time: {end: 1, static: true}\n"
             "bodies:\n"
             "  - name: block\n"
             "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
             "    material: {law: linear, young: 1e6, poisson: 0, density: 1000}\n"
             "    fixed: [{group: z_max, components: [x, y]}]\n"
             "    driven: [{group: z_max, components: [z], formula: {z: -1e-4}}]\n"
             "    loads: [{group: z_min, force: [8, 0, 0], factor: t}]\n"
             "obstacles: [{name: ground, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
             "contact: {friction: 0.3}\n"
             "output: {frames: %d}\n",
             k == 0 ? 3 : 24);
    run_well(&run, text);
    const FemAudit *audit = &run.result.energy.audit;
    double rise = audit->total - audit->lowest;
    ck_assert_double_gt(audit->dissipated, 0.1 * audit->work); // it slips
    ck_assert(k == 1 || rise > FEM_ENERGY * audit->scale); // what the rule lacks is more than a gain may be
    ck_assert_double_gt(audit->open, rise);
    ck_assert_int_eq((int)run.result.trouble.of[FEM_TROUBLE_ENERGY].events, 0);
    open[k] = audit->open / audit->scale;
    scene_close(&run);
  }
  ck_assert_double_lt(open[1], 0.25 * open[0]);
}
END_TEST

// All that is left of its forces is rounding of coordinates of the size of 3 m.
// Five sixths of the end as a sum of sixths are less than that by rounding.
START_TEST(no_step_of_load_is_left_by_rounding) {
  SceneRun run;
  char text[1024];
  snprintf(text, sizeof text, "time: {end: 1, static: true}\n%s", BEAM);
  char *frames = strstr(text, "frames: 1");
  frames[strlen("frames: ")] = '6';
  run_well(&run, text);
  ck_assert_int_eq(run.result.integrator.steps, 6);
  scene_close(&run);
}
END_TEST

START_TEST(a_body_that_nothing_loads_is_in_equilibrium) {
  SceneRun run;
  run_well(&run, "time: {end: 1, static: true}\n"
                 "bodies:\n"
                 "  - name: block\n"
                 "    mesh: {box: {size: [0.13, 0.11, 0.07], cells: 4}}\n"
                 "    place: {rotate: {axis: [1, 2, 3], degrees: 37}, translate: [3, 1, 2]}\n"
                 "    material: {young: 1e6, poisson: 0.3, density: 1000}\n"
                 "    fixed: [{group: x_min}]\n"
                 "output: {frames: 20}\n");
  ck_assert_int_eq(run.result.equilibrium.halvings, 0);
  for (int i = 0; i < 3 * run.model.vertex_count; i++)
    ck_assert_near(scene_position(&run, 20, i / 3)[i % 3], run.model.rest[i], 1e-12);
  scene_close(&run);
}
END_TEST

// Rubber pulled to twice its length: P = 2 (c₁ + c₂/λ)(λ − 1/λ²) at ν → ½; the reaction is P A.
START_TEST(rubber_pulled_to_twice_its_length_pulls_back_as_theory_says) {
  SceneRun run;
  run_well(&run,
           "time: {end: 1, static: true}\n"
           "bodies:\n"
           "  - name: block\n"
           "    element: nodal\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
           "    material: {law: mooney_rivlin, mooney: 0.3, young: 3, poisson: 0.4999, density: 1}\n"
           "    fixed: [{group: x_min, components: [x]}, {group: y_min, components: [y]}, {group: z_min, "
           "components: [z]}]\n"
           "    driven: [{group: x_max, components: [x], formula: {x: 0.1*t}}]\n"
           "output: {frames: 20}\n");
  // The driven side's work is the stored energy, to the trapezoidal rule over 20 steps: 1/1200 of it.
  double expected =
      1e-3 * (0.35 * (4 + 2.0 / 2 - 3) + 0.15 * (2 * 2 + 0.25 - 3)); // c₁ (I₁ − 3) + c₂ (I₂ − 3)
  ck_assert_near(run.result.energy.audit.work, expected, 3e-3 * expected);
  ck_assert_near(run.result.energy.audit.total, 0, 3e-3 * expected);
  const double *corner = scene_position(&run, 20, run.model.vertex_count - 1);
  ck_assert_near(corner[1], 0.1 / sqrt(2), 1e-4 * 0.1);
  scene_close(&run);
}
END_TEST

// Nothing holds the block but the ground, 1 cm below: it sinks until the contact carries it, Σ F = m g.
START_TEST(a_block_comes_to_rest_on_the_ground) {
  SceneRun run;
  run_well(&run, "time: {end: 1, static: true}\n"
                 "effects: {gravity: [0, 0, -9.81]}\n"
                 "bodies:\n"
                 "  - name: block\n"
                 "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 3}}\n"
                 "    place: {translate: [0, 0, 0.01]}\n"
                 "    fixed: [{box: {min: [0, 0, 0], max: [0.1, 0.1, 1]}, components: [x, y]}]\n"
                 "    material: {young: 1e5, poisson: 0.3, density: 1000}\n"
                 "obstacles: [{name: ground, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
                 "contact: {}\n"
                 "output: {frames: 1}\n");
  ck_assert_int_gt(run.result.contact.pairs_max, 0);
  ck_assert_near(fabs(scene_force(&run, 1, 0)[2]), 9.81, 9.81e-6);
  scene_close(&run);
}
END_TEST

// Nothing holds the upper block before it touches the lower one: its matrix is singular to rounding, which
// not every solver finds. It goes down, not up, and a Newton iteration a decade of force or two does.
START_TEST(what_nothing_holds_yet_is_pressed_down_by_every_solver) {
  static const char *const linear[] = {"solver.linear=cholmod", "solver.linear=pcg", "solver.linear=amg",
                                       "solver.linear=gamg"};
  if (_i >= 2 && !fem_solver_has_multigrid()) return;
  const char *overrides[] = {linear[_i], NULL};
  SceneRun run;
  scene_run(&run, "patch", overrides);
  ck_assert_int_le(run.result.integrator.newton_iterations, 6);
  ck_assert_near(fabs(scene_force(&run, 1, 0)[2]), 10, 1e-4);
  scene_close(&run);
}
END_TEST

// Lamé, plane strain: u(a) = p a (1 + ν) ((1 − 2ν) a² + b²)/(E (b² − a²)). Small strain, 1e-3.
static double widening(const char *about, double nu) {
  char text[1024];
  snprintf(text, sizeof text,
           "time: {end: 1, static: true}\n"
           "bodies:\n"
           "  - name: pipe\n"
           "    %s\n"
           "    mesh: {file: " TETLAP_SOURCE_DIR "/meshes/vessel.geo}\n"
           "    material: {law: linear, young: 1e8, poisson: %g, density: 1000}\n"
           "    fixed: [{group: x_min, components: [x]}, {group: y_min, components: [y]}, {group: z_min, "
           "components: "
           "[z]}, {group: z_max, components: [z]}]\n"
           "    loads: [{group: inner, pressure: 1e5}]\n"
           "output: {frames: 1}\n",
           about, nu);
  SceneRun run;
  run_well(&run, text);
  double sum = 0, expected = 1e5 * 0.1 * (1 + nu) * ((1 - 2 * nu) * 0.01 + 0.04) / (1e8 * 0.03);
  int count = 0;
  for (int a = 0; a < run.model.vertex_count; a++) {
    const double *X = run.model.rest + 3 * a, *x = scene_position(&run, 1, a);
    if (fabs(hypot(X[0], X[1]) - 0.1) > 1e-9) continue;
    sum += hypot(x[0], x[1]) - hypot(X[0], X[1]);
    count++;
  }
  scene_close(&run);
  return sum / count / expected;
}

START_TEST(a_pressure_vessel_widens_as_lame_says) {
  double ordinary = widening("element: linear", 0.3), rubber = widening("element: nodal", 0.499);
  double locked = widening("element: linear", 0.499);
  printf("inner radius over Lame's: linear at 0.3 %.4f; at 0.499 nodal %.4f, linear %.4f\n", ordinary, rubber,
         locked);
  ck_assert_near(ordinary, 1, 0.03);
  ck_assert_near(rubber, 1, 0.03);
  ck_assert(locked < 0.97);
}
END_TEST

START_TEST(without_an_equilibrium_the_run_ends_and_says_why) {
  SceneRun run;
  run_text(&run, "time: {end: 1, static: true}\n"
                 "bodies:\n"
                 "  - name: block\n"
                 "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 1}}\n"
                 "    material: {young: 1e5, poisson: 0.3, density: 1000}\n"
                 "    loads: [{group: x_max, force: [1, 0, 0]}]\n"
                 "output: {frames: 1}\n");
  ck_assert_int_eq(run.status, STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), "no equilibrium at t") &&
                    strstr(status_message(), "of body 'block'") && strstr(status_message(), "smallest det F"),
                "%s", status_message());
  scene_close(&run);
}
END_TEST

// A moving obstacle's work is all stored: it adds up over the steps, by the trapezoidal rule.
START_TEST(the_work_of_an_obstacle_is_stored) {
  SceneRun run;
  run_well(&run,
           "time: {end: 1, static: true}\n"
           "bodies:\n"
           "  - name: block\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
           "    fixed: [{group: z_min}]\n"
           "    material: {young: 1e5, poisson: 0.3, density: 1000}\n"
           "obstacles:\n"
           "  - {name: plate, halfspace: {point: [0, 0, 0.1], normal: [0, 0, -1]}, motion: {velocity: [0, "
           "0, -0.002]}}\n"
           "contact: {stiffness: 1e6}\n"
           "output: {frames: 10}\n");
  double force = fabs(scene_force(&run, 10, 0)[2]), work = run.result.energy.audit.work;
  ck_assert_near(work, 0.5 * force * 0.002, 0.05 * work);
  ck_assert_near(run.result.energy.audit.total, 0, 5e-3 * work);
  scene_close(&run);
}
END_TEST

// A slender beam turns by far more than it strains; every step is a few full Newton steps, though the first
// of them raises |f| tenfold.
// Gravity grows until the first frame: whoever turns it up gives back what the body sinks.
START_TEST(turning_gravity_up_is_work) {
  SceneRun run;
  run_well(&run, "time: {end: 2, static: true}\n"
                 "effects: {gravity: [0, 0, -9.81]}\n"
                 "bodies:\n"
                 "  - name: beam\n"
                 "    mesh: {box: {size: [0.5, 0.1, 0.1], cells: [10, 2, 2]}}\n"
                 "    material: {law: linear, young: 3e6, poisson: 0.3, density: 1000}\n"
                 "    fixed: [{group: x_min}]\n"
                 "output: {frames: 2}\n");
  const FemAudit *audit = &run.result.energy.audit;
  ck_assert_double_gt(audit->scale, 1e-4);
  ck_assert_near(audit->total, audit->first, 1e-6 * audit->scale);
  // It stores what gravity did, F u / 2, and has lost F u of its own: half of it was taken.
  ck_assert_double_lt(audit->driven_work, -0.1 * audit->scale);
  scene_close(&run);
}
END_TEST

// The plate stops at once at t = 0.5: what it has done until then is by its speed until then.
START_TEST(an_obstacle_that_stops_has_worked_until_then) {
  SceneRun run;
  run_well(
      &run,
      "time: {end: 1, static: true}\n"
      "bodies:\n"
      "  - name: block\n"
      "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
      "    fixed: [{group: z_min}]\n"
      "    material: {young: 1e5, poisson: 0.3, density: 1000}\n"
      "obstacles:\n"
      "  - {name: plate, halfspace: {point: [0, 0, 0.1], normal: [0, 0, -1]}, motion: {table: [[0, 0, 0, "
      "0], [0.5, 0, 0, -0.002], [1, 0, 0, -0.002]]}}\n"
      "contact: {stiffness: 1e8}\n"
      "output: {frames: 10}\n");
  const FemAudit *audit = &run.result.energy.audit;
  double force = fabs(scene_force(&run, 10, 0)[2]);
  ck_assert_near(audit->work, 0.5 * force * 0.002, 0.05 * audit->work);
  ck_assert_near(audit->total, audit->first, 2e-2 * audit->work); // with the speed after, a fifth
  scene_close(&run);
}
END_TEST

START_TEST(a_beam_that_turns_far_takes_few_iterations) {
  SceneRun run;
  run_well(&run, "time: {end: 1, static: true}\n"
                 "bodies:\n"
                 "  - name: beam\n"
                 "    mesh: {box: {size: [0.5, 0.05, 0.05], cells: [20, 2, 2]}}\n"
                 "    material: {law: stvk, young: 1e8, poisson: 0.3, density: 1000}\n"
                 "    fixed: [{group: x_min}]\n"
                 "    loads: [{group: x_max, force: [0, 0, -120], factor: t}]\n"
                 "output: {frames: 10}\n");
  ck_assert_int_eq(run.result.equilibrium.relaxation_steps, 0);
  ck_assert_int_le(run.result.matrix.solver.factorisations, 60);
  ck_assert(scene_position(&run, 10, run.model.vertex_count - 1)[2] < 0.03);
  scene_close(&run);
}
END_TEST

static void refuse(const char *about_body, const char *about_scene, const char *expected) {
  char text[1024];
  FemSceneDef scene;
  snprintf(text, sizeof text,
           "time: {end: 1, static: true}\n%s"
           "bodies:\n"
           "  - name: block\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 1}}\n"
           "    material: {young: 1e5, poisson: 0.3, density: 1000}\n%s",
           about_scene, about_body);
  ck_assert_int_eq(scene_text_read("test.yaml", text, strlen(text), &scene), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), expected), "expected '%s' in: %s", expected, status_message());
}

START_TEST(what_only_a_motion_has_is_refused_with_its_place) {
  refuse("    velocity: [0, 0, 1]\n", "", "test.yaml:6:5: ");
  refuse("    velocity: [0, 0, 1]\n", "", "no initial 'velocity'");
  refuse("    fixed: [{group: x_min, release: 0.5}]\n", "", "test.yaml:6:28: ");
  refuse("    fixed: [{group: x_min}]\n    driven: [{group: x_max, velocity: [1, 0, 0], release: 0.5}]\n", "",
         "cannot release");
  refuse("    fixed: [{group: x_min}]\n", "solver: {linear: klu}\n", "test.yaml:2:18: ");
  refuse("    fixed: [{group: x_min}]\n", "solver: {linear: klu}\n", "cholmod, amg or pcg");
}
END_TEST

// A column of one quadratic element's width is pressed to `share` of its height between rollers.
static void press(SceneRun *run, const char *law, double share) {
  char text[1024];
  snprintf(text, sizeof text,
           "time: {end: 1, static: true}\n"
           "bodies:\n"
           "  - name: column\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
           "    element: quadratic\n"
           "    material: {law: %s, young: 1e6, poisson: 0.3, density: 1000}\n"
           "    fixed: [{group: x_min, components: [x]}, {group: y_min, components: [y]},\n"
           "            {group: z_min, components: [z]}]\n"
           "    driven: [{group: z_max, components: [z], formula: {z: '%g*t'}}]\n"
           "output: {frames: 4}\n",
           law, -0.1 * (1 - share));
  run_text(run, text);
}

// Uniaxial compression with free sides, σ = E ε: Ψ = ½ E ε², ε = ½ (λ² − 1), so a length λ bears
// ∂Ψ/∂λ = ½ E λ (λ² − 1), the largest at λ = 1/√3 = 0.577. To 40 % nothing upright is in equilibrium with
// less. The block of neo_hookean_log wrinkles at 0.4017 of its length, its matrix singular there, so it goes
// to 45 %.
START_TEST(an_equilibrium_that_is_inside_out_is_none) {
  SceneRun run;
  press(&run, "stvk", 0.4);
  ck_assert_int_eq(run.status, STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), "0.58 of a length") != NULL, "%s", status_message());
  ck_assert_msg(strstr(status_message(), "'column'") != NULL, "%s", status_message());
  ck_assert_double_gt(run.result.end_time, 0.5); // at a length of 0.7
  scene_close(&run);
  press(&run, "neo_hookean_log", 0.45);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  ck_assert_double_gt(run.result.min_det_F, 0);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("statics");
  tcase_add_test(test_case, a_static_scene_has_half_the_unknowns);
  tcase_add_test(test_case, a_linear_body_is_in_equilibrium_after_one_solve);
  tcase_add_test(test_case, what_a_load_does_where_slip_begins_is_open);
  tcase_add_test(test_case, no_step_of_load_is_left_by_rounding);
  tcase_add_test(test_case, a_body_that_nothing_loads_is_in_equilibrium);
  tcase_add_test(test_case, rubber_pulled_to_twice_its_length_pulls_back_as_theory_says);
  tcase_add_test(test_case, a_block_comes_to_rest_on_the_ground);
  tcase_add_loop_test(test_case, what_nothing_holds_yet_is_pressed_down_by_every_solver, 0, 4);
  tcase_add_test(test_case, the_work_of_an_obstacle_is_stored);
  tcase_add_test(test_case, turning_gravity_up_is_work);
  tcase_add_test(test_case, an_obstacle_that_stops_has_worked_until_then);
  tcase_add_test(test_case, a_beam_that_turns_far_takes_few_iterations);
  tcase_add_test(test_case, a_pressure_vessel_widens_as_lame_says);
  tcase_add_test(test_case, without_an_equilibrium_the_run_ends_and_says_why);
  tcase_add_test(test_case, an_equilibrium_that_is_inside_out_is_none);
  tcase_add_test(test_case, what_only_a_motion_has_is_refused_with_its_place);
  return suite_run("statics", test_case, 60);
}

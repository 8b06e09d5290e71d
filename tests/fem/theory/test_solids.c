// SPDX-License-Identifier: GPL-3.0-or-later
// Whole solids against theory: what a material does in a scene.
#include "static_solve.h"

#include <stdio.h>

#include "base/random.h"

// A block of 0.1 m pulled along x by a traction; its sides are free, three faces are planes of symmetry.
static void pull(SceneRun *run, const char *material, const char *load, const char *time,
                 const char *element) {
  char text[2048];
  snprintf(text, sizeof text,
           "time: %s\n"
           "bodies:\n"
           "  - name: block\n"
           "    element: %s\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
           "    material: %s\n"
           "    fixed: [{group: x_min, components: [x]}, {group: y_min, components: [y]}, {group: z_min, "
           "components: "
           "[z]}]\n"
           "    loads: [{group: x_max, %s}]\n"
           "output: {frames: 4}\n",
           time, element, material, load);
  scene_open_text(run, text);
  scene_run_from(run, NULL);
  ck_assert_msg(run->status == STATUS_OK, "%s", status_message());
}

// Strain along an axis of the corner that no symmetry holds.
static double strain(const SceneRun *run, int frame, int c) {
  const double *rest = run->model.rest;
  int corner = 0;
  while (rest[3 * corner] + rest[3 * corner + 1] + rest[3 * corner + 2] < 0.3 - 1e-9) corner++;
  return (scene_position(run, frame, corner)[c] - run->model.rest[3 * corner + c]) / 0.1;
}

// Kelvin–Voigt with η = τ μ, ζ = τ K: τ ε̇ + ε = σ/E, so ε = σ/E (1 − exp(−t/τ)). Inertia moves the start by
// the time of a wave, 3 ms of τ = 0.1 s at most; the strain is 1e-3, so finite strain changes 1e-3 of it.
START_TEST(a_kelvin_voigt_solid_creeps) {
  SceneRun run;
  double mu = 1e5 / 2.6, K = 1e5 / (3 * 0.4);
  char material[256];
  snprintf(material, sizeof material,
           "{young: 1e5, poisson: 0.3, density: 0.1, viscosity: %.9g, bulk_viscosity: %.9g}", 0.1 * mu,
           0.1 * K);
  pull(&run, material, "traction: [100, 0, 0]", "{end: 0.2, tolerance: 1e-7}", _i ? "quadratic" : "linear");
  for (int frame = 1; frame <= 4; frame++) {
    double t = run.result.trajectory.times[frame], expected = 1e-3 * (1 - exp(-t / 0.1));
    ck_assert_near(strain(&run, frame, 0), expected, 5e-3 * expected);
    ck_assert_near(strain(&run, frame, 1), -0.3 * expected, 5e-3 * expected);
  }
  // The load's work is stored and dissipated.
  double work = run.result.energy.audit.work, volume = 1e-3;
  ck_assert_near(work, volume * 100 * strain(&run, 4, 0), 1e-6 * work);
  ck_assert_near(run.result.energy.audit.total, 0, 5e-3 * work);
  ck_assert(run.result.energy.audit.dissipated > 0.3 * work);
  scene_close(&run);
}
END_TEST

// A beam that swings under its weight and a load.
static void swing(SceneRun *run, const char *law, const char *element, const char *damping) {
  char text[1024];
  snprintf(text, sizeof text,
           "time: {end: 0.128, tolerance: 1e-5}\n"
           "effects: {gravity: [0, 0, -1], damping: %s}\n"
           "bodies:\n"
           "  - name: beam\n"
           "    element: %s\n"
           "    mesh: {box: {size: [0.5, 0.1, 0.1], cells: [10, 2, 2]}}\n"
           "    material: {law: %s, young: 1e6, poisson: 0.45, density: 1000}\n"
           "    fixed: [{group: x_min}]\n"
           "    loads: [{group: x_max, traction: [0, 0, -10], factor: sin(40*t)}]\n"
           "output: {frames: 1, checkpoint: 0}\n", // each would be a beginning
           damping, element, law);
  scene_open_text(run, text);
  scene_run_from(run, NULL);
  ck_assert_msg(run->status == STATUS_OK, "%s", status_message());
}

// At a constant step a linear scene needs one factorisation: IDA keeps it while c changes by less than a
// quarter, and what it asks for beyond that is done only for a new c. K and D are assembled once whatever the
// steps.
START_TEST(a_linear_scene_is_assembled_once) {
  static const char *const elements[] = {"linear", "nodal", "quadratic"}, *const dampings[] = {"0", "1e-3"};
  SceneRun linear, other;
  swing(&linear, "linear", elements[_i % 3], dampings[_i / 3]);
  swing(&other, "corotational", elements[_i % 3], dampings[_i / 3]);
  bool is_damped = _i / 3;
  const FemRunResult *once = &linear.result, *often = &other.result;
  ck_assert_int_gt(once->integrator.setups, 2); // the step did change
  ck_assert_int_eq(once->matrix.assemblies, is_damped ? 2 : 1);
  ck_assert_int_le(once->matrix.solver.factorisations, once->integrator.setups);
  ck_assert_int_ge(often->matrix.solver.factorisations, often->integrator.setups); // more: one at another c
  ck_assert_int_eq(often->matrix.assemblies, (is_damped ? 2 : 1) * often->integrator.setups);
  // It did swing, and as the other law does.
  int last = linear.result.trajectory.frame_count - 1, tip = linear.model.vertex_count - 1;
  double rest = linear.model.rest[3 * tip + 2], way = scene_position(&linear, last, tip)[2] - rest;
  ck_assert(way < -1e-3);
  ck_assert_near(scene_position(&other, last, tip)[2] - rest, way, 0.02 * fabs(way));
  scene_close(&linear);
  scene_close(&other);
}
END_TEST

START_TEST(a_linear_scene_with_one_step_size_is_factorised_once) {
  SceneRun run;
  scene_open_text(&run,
                  "time: {end: 0.2, initial_step: 0.002, min_step: 0.002, max_step: 0.002, tolerance: 0.1}\n"
                  "output: {checkpoint: 0}\n"
                  "effects: {gravity: [0, 0, -1], damping: 1e-3}\n"
                  "bodies:\n"
                  "  - name: beam\n"
                  "    mesh: {box: {size: [0.5, 0.1, 0.1], cells: [10, 2, 2]}}\n"
                  "    material: {law: linear, young: 1e6, poisson: 0.3, density: 1000}\n"
                  "    fixed: [{group: x_min}]\n");
  scene_run_from(&run, NULL);
  ck_assert_int_eq(run.status, STATUS_OK);
  ck_assert_int_eq(run.result.integrator.steps, 100);
  ck_assert_int_eq(run.result.matrix.solver.factorisations, 1);
  ck_assert_int_eq(run.result.matrix.solver.analyses, 1);
  scene_close(&run);
}
END_TEST

// Uniaxial tension beyond yield and back: ε = σ/E + (σ − σ_y)/H while it grows, (σ_max − σ_y)/H stays.
// Strains are below 1 %, and the Green strain and its stress differ from the small ones by as much.
START_TEST(a_j2_bar_yields_hardens_and_keeps_its_plastic_strain) {
  static const char *const elements[] = {"linear", "nodal", "quadratic"};
  const double E = 1e8, yield = 1e5, H = 1e7, most = 1.5e5;
  SceneRun run;
  pull(&run, "{law: stvk, young: 1e8, poisson: 0.3, density: 1000, plasticity: {yield: 1e5, hardening: 1e7}}",
       "traction: [1.5e5, 0, 0], table: [[0, 0], [0.5, 1], [1, 0]]", "{end: 1, static: true, max_step: 0.05}",
       elements[_i]);
  // The traction is by rest area, so S = T/(1 + e); the Green strain e + e²/2 follows S.
  double e = 0, alpha = 0;
  for (int k = 0; k < 50; k++) {
    double stress = most / (1 + e);
    alpha = (stress - yield) / H;
    e = sqrt(1 + 2 * (stress / E + alpha)) - 1;
  }
  double plastic = sqrt(1 + 2 * alpha) - 1;
  ck_assert_near(strain(&run, 1, 0), 0.5 * most / E, 2e-3 * 0.5 * most / E); // elastic still
  ck_assert_near(strain(&run, 2, 0), e, 1e-3 * e);
  ck_assert_near(strain(&run, 4, 0), plastic, 1e-3 * plastic);
  // Plastic flow keeps the volume, elastic strain is gone: the sides are half of it.
  ck_assert_near(strain(&run, 4, 1), -0.5 * plastic, 0.02 * plastic);
  // σ_y α V is dissipated, ½ H α² V is stored: all of it the load's work, to the rule over steps of a
  // twentieth.
  double volume = 1e-3, dissipated = run.result.energy.audit.dissipated, work = run.result.energy.audit.work;
  ck_assert_near(dissipated, yield * alpha * volume, 1e-3 * yield * alpha * volume);
  ck_assert_near(work, dissipated + 0.5 * H * alpha * alpha * volume, 0.02 * work);
  ck_assert_near(run.result.energy.audit.total, 0, 0.02 * work);
  scene_close(&run);
}
END_TEST

// Two plastic blocks' worth of noise: the matrix against central differences of the force, from a history
// that is not zero, in states that flow; forces from inside the flow are smooth.
START_TEST(the_tangent_of_plastic_flow_is_consistent) {
  SceneRun run;
  char text[512];
  snprintf(text, sizeof text,
           "time: {end: 1}\n"
           "bodies:\n"
           "  - name: block\n"
           "    element: %s\n"
           "    mesh: {box: {size: [1, 1, 1], cells: 1}}\n"
           "    material: {law: stvk, young: 1, poisson: 0.3, density: 1, plasticity: {yield: 0.01, "
           "hardening: 0.1}}\n",
           _i ? "quadratic" : "linear");
  scene_open_text(&run, text);
  FemSystem system;
  FemState state;
  ck_assert_ok(fem_system_create(&system, &run.model));
  ck_assert_ok(fem_system_create_state(&system, &state));
  int n = run.model.free_count;
  double *u = calloc((size_t)n, sizeof *u), *d = calloc((size_t)n, sizeof *d);
  double *Kd = calloc((size_t)n, sizeof *d), *above = calloc((size_t)n, sizeof *d), h = 1e-6;
  Random random = random_seeded(21, 0);
  for (int i = 0; i < n; i++) u[i] = 0.05 * suite_normal(&random);
  fem_system_scatter(&system, 0, u, NULL, &state);
  ck_assert_ok(fem_system_accept(&system, &state, 0));
  for (int i = 0; i < n; i++) u[i] += 0.1 * suite_normal(&random), d[i] = suite_normal(&random);
  fem_system_scatter(&system, 0, u, NULL, &state);
  ck_assert_ok(fem_system_assemble(&system, &state, 1, 0, 0, &system.matrix));
  fem_matrix_multiply(&system.matrix, d, Kd);
  for (int i = 0; i < n; i++) u[i] += h * d[i];
  fem_system_scatter(&system, 0, u, NULL, &state);
  ck_assert_ok(fem_system_forces(&system, &state));
  memcpy(above, system.forces, (size_t)n * sizeof *above); // nothing is fixed: unknowns are coordinates
  for (int i = 0; i < n; i++) u[i] -= 2 * h * d[i];
  fem_system_scatter(&system, 0, u, NULL, &state);
  ck_assert_ok(fem_system_forces(&system, &state));
  for (int i = 0; i < n; i++) ck_assert_near(Kd[i], -(above[i] - system.forces[i]) / (2 * h), 1e-7);
  double *all[] = {u, d, Kd, above};
  for (int i = 0; i < 4; i++) free(all[i]);
  fem_state_destroy(&state);
  fem_system_destroy(&system);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("solids");
  tcase_add_loop_test(test_case, a_kelvin_voigt_solid_creeps, 0, 2);
  tcase_add_loop_test(test_case, a_linear_scene_is_assembled_once, 0, 6);
  tcase_add_test(test_case, a_linear_scene_with_one_step_size_is_factorised_once);
  tcase_add_loop_test(test_case, a_j2_bar_yields_hardens_and_keeps_its_plastic_strain, 0, 3);
  tcase_add_loop_test(test_case, the_tangent_of_plastic_flow_is_consistent, 0, 2);
  return suite_run("solids", test_case, 60);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Torques: statically equivalent forces, the twist of a shaft after Saint-Venant, a body that is spun up, and
// the work of both.
#include "static_solve.h"

#include "base/random.h"
#include "base/vec3.h"
#include "fem/scene/load.h"

// Σ f and Σ x × f at displaced vertices.
static void sum_forces(const FemMesh *mesh, const double *x, const double *force, Vec3 *sum, Vec3 *moment) {
  *sum = *moment = (Vec3){0, 0, 0};
  for (size_t v = 0; v < (size_t)mesh->vertex_count; v++) {
    Vec3 f = vec3_at(force + 3 * v);
    *sum = vec3_add(*sum, f);
    *moment = vec3_add(*moment, vec3_cross(vec3_at(x + 3 * v), f));
  }
}

START_TEST(a_torque_has_its_moment_and_no_resultant_however_the_body_is_bent) {
  FemLoadDef def = {.kind = FEM_LOAD_TORQUE,
                    .vector = {1, -2, 3},
                    .select = {.kind = _i ? FEM_SELECT_ALL : FEM_SELECT_GROUP, .group = "z_max"}};
  FemMesh mesh;
  FemLoad load;
  Vec3 sum, moment;
  Random random = random_seeded(5, 1);
  ck_assert_ok(fem_mesh_box(&mesh, (const double[]){2, 1, 0.5}, (const int[]){3, 2, 2}));
  if (_i) ck_assert_ok(fem_mesh_make_quadratic(&mesh));
  ck_assert_ok(fem_load_create(&load, &def, &mesh, 0));
  size_t n = 3 * (size_t)mesh.vertex_count;
  double *x = malloc(n * sizeof *x), *force = calloc(n, sizeof *force);
  for (size_t i = 0; i < n; i++) x[i] = mesh.rest[i] + 0.1 * suite_normal(&random);
  fem_load_add_force(&load, 2, x, force);
  sum_forces(&mesh, x, force, &sum, &moment);
  ck_assert_near(vec3_length(sum), 0, 1e-13);
  ck_assert_near(vec3_length(vec3_sub(moment, (Vec3){2, -4, 6})), 0, 1e-13);
  free(x);
  free(force);
  fem_load_destroy(&load);
  fem_mesh_destroy(&mesh);
}
END_TEST

// The mean turn about x of a section: of the displacements that a rigid turn by θ makes, θ.
static double turn_of_section(const FemModel *model, const double *u, double at) {
  double moment = 0, inertia = 0;
  for (int v = 0; v < model->vertex_count; v++) {
    const double *X = model->rest + 3 * v;
    if (fabs(X[0] - at) > 1e-9) continue;
    double y = X[1] - 0.5, z = X[2] - 0.5;
    moment += y * u[3 * v + 2] - z * u[3 * v + 1];
    inertia += y * y + z * z;
  }
  return moment / inertia;
}

// A square shaft of side a: θ' = T/(G J), J = 0.140577 a⁴ (Timoshenko and Goodier, §109), away from its ends,
// of which one is clamped. The rest is discretisation: 0.4 % with four elements a side, 1 % with three.
START_TEST(a_shaft_twists_by_its_torque_over_its_stiffness) {
  SceneRun run;
  scene_open_text(&run, "time: {end: 1}\n"
                        "bodies:\n"
                        "  - name: shaft\n"
                        "    element: quadratic\n"
                        "    mesh: {box: {size: [4, 1, 1], cells: [16, 4, 4]}}\n"
                        "    material: {law: linear, young: 2.6, poisson: 0.3, density: 1}\n"
                        "    fixed: [{group: x_min}]\n"
                        "    loads: [{group: x_max, torque: [1e-3, 0, 0]}]\n");
  double *u = solve_linear_static(&run.model);
  double twist = turn_of_section(&run.model, u, 3) - turn_of_section(&run.model, u, 1);
  double expected = 1e-3 * 2 / (1 * 0.140577);
  printf("twist over T L / G J: %.4f\n", twist / expected);
  ck_assert_near(twist, expected, 0.01 * expected);
  free(u);
  scene_close(&run);
}
END_TEST

// A cube of 1 kg and 0.1 m, I = m a²/6, that nothing holds: ½ T t²/I = 2.25 rad after 0.5 s. Its work T θ is
// its kinetic energy.
START_TEST(a_torque_spins_a_free_body_up_and_its_work_is_kinetic_energy) {
  SceneRun run;
  scene_open_text(&run, "time: {end: 0.5, tolerance: 1e-5}\n"
                        "output: {frames: 100}\n"
                        "bodies:\n"
                        "  - name: box\n"
                        "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 5}}\n"
                        "    material: {law: corotational, young: 1e6, poisson: 0.3, density: 1000}\n"
                        "    loads: [{all: true, torque: [0, 0, 0.03]}]\n");
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  // I of the lumped masses
  double inertia = 0;
  for (int v = 0; v < run.model.vertex_count; v++) {
    double x = run.model.rest[3 * v] - 0.05, y = run.model.rest[3 * v + 1] - 0.05;
    inertia += run.model.mass[v] * (x * x + y * y);
  }
  double angle = 0.5 * 0.03 * 0.25 / inertia;
  const double *end = scene_position(&run, 100, 0);
  double turned = atan2(end[1] - 0.05, end[0] - 0.05) - atan2(-0.05, -0.05);
  // lumped masses have products of inertia: the axis tilts
  ck_assert_near(remainder(turned - angle, 2 * M_PI), 0, 0.02 * angle);
  ck_assert_near(run.result.energy.audit.work, 0.03 * angle, 0.01 * 0.03 * angle);
  ck_assert_near(run.result.energy.audit.total, 0, 2e-3 * run.result.energy.audit.work);
  ck_assert(scene_gain(&run) <= 1e-4);
  scene_close(&run);
}
END_TEST

// Statics, T = t T₁ to a turn of about half a radian: the work is the strain energy.
START_TEST(the_work_of_a_torque_in_statics_is_the_strain_energy) {
  SceneRun run;
  scene_open_text(&run, "time: {end: 1, static: true}\n"
                        "output: {frames: 20}\n"
                        "bodies:\n"
                        "  - name: shaft\n"
                        "    mesh: {box: {size: [4, 1, 1], cells: [8, 2, 2]}}\n"
                        "    material: {young: 2.6, poisson: 0.3, density: 1}\n"
                        "    fixed: [{group: x_min}]\n"
                        "    loads: [{group: x_max, torque: [0.04, 0, 0], factor: t}]\n");
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  printf("work %.6g J, total %.3g J, open %.3g\n", run.result.energy.audit.work,
         run.result.energy.audit.total, run.result.energy.audit.total / run.result.energy.audit.work);
  ck_assert(run.result.energy.audit.work > 1e-3);
  ck_assert_near(run.result.energy.audit.total, 0, 2e-3 * run.result.energy.audit.work);
  scene_close(&run);
}
END_TEST

START_TEST(a_torque_on_a_line_is_refused_with_its_place) {
  static const char text[] = "time: {end: 1}\n"
                             "bodies:\n"
                             "  - name: shaft\n"
                             "    mesh: {box: {size: [4, 1, 1], cells: [8, 2, 2]}}\n"
                             "    material: {young: 2.6, poisson: 0.3, density: 1}\n"
                             "    loads: [{box: {min: [0, 0, 0], max: [4, 0, 0]}, torque: [1, 0, 0]}]\n";
  FemSceneDef scene;
  FemModel model;
  ck_assert_ok(scene_text_read("line.yaml", text, strlen(text), &scene));
  ck_assert_int_eq(fem_model_create(&model, &scene), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "line.yaml:6:13: body 'shaft', loads[0]"));
  ck_assert_ptr_nonnull(strstr(status_message(), "9 vertices on a line"));
  fem_scene_destroy(&scene);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("torsion");
  tcase_add_loop_test(test_case, a_torque_has_its_moment_and_no_resultant_however_the_body_is_bent, 0, 2);
  tcase_add_test(test_case, a_shaft_twists_by_its_torque_over_its_stiffness);
  tcase_add_test(test_case, a_torque_spins_a_free_body_up_and_its_work_is_kinetic_energy);
  tcase_add_test(test_case, the_work_of_a_torque_in_statics_is_the_strain_energy);
  tcase_add_test(test_case, a_torque_on_a_line_is_refused_with_its_place);
  return suite_run("torsion", test_case, 60);
}

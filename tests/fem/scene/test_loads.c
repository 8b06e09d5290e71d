// SPDX-License-Identifier: GPL-3.0-or-later
// Loads, driven vertices by formulas, and their release: forces that a hand can sum, stiffness against
// differences, motions with closed forms, and the energy audit.
#include "scene.h"

#include <string.h>

#include "base/random.h"
#include "base/vec3.h"
#include "fem/model/build.h"
#include "fem/scene/load.h"
#include "scene_text.h"

static const double SIZE[3] = {2, 1, 0.5};

static FemLoad load_on_box(const FemLoadDef *def, FemMesh *mesh) {
  const int cells[3] = {3, 2, 2};
  FemLoad load;
  ck_assert_ok(fem_mesh_box(mesh, SIZE, cells));
  ck_assert_ok(fem_load_create(&load, def, mesh, 0));
  return load;
}

static void sum_forces(const FemLoad *load, const FemMesh *mesh, double factor, double sum[3]) {
  double *force = calloc(3 * (size_t)mesh->vertex_count, sizeof *force);
  fem_load_add_force(load, factor, mesh->rest, force);
  sum[0] = sum[1] = sum[2] = 0;
  for (int i = 0; i < 3 * mesh->vertex_count; i++) sum[i % 3] += force[i];
  free(force);
}

static FemSelectDef top(void) {
  return (FemSelectDef){.kind = FEM_SELECT_HALFSPACE, .point = {0, 0, 0.5}, .normal = {0, 0, -1}};
}

static void expect_sum(FemLoadDef def, double factor, double x, double y, double z) {
  FemMesh mesh;
  FemLoad load = load_on_box(&def, &mesh);
  double sum[3];
  sum_forces(&load, &mesh, factor, sum);
  ck_assert_near(sum[0], x, 1e-12);
  ck_assert_near(sum[1], y, 1e-12);
  ck_assert_near(sum[2], z, 1e-12);
  fem_load_destroy(&load);
  fem_mesh_destroy(&mesh);
}

START_TEST(nodal_forces_add_up_to_the_load) {
  expect_sum((FemLoadDef){.select = top(), .kind = FEM_LOAD_FORCE, .vector = {1, 2, 3}}, 2, 2, 4, 6);
  expect_sum((FemLoadDef){.select = top(), .kind = FEM_LOAD_TRACTION, .vector = {1, 0, 3}}, 1, 2, 0, 6);
  expect_sum((FemLoadDef){.select = top(), .kind = FEM_LOAD_PRESSURE, .pressure = 3}, 1, 0, 0, -6);
  expect_sum((FemLoadDef){.select = top(), .kind = FEM_LOAD_PRESSURE, .pressure = 3, .is_dead = true}, 1, 0,
             0, -6);
  expect_sum((FemLoadDef){.kind = FEM_LOAD_BODY_FORCE, .vector = {0, 5, 0}}, 1, 0, 5, 0);
  expect_sum((FemLoadDef){.kind = FEM_LOAD_PRESSURE, .pressure = 7}, 1, 0, 0, 0);
}
END_TEST

static double volume_of(const FemMesh *mesh, const double *x) {
  double six_volumes = 0;
  for (int e = 0; e < mesh->tet_count; e++) {
    const int *t = mesh->tets[e];
    six_volumes +=
        vec3_det4(vec3_at(x + 3 * t[0]), vec3_at(x + 3 * t[1]), vec3_at(x + 3 * t[2]), vec3_at(x + 3 * t[3]));
  }
  return six_volumes / 6;
}

// The volume is a cubic: central differences are off by h²/6 of its third derivative, ~1e-12 here.
START_TEST(a_following_pressure_is_the_gradient_of_the_volume) {
  FemLoadDef def = {.kind = FEM_LOAD_PRESSURE, .pressure = 3};
  FemMesh mesh;
  FemLoad load = load_on_box(&def, &mesh);
  Random random = random_seeded(3, 1);
  size_t n = 3 * (size_t)mesh.vertex_count;
  double *x = malloc(n * sizeof *x), *force = calloc(n, sizeof *force), h = 1e-5;
  for (size_t i = 0; i < n; i++) x[i] = mesh.rest[i] + 0.05 * suite_normal(&random);
  fem_load_add_force(&load, 2, x, force);
  for (size_t i = 0; i < n; i++) {
    double here = x[i];
    x[i] = here + h;
    double above = volume_of(&mesh, x);
    x[i] = here - h;
    double below = volume_of(&mesh, x);
    x[i] = here;
    ck_assert_near(force[i], -2 * 3 * (above - below) / (2 * h), 1e-8);
  }
  free(x);
  free(force);
  fem_load_destroy(&load);
  fem_mesh_destroy(&mesh);
}
END_TEST

// On a closed surface the assembled stiffness is symmetric, so that leaving out antisymmetric parts changes
// nothing: K δ against differences of the force.
START_TEST(the_stiffness_of_a_closed_surface_is_exact) {
  FemLoadDef def = {.kind = FEM_LOAD_PRESSURE, .pressure = 3};
  FemMesh mesh;
  FemLoad load = load_on_box(&def, &mesh);
  Random random = random_seeded(4, 1);
  size_t n = 3 * (size_t)mesh.vertex_count;
  double *x = malloc(n * sizeof *x), *d = malloc(n * sizeof *d), *product = calloc(n, sizeof *d);
  double *above = calloc(n, sizeof *d), *below = calloc(n, sizeof *d), h = 1e-5;
  for (size_t i = 0; i < n; i++) x[i] = mesh.rest[i] + 0.05 * suite_normal(&random);
  for (size_t i = 0; i < n; i++) d[i] = suite_normal(&random);
  for (int k = 0; k < load.triangle_count; k++) {
    const int *t = load.triangles[k];
    double stiffness[81];
    fem_load_triangle_stiffness(3, x + 3 * t[0], x + 3 * t[1], x + 3 * t[2], stiffness);
    for (int r = 0; r < 9; r++)
      for (int s = 0; s < 9; s++)
        product[3 * t[r / 3] + r % 3] += stiffness[9 * r + s] * d[3 * t[s / 3] + s % 3];
  }
  for (size_t i = 0; i < n; i++) x[i] += h * d[i];
  fem_load_add_force(&load, 1, x, above);
  for (size_t i = 0; i < n; i++) x[i] -= 2 * h * d[i];
  fem_load_add_force(&load, 1, x, below);
  for (size_t i = 0; i < n; i++) ck_assert_near(product[i], -(above[i] - below[i]) / (2 * h), 1e-8);
  double *all[] = {x, d, product, above, below};
  for (int i = 0; i < 5; i++) free(all[i]);
  fem_load_destroy(&load);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(a_factor_follows_its_table_and_its_formula) {
  double rows[] = {1, 0, 3, 4, 4, -1}, factor;
  FemLoadDef def = {.table = rows, .table_count = 3};
  const double expected[][2] = {{0, 0}, {1, 0}, {2, 2}, {3, 4}, {3.5, 1.5}, {9, -1}};
  for (int i = 0; i < 6; i++) {
    ck_assert_ok(fem_load_factor(&def, expected[i][0], &factor));
    ck_assert_near(factor, expected[i][1], 1e-15);
  }
  Expression expression;
  ck_assert_ok(expression_parse(&expression, "t", "1/(t - 1)"));
  FemLoadDef formula = {.factor = &expression};
  ck_assert_ok(fem_load_factor(&formula, 3, &factor));
  ck_assert_near(factor, 0.5, 0);
  ck_assert_int_eq(fem_load_factor(&formula, 1, &factor), STATUS_INPUT);
}
END_TEST

// A scene of one box of 1 kg, 0.1 m, with what is told of it.
static Status read_box(SceneRun *run, const char *about_body, const char *about_scene) {
  char text[2048];
  snprintf(text, sizeof text,
           "time: {end: 0.5, tolerance: 1e-5}\n"
           "%s"
           "bodies:\n"
           "  - name: box\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
           "    material: {law: corotational, young: 1e6, poisson: 0.3, density: 1000}\n"
           "%s",
           about_scene, about_body);
  *run = (SceneRun){0};
  return scene_text_read("box.yaml", text, strlen(text), &run->scene);
}

static void run_box(SceneRun *run, const char *about_body, const char *about_scene) {
  ck_assert_ok(read_box(run, about_body, about_scene));
  ck_assert_ok(fem_model_create(&run->model, &run->scene));
  scene_run_from(run, NULL);
  ck_assert_msg(run->status == STATUS_OK, "%s", status_message());
}

static double mean_of(const SceneRun *run, int frame, int c) {
  double sum = 0;
  for (int a = 0; a < run->model.vertex_count; a++)
    sum += run->model.mass[a] * (scene_position(run, frame, a)[c] - run->model.rest[3 * a + c]);
  return sum / run->model.bodies[0].mass;
}

// x = ½ (F/m) t² = 0.5 m for 4 N on 1 kg in 0.5 s, W = F x = 2 J; and again where the system begins anew at
// every checkpoint.
START_TEST(a_constant_force_moves_a_body_and_its_work_becomes_kinetic_energy) {
  SceneRun run;
  run_box(&run, "    loads: [{all: true, body_force: [4000, 0, 0]}]\n",
          _i ? "output: {checkpoint: {frames: 1}}\n" : "");
  ck_assert_near(mean_of(&run, run.result.trajectory.frame_count - 1, 0), 0.5, 2e-4);
  ck_assert_near(run.result.energy.audit.work, 4 * mean_of(&run, run.result.trajectory.frame_count - 1, 0),
                 1e-9);
  ck_assert(scene_gain(&run) <= 1e-4);
  ck_assert_near(run.result.energy.audit.total, 0, 2e-3 * run.result.energy.audit.work);
  scene_close(&run);
}
END_TEST

// m v = ∫ F dt: F = 4 (1 − cos 2πt) N from 0 to ½ s gives x = ∫∫ = 4 (t²/2 − (1 − cos 2πt)/4π²) = 0.29736 m.
START_TEST(a_force_by_a_formula_gives_its_impulse) {
  SceneRun run;
  run_box(&run, "    loads: [{all: true, force: [0, 4, 0], factor: 1 - cos(2*pi*t)}]\n", "");
  double expected = 4 * (0.125 - 2 / (4 * M_PI * M_PI));
  ck_assert_near(mean_of(&run, run.result.trajectory.frame_count - 1, 1), expected, 2e-3 * expected);
  ck_assert(scene_gain(&run) <= 1e-3);
  scene_close(&run);
}
END_TEST

START_TEST(vertices_driven_by_a_formula_are_where_it_says) {
  SceneRun run;
  run_box(&run, "    driven: [{group: x_min, formula: {x: 0.01*sin(8*t), z: 0.02*t^2}}]\n",
          "output: {frames: 10}\n");
  for (int frame = 0; frame <= 10; frame++) {
    double t = run.result.trajectory.times[frame];
    for (int a = 0; a < run.model.vertex_count; a++) {
      if (run.model.rest[3 * a] > 0) continue;
      const double *x = scene_position(&run, frame, a), *rest = run.model.rest + 3 * a;
      ck_assert_near(x[0] - rest[0], 0.01 * sin(8 * t), 1e-15);
      ck_assert_near(x[1] - rest[1], 0, 1e-15);
      ck_assert_near(x[2] - rest[2], 0.02 * t * t, 1e-15);
    }
  }
  ck_assert_double_le(scene_gain(&run), run.result.energy.bounds.run);
  scene_close(&run);
}
END_TEST

// Carried along at 2 m/s until 0.25 s, then free: 1 m in 0.5 s, whatever holds it; and ½ m v² = 2 J is what
// the carrier has given, its unknown motion included.
START_TEST(released_vertices_fly_on) {
  SceneRun run;
  run_box(&run,
          "    velocity: [2, 0, 0]\n    driven: [{all: true, velocity: [2, 0, 0], components: [x], release: "
          "0.25}]\n",
          "output: {frames: 8}\n");
  int vertices = run.model.vertex_count;
  ck_assert_int_eq(run.model.free_count, 2 * vertices);
  for (int frame = 0; frame <= 8; frame++)
    ck_assert_near(mean_of(&run, frame, 0), 2 * run.result.trajectory.times[frame], 1e-7);
  ck_assert_near(run.result.energy.audit.work, 2, 1e-6);
  ck_assert(scene_gain(&run) <= 1e-6);
  scene_close(&run);
}
END_TEST

// Fixed, it does not move; let go at 0.25 s, it falls: ½ g (0.25 s)² = 0.30656 m.
START_TEST(fixed_vertices_fall_when_released) {
  SceneRun run;
  run_box(&run, "    fixed: [{all: true, components: [z], release: 0.25}]\n",
          "effects: {gravity: [0, 0, -9.81]}\noutput: {frames: 10}\n");
  ck_assert_near(mean_of(&run, 5, 2), 0, 1e-12);
  ck_assert_near(mean_of(&run, 10, 2), -0.5 * 9.81 * 0.0625, 1e-4);
  ck_assert(scene_gain(&run) <= 1e-3);
  scene_close(&run);
}
END_TEST

static void refuse(const char *about_body, const char *expected) {
  SceneRun run;
  Status status = read_box(&run, about_body, "");
  if (!status) status = fem_model_create(&run.model, &run.scene);
  ck_assert_int_eq(status, STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), expected), "expected '%s' in: %s", expected, status_message());
  ck_assert_msg(strstr(status_message(), "box.yaml:"), "no place in: %s", status_message());
  fem_scene_destroy(&run.scene);
}

START_TEST(what_contradicts_itself_is_refused_with_its_place) {
  refuse("    loads: [{all: true}]\n", "needs at least one of these keys: force body_force");
  refuse("    loads: [{force: [1, 0, 0]}]\n", "needs one of these keys: box");
  refuse("    loads: [{all: true, force: [1, 0, 0], pressure: 3}]\n", "contradicts 'pressure'");
  refuse("    loads: [{all: true, force: [1, 0, 0], factor: t, table: [[0, 1]]}]\n", "contradicts");
  refuse("    loads: [{all: true, force: [1, 0, 0], factor: sine(t)}]\n", "did you mean sin?");
  refuse("    loads: [{all: true, force: [1, 0, 0], table: [[1, 1], [0, 1]]}]\n", "times must increase");
  refuse("    loads: [{all: true, force: [1, 0, 0], follows: nothing}]\n", "needs 'pressure'");
  refuse("    loads: [{box: {min: [-1, -1, -1], max: [0.01, 0.01, 0.01]}, pressure: 1}]\n", "no triangle");
  refuse("    loads: [{all: true, presure: 1}]\n", "did you mean 'pressure'");
  refuse("    fixed: [{group: x_min}]\n    driven: [{group: x_min, velocity: [1, 0, 0]}]\n",
         "prescribed twice");
  refuse("    fixed: [{group: x_min, release: 1}, {group: x_min, release: 2}]\n", "prescribed twice");
  refuse("    driven: [{group: x_min, velocity: [1, 0, 0], until: 2, release: 1}]\n", "released before");
  refuse("    driven: [{group: x_min, formula: {x: t}, table: [[0, 0, 0, 0]]}]\n", "contradicts");
  refuse("    driven: [{group: x_min, formula: {}}]\n", "at least one of these keys: x y z");
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("loads");
  tcase_add_test(test_case, nodal_forces_add_up_to_the_load);
  tcase_add_test(test_case, a_following_pressure_is_the_gradient_of_the_volume);
  tcase_add_test(test_case, the_stiffness_of_a_closed_surface_is_exact);
  tcase_add_test(test_case, a_factor_follows_its_table_and_its_formula);
  tcase_add_loop_test(test_case, a_constant_force_moves_a_body_and_its_work_becomes_kinetic_energy, 0, 2);
  tcase_add_test(test_case, a_force_by_a_formula_gives_its_impulse);
  tcase_add_test(test_case, vertices_driven_by_a_formula_are_where_it_says);
  tcase_add_test(test_case, released_vertices_fly_on);
  tcase_add_test(test_case, fixed_vertices_fall_when_released);
  tcase_add_test(test_case, what_contradicts_itself_is_refused_with_its_place);
  return suite_run("loads", test_case, 60);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The potential `field` in whole scenes: uniform stress through an interface of meshes that do not match, and
// forces under what stands still.
#include "scene.h"

#include <string.h>

#include "base/vec3.h"
#include "fem/model/build.h"

static const double E = 1e6, NU = 0.3, TRACTION = 1000;

static void open_text(SceneRun *run, const char *text) {
  *run = (SceneRun){.status = STATUS_OK};
  ck_assert_ok(app_scene_read_text("field.yaml", text, strlen(text), &run->scene));
  ck_assert_ok(fem_model_create(&run->model, &run->scene));
}

// ---- Patch test.

// Two blocks of 0.1 × 0.1 × 0.05 m, three planes of symmetry, pressed from above.
static const char SCENE[] = "time: {end: 1, static: true}\n"
                            "bodies:\n"
                            "  - name: lower\n"
                            "    element: %s\n"
                            "    mesh: {%s}\n"
                            "    %s\n"
                            "    material: {law: linear, young: 1e6, poisson: 0.3, density: 1000}\n"
                            "    fixed:\n"
                            "      - {box: {min: [-1e-9, -1, -1], max: [1e-9, 1, 1]}, components: [x]}\n"
                            "      - {box: {min: [-1, -1e-9, -1], max: [1, 1e-9, 1]}, components: [y]}\n"
                            "      - {box: {min: [-1, -1, -1e-9], max: [1, 1, 1e-9]}, components: [z]}\n"
                            "  - name: upper\n"
                            "    element: %s\n"
                            "    mesh: {box: {size: [0.1, 0.1, 0.05], cells: %s}}\n"
                            "    place: {translate: [0, 0, 0.05]}\n"
                            "    material: {law: linear, young: 1e6, poisson: 0.3, density: 1000}\n"
                            "    fixed:\n"
                            "      - {group: x_min, components: [x]}\n"
                            "      - {group: y_min, components: [y]}\n"
                            "    loads: [{group: z_max, traction: [0, 0, -1000]}]\n"
                            "contact: {potential: field, overlap: clip, stiffness: %g}\n"
                            "output: {frames: 1}\n";

typedef struct Patch {
  const char *element, *mesh, *place, *upper_cells;
} Patch;

static const Patch CUBES = {"linear", "box: {size: [0.1, 0.1, 0.05], cells: [4, 4, 2]}", "", "[5, 5, 3]"};
static const Patch UNSTRUCTURED = {"linear", "file: " TETLAP_SOURCE_DIR "/meshes/block.msh",
                                   "place: {scale: [0.5, 0.5, 0.25], translate: [0.05, 0.05, 0]}",
                                   "[5, 5, 3]"};

// Of a tetrahedron.
static void find_stress(const SceneRun *run, int tet, double stress[9]) {
  const int *v = run->model.tets[tet];
  Vec3 X[4], x[4], slope[4];
  for (int k = 0; k < 4; k++) {
    X[k] = vec3_at(run->model.rest + 3 * v[k]);
    x[k] = vec3_sub(vec3_at(scene_position(run, 1, v[k])), X[k]);
  }
  Vec3 a = vec3_sub(X[1], X[0]), b = vec3_sub(X[2], X[0]), c = vec3_sub(X[3], X[0]);
  double det = vec3_dot(a, vec3_cross(b, c)), H[9] = {0}, trace = 0;
  slope[1] = vec3_scale(1 / det, vec3_cross(b, c)), slope[2] = vec3_scale(1 / det, vec3_cross(c, a));
  slope[3] = vec3_scale(1 / det, vec3_cross(a, b));
  for (int k = 1; k < 4; k++) {
    Vec3 u = vec3_sub(x[k], x[0]);
    const double d[3] = {u.x, u.y, u.z}, g[3] = {slope[k].x, slope[k].y, slope[k].z};
    for (int e = 0; e < 9; e++) H[e] += d[e / 3] * g[e % 3];
  }
  double lambda = E * NU / ((1 + NU) * (1 - 2 * NU)), mu = E / (2 * (1 + NU));
  for (int i = 0; i < 3; i++) trace += H[4 * i];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      stress[3 * i + j] = mu * (H[3 * i + j] + H[3 * j + i]) + (i == j ? lambda * trace : 0);
}

// Largest difference of any stress of any element from the uniform one, over it.
static double unevenness(const Patch *patch, double stiffness) {
  char text[4096];
  snprintf(text, sizeof text, SCENE, patch->element, patch->mesh, patch->place, patch->element,
           patch->upper_cells, stiffness);
  SceneRun run;
  open_text(&run, text);
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  ck_assert_near(fabs(scene_force(&run, 1, 0)[2]), TRACTION * 0.01, 1e-6 * TRACTION * 0.01);
  double worst = 0;
  for (int e = 0; e < run.model.tet_count; e++) {
    double stress[9];
    find_stress(&run, e, stress);
    for (int k = 0; k < 9; k++)
      worst = suite_larger(worst, fabs(stress[k] + (k == 8 ? TRACTION : 0)) / TRACTION);
  }
  scene_close(&run);
  return worst;
}

// c = κ/(2h) is as compliant as `nodal` with κ: for κ = E 2e7 Pa/m.
START_TEST(uniform_stress_passes_an_interface) {
  const Patch *const patches[] = {&CUBES, &UNSTRUCTURED};
  double soft = unevenness(patches[_i], 2e7), hard = unevenness(patches[_i], 2e8);
  printf("patch test, %s: %.1e at the compliance of E, %.1e at that of 10 E\n", _i ? "unstructured" : "cubes",
         soft, hard);
  ck_assert(soft <= 5e-3);
  ck_assert(hard <= 5e-4);
}
END_TEST

// ---- At rest, with the default tolerance.

START_TEST(what_stands_weighs_m_g) {
  static const double MODULI[] = {1e5, 1e6, 1e7, 1e8, 1e9};
  char text[1024];
  snprintf(text, sizeof text,
           "time: {end: 2}\n"
           "effects: {gravity: [0, 0, -9.81], damping: 4e-3}\n"
           "bodies:\n"
           "  - name: cube\n"
           "    mesh: {box: {size: [0.1, 0.1, 0.1], cells: 2}}\n"
           "    material: {young: %g, poisson: 0.3, density: 1000}\n"
           "obstacles: [{name: floor, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
           "contact: {potential: field, overlap: clip}\n"
           "output: {frames: 20}\n",
           MODULI[_i]);
  SceneRun run;
  open_text(&run, text);
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  for (int frame = 13; frame <= 20; frame++) ck_assert_near(scene_force(&run, frame, 0)[2] / 9.81, 1, 1e-3);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("field_theory");
  tcase_add_loop_test(tests, uniform_stress_passes_an_interface, 0, 2);
  tcase_add_loop_test(tests, what_stands_weighs_m_g, 0, 5);
  return suite_run("field_theory", tests, 120);
}

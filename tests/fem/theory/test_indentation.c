// SPDX-License-Identifier: GPL-3.0-or-later
// Contact against theory: a ball and a flat punch on an elastic half-space, uniform stress through an
// interface whose meshes do not match. Linear tetrahedra are too stiff, so forces come from above; what is
// tested is how far, and that refinement goes to theory.
#include <stdlib.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "fem/model/build.h"
#include "scene.h"
#include "scene_text.h"

static const double E = 1e6, NU = 0.3, WIDTH = 0.05; // of the ground; radius of both contacts [m]

// meshes/halfspace.geo with another `scale`, in a file of its own.
static void write_ground(double scale, char path[64]) {
  static const char line[] = "scale = 2;";
  char *text = NULL, *at;
  size_t size = 0;
  ck_assert_ok(file_read(TETLAP_SOURCE_DIR "/meshes/halfspace.geo", &text, &size));
  ck_assert_ptr_nonnull(at = strstr(text, line));
  snprintf(path, 64, "halfspace_%g.geo", scale);
  FILE *file = fopen(path, "w");
  ck_assert_ptr_nonnull(file);
  fprintf(file, "%.*sscale = %g;%s", (int)(at - text), text, scale, at + strlen(line));
  ck_assert_int_eq(fclose(file), 0);
  memory_free(text);
}

// Presses an obstacle into the ground; the force on all four quarters over `expected`.
static double press(double scale, const char *obstacle, double stiffness, double expected) {
  char mesh[64], text[2048];
  write_ground(scale, mesh);
  snprintf(text, sizeof text,
           "time: {end: 1, static: true}\n"
           "bodies:\n"
           "  - name: ground\n"
           "    mesh: {file: %s}\n"
           "    material: {law: linear, young: %g, poisson: %g, density: 1000}\n"
           "    fixed: [{group: outer}, {group: x_min, components: [x]}, {group: y_min, components: [y]}]\n"
           "obstacles: [{name: tool, %s}]\n"
           "contact: {potential: nodal, stiffness: %g, overlap: clip}\n"
           "output: {frames: 1}\n",
           mesh, E, NU, obstacle, stiffness);
  SceneRun run = {0};
  ck_assert_ok(scene_text_read("indentation.yaml", text, strlen(text), &run.scene));
  ck_assert_ok(fem_model_create(&run.model, &run.scene));
  scene_run_from(&run, NULL);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  ck_assert_int_gt(run.result.contact.pairs_max, 10);
  double share = 4 * fabs(scene_force(&run, 1, 0)[2]) / expected;
  scene_close(&run);
  remove(mesh);
  return share;
}

static const char BALL[] = "sphere: {centre: [0, 0, 1], radius: 1}, motion: {velocity: [0, 0, -0.0025]}";
static const char PUNCH[] =
    "mesh: {file: " TETLAP_SOURCE_DIR "/meshes/punch.geo}, motion: {velocity: [0, 0, -0.0005]}";

static double hertz(double scale, double stiffness) {
  return press(scale, BALL, stiffness, 4.0 / 3 * E / (1 - NU * NU) * sqrt(1.0) * pow(0.0025, 1.5));
}

static double punch(double scale, double stiffness) {
  return press(scale, PUNCH, stiffness, 2 * E / (1 - NU * NU) * WIDTH * 0.0005);
}

// At κ = 20 E the interface gives way by less than a hundredth of the depth. The error is of second order in
// the size of the elements; what is left without it is the ball's own slope (surface points move inwards, a/R
// = 0.05) and the far end, 1.5 %.
START_TEST(a_ball_is_carried_as_hertz_says) {
  double coarse = hertz(2.8, 20 * E), fine = hertz(2, 20 * E);
  double limit = fine - (coarse - fine) * 4 / (2.8 * 2.8 - 4);
  printf("force over Hertz's: %.4f, %.4f, without elements' size %.4f\n", coarse, fine, limit);
  ck_assert_near(fine, 1, 0.09);
  ck_assert(fine - 1 < 0.75 * (coarse - 1));
  ck_assert_near(limit, 1, 0.04);
}
END_TEST

// The pressure is singular at the rim: the error is of first order, (2/2.8) of the coarse one.
START_TEST(a_flat_punch_is_carried_as_theory_says) {
  double coarse = punch(2.8, 20 * E), fine = punch(2, 20 * E);
  double limit = fine - (coarse - fine) * 2 / (2.8 - 2);
  printf("force over theory: %.4f, %.4f, without elements' size %.4f\n", coarse, fine, limit);
  ck_assert_near(fine, 1, 0.1);
  ck_assert(fine < coarse);
  ck_assert_near(limit, 1, 0.04);
}
END_TEST

// An interface as soft as the ground takes part of the depth: the force is too small, however fine the mesh.
START_TEST(a_soft_interface_gives_way) {
  ck_assert(hertz(2, E) < 0.97 * hertz(2, 20 * E));
}
END_TEST

// Of an element of a body of the law linear.
static void find_stress(const SceneRun *run, int tet, double stress[9]) {
  double x[12], F[9], trace = 0, lambda = E * NU / ((1 + NU) * (1 - 2 * NU)), mu = E / (2 * (1 + NU));
  for (int k = 0; k < 4; k++)
    memcpy(x + 3 * k, scene_position(run, 1, run->model.tets[tet][k]), 3 * sizeof *x);
  const FemElement element = fem_model_element(&run->model, tet);
  fem_element_deformation(&element, x, F);
  for (int i = 0; i < 3; i++) trace += F[4 * i] - 1;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      stress[3 * i + j] = mu * (F[3 * i + j] + F[3 * j + i] - 2 * (i == j)) + (i == j ? lambda * trace : 0);
}

// tests/scenes/patch.yaml: largest difference of any stress of any element from the uniform one, over it.
static double unevenness(const char *potential, const char *stiffness) {
  const double traction = 1000, area = 0.01;
  const char *overrides[] = {potential, stiffness, NULL};
  SceneRun run;
  scene_run(&run, "patch", overrides);
  double worst = 0;
  for (int e = 0; e < run.model.tet_count; e++) {
    double stress[9];
    find_stress(&run, e, stress);
    for (int k = 0; k < 9; k++)
      worst = suite_larger(worst, fabs(stress[k] + (k == 8 ? traction : 0)) / traction);
  }
  ck_assert_near(fabs(scene_force(&run, 1, 0)[2]), traction * area, 1e-6 * traction * area);
  scene_close(&run);
  return worst;
}

// `nodal` has another pressure at the outline, where vertices have fewer elements: the bodies even it out the
// better the less the interface gives way.
START_TEST(stress_passes_an_interface_of_meshes_that_do_not_match) {
  double soft = unevenness("contact.potential=nodal", "contact.stiffness=1e6");
  double hard = unevenness("contact.potential=nodal", "contact.stiffness=1e7");
  printf("worst stress of an element: nodal, κ = E %.4f, κ = 10 E %.4f\n", soft, hard);
  ck_assert(soft <= 0.08);
  ck_assert(hard <= 0.025 && hard < 0.5 * soft);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("indentation");
  tcase_add_test(test_case, a_ball_is_carried_as_hertz_says);
  tcase_add_test(test_case, a_flat_punch_is_carried_as_theory_says);
  tcase_add_test(test_case, a_soft_interface_gives_way);
  tcase_add_test(test_case, stress_passes_an_interface_of_meshes_that_do_not_match);
  return suite_run("indentation", test_case, 120);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Plane strain by holding every vertex across a layer of elements: the closed form of a block that is
// pressed, which linear elements represent exactly.
#include "scene.h"

// The displacement along an axis of the corner that is farthest along all of them.
static double displacement(const SceneRun *run, int axis) {
  const double *rest = run->model.rest;
  int corner = 0;
  for (int v = 0; v < run->model.vertex_count; v++)
    if (rest[3 * v] + rest[3 * v + 1] + rest[3 * v + 2] >
        rest[3 * corner] + rest[3 * corner + 1] + rest[3 * corner + 2])
      corner = v;
  return scene_position(run, 1, corner)[axis] - rest[3 * corner + axis];
}

// σ_x = −p, σ_z = 0, ε_y = 0: ε_x = −p (1 − ν²)/E, ε_z = p ν (1 + ν)/E.
START_TEST(a_slice_shortens_and_bulges_as_in_plane_strain) {
  SceneRun run;
  scene_run(&run, "plane_strain", NULL);
  double p = 1e3, E = 1e6, nu = 0.3;
  ck_assert_near(displacement(&run, 0), -p * (1 - nu * nu) / E * 0.2, 1e-6 * 2e-4);
  ck_assert_near(displacement(&run, 2), p * nu * (1 + nu) / E * 0.1, 1e-6 * 2e-4);
  for (int v = 0; v < run.model.vertex_count; v++)
    ck_assert_double_eq(scene_position(&run, 1, v)[1], run.model.rest[3 * v + 1]);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("plane_strain");
  tcase_add_test(test_case, a_slice_shortens_and_bulges_as_in_plane_strain);
  return suite_run("plane_strain", test_case, 60);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Elastic bodies with smooth surfaces against theory.
#include "scene.h"

// Lamé: of one material, shaft and ring press with δ/R · E/(1 − ν²) · (b² − R²)/(2 b²).
START_TEST(a_shaft_presses_on_its_hole_as_lame_says) {
  SceneRun run;
  scene_run(&run, "shaft", NULL);
  double theory = 0.01 * 1e6 / 0.91 * 3 / 8 * 0.15; // of a quarter, in x as in y
  const double *force = scene_force(&run, run.result.trajectory.frame_count - 1, 0);
  // 17 % with facets as they are; what is left are the sagittas, a quarter of them, over δ
  ck_assert_near(-force[0], theory, 0.05 * theory);
  ck_assert_near(-force[1], theory, 0.05 * theory);
  scene_close(&run);
}
END_TEST

// Nothing is told but the bodies: c and the level are chosen.
START_TEST(a_shaft_presses_as_lame_says_at_the_defaults) {
  SceneRun run;
  scene_run(&run, "../../examples/validation/shaft", (const char *const[]){"solver.threads=1", NULL});
  double theory = 0.01 * 1e6 / 0.91 * 3 / 8 * 0.15;
  int end = run.result.trajectory.frame_count - 1;
  ck_assert_near(-scene_force(&run, end, 0)[0], theory, 0.03 * theory);
  ck_assert_near(-scene_force(&run, end, 0)[1], theory, 0.03 * theory);
  scene_close(&run);
}
END_TEST

// Each bears half of the load. At 2 % of their compression the force between them is four times as large.
START_TEST(two_leaves_of_a_spring_share_the_load) {
  SceneRun run;
  scene_run(&run, "../../examples/validation/leaves",
            (const char *const[]){"solver.threads=1", "bodies.upper.mesh.box.cells=[20, 1, 1]",
                                  "bodies.lower.mesh.box.cells=[17, 1, 1]", NULL});
  ck_assert_near(scene_force(&run, run.result.trajectory.frame_count - 1, 0)[2], 1, 0.1);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("smooth_scenes");
  tcase_add_test(tests, a_shaft_presses_on_its_hole_as_lame_says);
  tcase_add_test(tests, a_shaft_presses_as_lame_says_at_the_defaults);
  tcase_add_test(tests, two_leaves_of_a_spring_share_the_load);
  return suite_run("smooth_scenes", tests, 60);
}

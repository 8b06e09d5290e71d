// SPDX-License-Identifier: GPL-3.0-or-later
// Stability of equilibria: a column under a dead load loses it at Euler's load, and the run tells where.
#include "static_solve.h"

// Length 10, side 1, ν = 0: compressed uniformly, whatever the mesh. P_cr = π² E I/(4 L²), less some 1e-3 for
// shear and compression, plus as much for sixteen quadratic elements along the length.
static void run_column(SceneRun *run, double end) {
  char text[1024];
  double critical = M_PI * M_PI / 12 / 400;
  snprintf(text, sizeof text,
           "time: {end: %g, static: true}\n"
           "output: {frames: 40}\n"
           "bodies:\n"
           "  - name: column\n"
           "    element: quadratic\n"
           "    mesh: {box: {size: [10, 1, 1], cells: [16, 2, 2]}}\n"
           "    material: {law: stvk, young: 1, poisson: 0, density: 1}\n"
           "    fixed: [{group: x_min}]\n"
           "    loads: [{group: x_max, traction: [%.15g, 0, 0], factor: t}]\n"
           "contact: {}\n"
           "obstacles: [{name: far, halfspace: {point: [0, 0, -9], normal: [0, 0, 1]}}]\n",
           end, -critical);
  scene_open_text(run, text);
  scene_run_from(run, NULL);
}

START_TEST(a_column_loses_its_stability_at_eulers_load) {
  SceneRun run;
  char text[4096];
  run_column(&run, 1.2);
  const FemStability *stability = &run.result.equilibrium.stability;
  fem_run_describe_trouble(&run.result, &run.model, text, sizeof text);
  ck_assert_int_gt(stability->unstable, 0);
  ck_assert_int_eq(stability->most, 2); // in y and in z
  ck_assert_double_le(stability->stable_until, 1.005);
  ck_assert_double_ge(stability->unstable_from, 0.99);
  ck_assert_double_le(stability->unstable_from - stability->stable_until, 0.03 + 1e-9); // a step of load
  ck_assert_ptr_nonnull(strstr(text, "unstable equilibria"));
  scene_close(&run);
}
END_TEST

START_TEST(below_it_nothing_is_told) {
  SceneRun run;
  char text[4096];
  run_column(&run, 0.95);
  ck_assert_int_eq(run.status, STATUS_OK);
  fem_run_describe_trouble(&run.result, &run.model, text, sizeof text);
  ck_assert_int_eq(run.result.equilibrium.stability.unstable, 0);
  ck_assert_ptr_null(strstr(text, "unstable"));
  scene_close(&run);
}
END_TEST

// A cube between two plates, free to slide and turn: neutral, not unstable.
START_TEST(what_slides_freely_between_plates_is_not_unstable) {
  SceneRun run;
  scene_open_text(&run, "time: {end: 1, static: true}\n"
                        "output: {frames: 10}\n"
                        "bodies:\n"
                        "  - name: cube\n"
                        "    mesh: {box: {size: [0.04, 0.04, 0.04], cells: 4}}\n"
                        "    material: {young: 1e6, poisson: 0.45, density: 1000}\n"
                        "contact: {}\n"
                        "obstacles:\n"
                        "  - {name: floor, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}\n"
                        "  - name: plate\n"
                        "    halfspace: {point: [0, 0, 0.04], normal: [0, 0, -1]}\n"
                        "    motion: {velocity: [0, 0, -0.016]}\n");
  scene_run_from(&run, NULL);
  ck_assert_int_eq(run.status, STATUS_OK);
  ck_assert_int_eq(run.result.equilibrium.stability.unstable, 0);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("buckling");
  tcase_add_test(test_case, a_column_loses_its_stability_at_eulers_load);
  tcase_add_test(test_case, below_it_nothing_is_told);
  tcase_add_test(test_case, what_slides_freely_between_plates_is_not_unstable);
  return suite_run("buckling", test_case, 60);
}

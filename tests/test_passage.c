// SPDX-License-Identifier: GPL-3.0-or-later
// A run whose bodies passed through each other says so; one whose bodies only met does not.
#include "scene.h"

#include <string.h>

#include "fem/output/trouble.h"

static void expect_passage(const char *const *overrides, bool has_passed) {
  SceneRun run;
  char text[1024];
  scene_run(&run, "pierce", overrides);
  const FemTrouble *trouble = &run.result.trouble;
  int last = run.result.frame_count - 1, stone = run.model.bodies[1].vertex_begin;
  ck_assert_double_gt(run.result.contact_force_max, 0);
  // What truly happened: the stone is on this side of the plate, or on the other.
  ck_assert(has_passed == (scene_position(&run, last, stone)[2] < scene_position(&run, last, 0)[2] - 0.02));
  ck_assert(has_passed == (trouble->of[FEM_TROUBLE_PASSED].steps > 0));
  ck_assert_str_eq(fem_run_outcome(&run.result, run.status), has_passed ? "passed through" : "finished");
  fem_run_tell_trouble(&run.result, &run.model, text, sizeof text);
  ck_assert(has_passed == (strstr(text, "passed through each other: 'plate' and 'stone' at t = ") != NULL));
  scene_close(&run);
}

START_TEST(a_stone_that_goes_through_a_plate_passed) {
  expect_passage((const char *const[]){"contact.stiffness=1e7", NULL}, true);
}
END_TEST

START_TEST(the_same_with_a_potential_without_a_depth) {
  expect_passage((const char *const[]){"contact.potential=nodal", "contact.stiffness=1e4", NULL}, true);
}
END_TEST

START_TEST(a_stone_that_bounces_did_not) {
  expect_passage((const char *const[]){"contact.stiffness=1e10", "time.end=0.006", NULL}, false);
}
END_TEST

// Half of the plate's thickness and more is covered at the deepest.
START_TEST(one_that_bounces_after_a_deep_overlap_did_not) {
  expect_passage((const char *const[]){"contact.stiffness=1e8", NULL}, false);
}
END_TEST

START_TEST(through_an_obstacle_without_a_mesh) {
  SceneRun run;
  const char *const overrides[] = {
      "contact.stiffness=1e7", "bodies.plate.place={translate: [0, 0, -1]}", "bodies.plate.fixed=[]",
      "obstacles=[{name: wall, box: {centre: [0.1, 0.1, 0], size: [0.2, 0.2, 0.01]}}]", NULL};
  scene_run(&run, "pierce", overrides);
  ck_assert_str_eq(fem_run_outcome(&run.result, run.status), "passed through");
  scene_close(&run);
}
END_TEST

START_TEST(strict_makes_it_an_error) {
  SceneRun run;
  scene_open(&run, "pierce", (const char *const[]){"contact.stiffness=1e7", NULL});
  FemRunOptions options = {.is_strict = true};
  run.status = fem_run(&run.model, &options, &run.result);
  ck_assert_int_eq(run.status, STATUS_SOLVER);
  ck_assert_ptr_nonnull(strstr(status_message(), "'plate' and 'stone'"));
  ck_assert_ptr_nonnull(strstr(status_message(), "--strict"));
  ck_assert_double_lt(run.result.end_time, run.scene.end);
  scene_close(&run);
}
END_TEST

// A strip that slides off over an edge, and a stack that stays together, meet but do not pass.
START_TEST(what_slides_rolls_and_sleeps_does_not_pass) {
  static const char *const scenes[] = {"incline", "stack", "drag"};
  for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
    SceneRun run;
    scene_run(&run, scenes[k], (const char *const[]){"time.end=0.1", NULL});
    ck_assert_double_gt(run.result.contact_force_max, 0);
    ck_assert_int_eq((int)run.result.trouble.of[FEM_TROUBLE_PASSED].steps, 0);
    scene_close(&run);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("passage");
  tcase_add_test(cases, a_stone_that_goes_through_a_plate_passed);
  tcase_add_test(cases, the_same_with_a_potential_without_a_depth);
  tcase_add_test(cases, a_stone_that_bounces_did_not);
  tcase_add_test(cases, one_that_bounces_after_a_deep_overlap_did_not);
  tcase_add_test(cases, through_an_obstacle_without_a_mesh);
  tcase_add_test(cases, strict_makes_it_an_error);
  tcase_add_test(cases, what_slides_rolls_and_sleeps_does_not_pass);
  return suite_run("passage", cases, 60);
}

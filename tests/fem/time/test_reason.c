// SPDX-License-Identifier: GPL-3.0-or-later
// What is said of a step that was given up.
#include "fem/time/reason.h"

#include <string.h>

#include "scene.h"

// Of the dropped block, with all points where `mirror` puts them along z.
static void fail_at(double mirror, const char *law) {
  SceneRun run;
  FemSystem system;
  FemState state;
  scene_open(&run, "drop", (const char *const[]){law, NULL});
  ck_assert_ok(fem_system_create(&system, &run.model));
  ck_assert_ok(fem_system_create_state(&system, &state));
  for (int v = 0; v < run.model.vertex_count; v++) state.positions[3 * v + 2] *= mirror;
  FemReason reason = {"the step had no end", "a shorter one"};
  FemReasonPlace place = {
      .time = 1, .step = 1e-3, .positions = state.positions, .velocities = state.velocities, .retry = ""};
  ck_assert_int_eq(fem_reason_fail(&reason, &system, &place), STATUS_SOLVER);
  fem_state_destroy(&state);
  fem_system_destroy(&system);
  scene_close(&run);
}

START_TEST(flat_elements_and_those_inside_out_are_told_with_the_law_that_bears_them) {
  fail_at(-1, "bodies[0].material.law=neo_hookean");
  ck_assert_ptr_nonnull(strstr(status_message(), ". Elements flat or inside out: "));
  ck_assert_ptr_nonnull(strstr(status_message(), "take law: neo_hookean_log"));
  ck_assert_ptr_nonnull(strstr(status_message(), "Try a shorter one"));
  fail_at(1e-9, "bodies[0].material.law=neo_hookean");
  ck_assert_ptr_nonnull(strstr(status_message(), ". Elements flat or inside out: "));
  fail_at(-1, "bodies[0].material.law=neo_hookean_log");
  ck_assert_ptr_nonnull(strstr(status_message(), "its law bears any pressure"));
}
END_TEST

START_TEST(nothing_is_told_of_elements_that_are_whole) {
  fail_at(0.5, "bodies[0].material.law=neo_hookean");
  ck_assert_ptr_null(strstr(status_message(), "inside out"));
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("reason");
  tcase_add_test(tests, flat_elements_and_those_inside_out_are_told_with_the_law_that_bears_them);
  tcase_add_test(tests, nothing_is_told_of_elements_that_are_whole);
  return suite_run("reason", tests, 20);
}

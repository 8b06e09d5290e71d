// SPDX-License-Identifier: GPL-3.0-or-later
// What a step may err by, and what counts as rest: chosen from the scene by fem/model/limits.h.
#include "scene.h"

#include "fem/model/tolerance.h"

// A block on three balls: √(E/ρ) = 31.6 m/s, 0.2 × 0.2 × 0.05 m, time.tolerance 1e-4, gravity.
static void open_block(SceneRun *run) {
  scene_open(run, "balls", (const char *const[]){"time.tolerance=1e-4", NULL});
}

static const double WAVE = 31.622776601683793;

// Of a run that begins at a speed, without gravity.
static double velocity_tolerance(double speed, bool has_contact) {
  SceneRun run;
  open_block(&run);
  run.scene.has_gravity = false;
  run.scene.contact.is_on = has_contact;
  run.scene.bodies[0].velocity[2] = -speed;
  double tolerance = fem_model_velocity_tolerance(&run.model);
  scene_close(&run);
  return tolerance;
}

START_TEST(with_contact_velocities_are_held_to_three_hundredths_of_the_waves_or_of_ten_times_the_motion) {
  const double most = 1e-4 * 0.03 * WAVE, edge = WAVE / 10;
  ck_assert_near(velocity_tolerance(1.001 * edge, true), most, 1e-9 * most);
  ck_assert_near(velocity_tolerance(0.999 * edge, true), 0.999 * most, 1e-9 * most);
  ck_assert_near(velocity_tolerance(0, true), most, 1e-9 * most); // nothing is known of the motion
}
END_TEST

START_TEST(without_contact_positions_are_held_to_three_hundredths_instead) {
  SceneRun run;
  open_block(&run);
  double with = fem_model_position_tolerance(&run.model), falls = sqrt(9.81 * run.model.length);
  ck_assert_near(with, 1e-4 * run.model.length, 1e-12);
  ck_assert_near(fem_model_velocity_tolerance(&run.model), 1e-4 * 0.03 * 10 * falls, 1e-12);
  ck_assert_near(fem_model_speed_share(&run.model), 5e-4, 1e-15);
  run.scene.contact.is_on = false;
  ck_assert_near(fem_model_position_tolerance(&run.model), 0.03 * with, 1e-12);
  ck_assert_near(fem_model_velocity_tolerance(&run.model), 1e-4 * 10 * falls, 1e-12);
  ck_assert_double_eq(fem_model_speed_share(&run.model), 0);
  scene_close(&run);
}
END_TEST

START_TEST(rest_is_a_speed_an_acceleration_and_a_time_of_the_slowest_body) {
  SceneRun run;
  open_block(&run);
  double diagonal = sqrt(3) * cbrt(0.2 * 0.2 * 0.05), time = 20 * diagonal / WAVE, speed = 1e-4 * WAVE;
  ck_assert_near(fem_model_rest_time(&run.model), time, 1e-9 * time);
  ck_assert_near(fem_model_rest_speed(&run.model), speed, 1e-9 * speed);
  ck_assert_near(fem_model_rest_acceleration(&run.model), 5 * speed / time, 1e-9);
  run.scene.contact.rest_time = 1, run.scene.contact.rest_speed = 2;
  ck_assert_near(fem_model_rest_acceleration(&run.model), 10, 1e-12);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("tolerance");
  tcase_add_test(
      cases, with_contact_velocities_are_held_to_three_hundredths_of_the_waves_or_of_ten_times_the_motion);
  tcase_add_test(cases, without_contact_positions_are_held_to_three_hundredths_instead);
  tcase_add_test(cases, rest_is_a_speed_an_acceleration_and_a_time_of_the_slowest_body);
  return suite_run("tolerance", cases, 20);
}

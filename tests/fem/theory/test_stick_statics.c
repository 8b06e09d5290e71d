// SPDX-License-Identifier: GPL-3.0-or-later
// Friction by elastic stick from equilibrium to equilibrium: bodies pressed with friction from the start,
// sliding that turns round, a body that nothing but friction holds.
#include "scene.h"

static double force(const SceneRun *run, int frame, int interface, int axis) {
  return scene_force(run, frame, interface)[axis];
}

static int frame_at(const SceneRun *run, double time) {
  int frame = 0;
  while (frame + 1 < run->result.trajectory.frame_count && run->result.trajectory.times[frame] < time - 1e-9)
    frame++;
  return frame;
}

// Pushed in, bent, free behind the catch, then holding.
START_TEST(a_snap_fit_comes_to_its_end_and_holds) {
  SceneRun run;
  scene_run(&run, "../../examples/30_snap_fit",
            (const char *const[]){"output.vtu=false", "solver.threads=1", NULL});
  int flat = frame_at(&run, 0.5), end = frame_at(&run, 1);
  ck_assert_double_lt(force(&run, frame_at(&run, 0.2), 0, 0), -0.05);
  ck_assert_near(force(&run, flat, 0, 0) / force(&run, flat, 0, 2), 0.2, 1e-3); // slides below the catch
  ck_assert_near(force(&run, frame_at(&run, 0.7), 0, 0), 0, 1e-9);              // free
  ck_assert_double_gt(force(&run, end, 0, 0), 0.5);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

// The floor, the walls and the plate are interfaces 0, 1, 2, 3.
START_TEST(a_seal_is_pressed_into_its_groove) {
  SceneRun run;
  scene_run(&run, "../../examples/31_seal",
            (const char *const[]){"output.vtu=false", "output.frames=20", "solver.threads=1", NULL});
  int end = run.result.trajectory.frame_count - 1;
  double floor = force(&run, end, 0, 2), left = force(&run, end, 1, 0), right = force(&run, end, 2, 0);
  ck_assert_int_eq(run.result.trajectory.interface_count, 4);
  ck_assert_double_gt(floor, 50);
  ck_assert_double_gt(left, 10);
  ck_assert_near(left, -right, 0.02 * left);
  for (int axis = 0; axis < 3; axis += 2) {
    double sum = 0;
    for (int i = 0; i < 4; i++) sum += force(&run, end, i, axis);
    ck_assert_near(sum, 0, 1e-5 * floor);
  }
  for (int i = 1; i < 3; i++)
    ck_assert_double_le(fabs(force(&run, end, i, 2)), 0.3 * fabs(force(&run, end, i, 0)) + 1e-9);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

// Euler's T2/T1 = e^(mu phi), at a turn of pi; the drum bears both ends.
START_TEST(a_strip_round_a_drum_is_held_by_the_exponential_of_its_angle) {
  SceneRun run;
  scene_run(&run, "../../examples/validation/capstan",
            (const char *const[]){"output.frames=10", "solver.threads=1", NULL});
  double slack = 1000, all = force(&run, run.result.trajectory.frame_count - 1, 0, 2),
         theory = exp(0.3 * acos(-1));
  ck_assert_near((all - slack) / slack, theory, 0.02 * theory);
  ck_assert_double_gt(run.result.energy.audit.dissipated, 0);
  scene_close(&run);
}
END_TEST

// A ball 125 elements of the ground wide: cells that it hardly touches rub smoothly, too, or Newton's method
// would stay at 1e-5 N. Without friction it takes 28 iterations in the 4 steps.
START_TEST(a_ball_is_pressed_with_friction_in_as_many_iterations_as_a_smooth_force_takes) {
  SceneRun run;
  scene_run(&run, "../../examples/26_hertz",
            (const char *const[]){"contact.friction=0.3", "output.vtu=false", "solver.threads=1", NULL});
  int end = run.result.trajectory.frame_count - 1;
  ck_assert_int_le(run.result.integrator.newton_iterations, 44); // of a force with noise 63 and more
  ck_assert_double_le(run.result.equilibrium.residual, run.result.equilibrium.residual_allowed);
  // Friction keeps the ground from moving outwards: the ball presses with more, by some per cents at most
  // (Spence, J. Elasticity 5, 1975).
  ck_assert_double_gt(-force(&run, end, 0, 2), 49.02);
  ck_assert_double_lt(-force(&run, end, 0, 2), 1.05 * 49.02);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("stick_statics");
  tcase_add_test(test_case, a_snap_fit_comes_to_its_end_and_holds);
  tcase_add_test(test_case, a_seal_is_pressed_into_its_groove);
  tcase_add_test(test_case, a_strip_round_a_drum_is_held_by_the_exponential_of_its_angle);
  tcase_add_test(test_case, a_ball_is_pressed_with_friction_in_as_many_iterations_as_a_smooth_force_takes);
  return suite_run("stick_statics", test_case, 120);
}

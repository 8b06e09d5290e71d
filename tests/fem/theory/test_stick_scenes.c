// SPDX-License-Identifier: GPL-3.0-or-later
// Friction by elastic stick in motion: what sticks stays, and what is written is what holds it.
#include "static_solve.h"

#include <stdio.h>

#include "base/vec3.h"

// A block on a slope of atan ½, with the potential `field`.
static void run_incline(SceneRun *run, const char *friction, const char *tolerance, const char *end) {
  scene_run(run, "incline",
            (const char *const[]){"contact.potential=field", "contact.overlap=clip",
                                  "contact.stiffness=3.5e7", friction, tolerance, end, NULL});
}

// Of a body's vertices.
static Vec3 centre(const SceneRun *run, int frame) {
  Vec3 sum = {0, 0, 0};
  for (int v = 0; v < run->model.vertex_count; v++)
    sum = vec3_add(sum, vec3_scale(run->model.mass[v] / run->model.bodies[0].mass,
                                   vec3_at(scene_position(run, frame, v))));
  return sum;
}

START_TEST(on_a_slope_of_one_half_a_block_sticks_at_0_51) {
  SceneRun run;
  run_incline(&run, "contact.friction=0.51", "time.tolerance=1e-4", "time.end=10");
  int last = run.result.trajectory.frame_count - 1;
  double moved = vec3_length(vec3_sub(centre(&run, last), centre(&run, last / 2)));
  double weight = run.model.bodies[0].mass * 9.81;
  const double *force = scene_force(&run, last, 0);
  ck_assert_double_le(moved, 1e-7);
  ck_assert_near(force[0], -weight / sqrt(5), 1e-3 * weight);
  ck_assert_near(force[2], 2 * weight / sqrt(5), 1e-3 * weight);
  scene_close(&run);
}
END_TEST

// Acceleration over the last half of the run, from three frames.
static double acceleration(const SceneRun *run) {
  int last = run->result.trajectory.frame_count - 1, half = last / 2, middle = (half + last) / 2;
  double h = run->result.trajectory.times[last] - run->result.trajectory.times[middle],
         g = run->result.trajectory.times[middle] - run->result.trajectory.times[half];
  double late = (centre(run, last).x - centre(run, middle).x) / h,
         early = (centre(run, middle).x - centre(run, half).x) / g;
  return 2 * (late - early) / (h + g);
}

// _i: tolerance.
START_TEST(on_a_slope_of_one_half_a_block_slides_at_0_49) {
  static const char *const tolerances[] = {"time.tolerance=1e-4", "time.tolerance=1e-6"};
  static const double bounds[] = {1e-2, 1e-3};
  SceneRun run;
  run_incline(&run, "contact.friction=0.49", tolerances[_i], "time.end=1");
  double theory = 9.81 * (1 - 0.49 * 2) / sqrt(5); // g (sin θ − μ cos θ)
  ck_assert_near(acceleration(&run), theory, bounds[_i] * theory);
  ck_assert_double_gt(run.result.energy.audit.dissipated, 0);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

// _i: longest step, the chosen one, and shorter ones.
START_TEST(a_cube_held_between_plates_is_carried_by_what_is_written) {
  static const char *const steps[] = {"time.tolerance=1e-4", "time.max_step=0.02", "time.max_step=0.005"};
  SceneRun run;
  scene_run(&run, "held", (const char *const[]){steps[_i], NULL});
  double weight = run.model.bodies[0].mass * 9.81;
  ck_assert_near(weight, 3.924, 1e-9);
  int held = 0;
  for (int frame = 0; frame < run.result.trajectory.frame_count; frame++) {
    if (run.result.trajectory.times[frame] < 0.5) continue; // the table has gone at 0.45 s
    Vec3 sum = {0, 0, 0};
    for (int i = 0; i < run.result.trajectory.interface_count; i++)
      sum = vec3_add(sum, vec3_at(scene_force(&run, frame, i)));
    ck_assert_near(sum.z, weight, 1e-3 * weight);
    ck_assert_near(sum.y, 0, 1e-3 * weight);
    ck_assert_near(sum.x, 0, 1e-3 * weight);
    held++;
  }
  ck_assert_int_gt(held, 20);
  int last = run.result.trajectory.frame_count - 1;
  ck_assert_near(vec3_length(vec3_sub(centre(&run, last), centre(&run, last - 20))), 0, 1e-7);
  scene_close(&run);
}
END_TEST

// Coulomb's friction turns a solid ball's sliding into rolling at 5/7 of its speed, v / (1 + I/(m R²)): here
// with the inertia of the mesh, whose masses are at its vertices, and the height of its centre.
START_TEST(a_ball_that_slides_rolls_on_at_what_its_inertia_leaves) {
  SceneRun run;
  scene_run(&run, "bowl", NULL);
  int last = run.result.trajectory.frame_count - 1, from = last / 2;
  double inertia = 0, mass = run.model.bodies[0].mass, height = 0;
  Vec3 start = centre(&run, 0);
  for (int v = 0; v < run.model.vertex_count; v++) {
    Vec3 arm = vec3_sub(vec3_at(scene_position(&run, 0, v)), start);
    inertia += run.model.mass[v] * (arm.x * arm.x + arm.z * arm.z);
  }
  for (int frame = from; frame <= last; frame++) height += centre(&run, frame).z / (last - from + 1);
  double time = run.result.trajectory.times[last] - run.result.trajectory.times[from];
  double speed = (centre(&run, last).x - centre(&run, from).x) / time;
  double theory = 1 / (1 + inertia / (mass * height * height));
  ck_assert_near(theory, 5.0 / 7, 0.05); // what the mesh is worth
  ck_assert_near(speed, theory, 0.01 * theory);
  scene_close(&run);
}
END_TEST

// A block dragged over a block that is meshed otherwise, from equilibrium to equilibrium: T = μN, and what is
// put in is dissipated, that of the overlap at the start included.
// A shear beam on a belt: sticking it takes G v t/H, c d's spring included, until that is μ p; then it slips,
// and swings like a free end that had the belt's speed, by v H/(2 c).
START_TEST(a_block_on_a_belt_breaks_away_and_slips_at_mu_p) {
  SceneRun run;
  scene_run(&run, "../../examples/validation/belt", (const char *const[]){"solver.threads=1", NULL});
  double area = 4e-4, swing = 0, slip = 0.5 * 1e4 * area, speed = 0.002;
  for (int f = 10; f < run.result.trajectory.frame_count; f++) {
    double time = run.result.trajectory.times[f], force = scene_force(&run, f, 0)[0];
    double stick = speed * (time - 0.05) / (0.1 / 5e5 + 1e-9) * area;
    if (time < 0.55) ck_assert_near(force, stick, 0.01 * slip);
    if (time < 0.555) continue;
    ck_assert_near(force, slip, 1e-6 * slip);
    swing = fmax(swing, scene_position(&run, f, 0)[0] - run.model.rest[0] - 0.001);
  }
  // not all of it: frames miss the turn
  ck_assert_double_le(swing, 1.1 * speed * 0.1 / (2 * sqrt(500)));
  ck_assert_double_ge(swing, 0.5 * speed * 0.1 / (2 * sqrt(500)));
  scene_close(&run);
}
END_TEST

// A mass on a spring between stick and slip (Den Hartog, Mechanical Vibrations, 7.6): from μ_s N to (2 μ −
// μ_s) N and back; it sticks for 2 (μ_s − μ) N/(K V) and slips for 2/ω (π − atan((μ_s − μ) N ω/(K V))).
START_TEST(a_block_on_a_belt_sticks_and_slips_in_turn) {
  SceneRun run;
  scene_run(&run, "../../examples/validation/stick_slip", (const char *const[]){"solver.threads=1", NULL});
  const double K = 200, N = 4, V = 0.02, w = sqrt(200), drop = 0.2 * N / K;
  const double sticks = 2 * drop / V, slips = 2 / w * (M_PI - atan(drop * w / V));
  double lows[8], most = 0, least = INFINITY;
  int count = 0, last = run.result.trajectory.frame_count - 1;
  for (int f = 100; f <= last; f++) {
    double x = scene_position(&run, f, 0)[0] - run.model.rest[0];
    most = fmax(most, x), least = fmin(least, x);
    double before = scene_position(&run, f - 1, 0)[0], now = scene_position(&run, f, 0)[0];
    bool turns = f < last && now < before && now <= scene_position(&run, f + 1, 0)[0];
    if (turns && count < 8) lows[count++] = run.result.trajectory.times[f];
  }
  ck_assert_int_ge(count, 2);
  // Frames are .01 s apart.
  ck_assert_near((lows[count - 1] - lows[0]) / (count - 1), sticks + slips, 0.02 * (sticks + slips));
  // The swing passes the points where it sticks by the belt's speed.
  double swing = sqrt(drop * drop + V * V / (w * w));
  ck_assert_near(most, 0.3 * N / K + swing, 0.02 * swing);
  ck_assert_near(least, 0.3 * N / K - swing, 0.02 * swing);
  ck_assert_double_lt(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

// A stiff block of 39.24 N is drawn at its foot, which does not tilt it, ever harder until t = .8 s: it holds
// up to .6 of its weight, which is at .771 s, and is then accelerated by (25 N − .3 · 39.24 N)/4 kg.
START_TEST(a_block_breaks_away_at_mu_s_and_slides_at_mu) {
  SceneRun run;
  scene_run(&run, "incline",
            (const char *const[]){
                "contact.potential=field", "contact.overlap=clip", "contact.stiffness=3.5e7",
                "bodies.block.material.young=1e8", "contact.friction={coefficient: 0.3, static: 0.6}",
                "effects.gravity=[0, 0, -9.81]", "time.tolerance=1e-4",
                "bodies.block.loads=[{group: z_min, force: [25, 0, 0], table: [[0.3, 0], [0.8, 1]]}]", NULL});
  double start = centre(&run, 5).x;
  ck_assert_double_le(fabs(centre(&run, 15).x - start), 5e-5); // 22.5 N of 23.5
  ck_assert_double_ge(centre(&run, 16).x - start, 5e-4);
  double a = (centre(&run, 20).x - 2 * centre(&run, 18).x + centre(&run, 16).x) / (0.1 * 0.1);
  double expected = (25 - 0.3 * 39.24) / 4;
  ck_assert_near(a, expected, 0.01 * expected);
  ck_assert_double_lt(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

START_TEST(static_scenes_have_friction) {
  SceneRun run;
  scene_run(&run, "drag", NULL);
  int last = run.result.trajectory.frame_count - 1;
  for (int frame = 5; frame <= last; frame++) {
    const double *force = scene_force(&run, frame, 0);
    ck_assert_double_gt(force[2], 30);
    ck_assert_near(-force[0] / force[2] / 0.4, 1, 3e-4);
    ck_assert_near(force[1], 0, 1e-3 * force[2]);
  }
  const double given = run.result.energy.audit.work + run.result.energy.audit.first;
  ck_assert_double_gt(given, 0.2);
  ck_assert_near(run.result.energy.audit.dissipated, given, 2e-2 * given); // the rest is stored
  scene_close(&run);
}
END_TEST

// Thrown uphill it stops after .06 s and slides back: a step that ends beyond the turn would push it on.
START_TEST(what_slides_uphill_turns_where_it_stops) {
  static const char *const tolerances[] = {"1e-4", "1e-6"};
  Vec3 end[2];
  double length = 0;
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    char text[1024];
    snprintf(text, sizeof text,
             "time: {end: 1, tolerance: %s}\n"
             "effects: {gravity: [4.38716537, 0, -8.77433075]}\n"
             "bodies:\n"
             "  - name: up\n"
             "    mesh: {box: {size: [0.2, 0.2, 0.1], cells: [4, 4, 2]}}\n"
             "    material: {young: 1e6, poisson: 0.4, density: 1000, damping: 0.01}\n"
             "    velocity: [-0.5, 0, 0]\n"
             "obstacles: [{name: slope, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
             "contact: {friction: 0.49}\n"
             "output: {frames: 10, vtu: false}\n",
             tolerances[k]);
    scene_open_text(&run, text);
    scene_run_from(&run, NULL);
    ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
    end[k] = centre(&run, run.result.trajectory.frame_count - 1);
    // It went up, turned, slipped down past where it had been, and friction took energy all the while.
    double start = centre(&run, 0).x, high = centre(&run, 1).x;
    ck_assert_double_lt(high, start - 0.01);
    ck_assert_double_gt(end[k].x, high + 0.01);
    ck_assert_double_gt(run.result.energy.audit.dissipated, 0);
    length = run.model.length;
    scene_close(&run);
  }
  ck_assert_double_le(vec3_length(vec3_sub(end[0], end[1])), 5e-3 * length);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("stick_scenes");
  tcase_add_test(test_case, on_a_slope_of_one_half_a_block_sticks_at_0_51);
  tcase_add_loop_test(test_case, on_a_slope_of_one_half_a_block_slides_at_0_49, 0, 2);
  tcase_add_test(test_case, what_slides_uphill_turns_where_it_stops);
  tcase_add_loop_test(test_case, a_cube_held_between_plates_is_carried_by_what_is_written, 0, 3);
  tcase_add_test(test_case, a_ball_that_slides_rolls_on_at_what_its_inertia_leaves);
  tcase_add_test(test_case, a_block_on_a_belt_breaks_away_and_slips_at_mu_p);
  tcase_add_test(test_case, a_block_on_a_belt_sticks_and_slips_in_turn);
  tcase_add_test(test_case, a_block_breaks_away_at_mu_s_and_slides_at_mu);
  tcase_add_test(test_case, static_scenes_have_friction);
  return suite_run("stick_scenes", test_case, 120);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The steps that a run with contact takes: that few of them fail, that none is short for nothing, and what
// the error test lets pass.
#include "scene.h"

#include <string.h>

#include "base/vec3.h"
#include "fem/model/tolerance.h"
#include "fem/time/error_weights.h"

// Of a stack that falls and comes to rest.
static void run_slabs(SceneRun *run, const char *potential) {
  scene_run(run, "slabs",
            (const char *const[]){"bodies.low.mesh.box.cells=[2, 2, 1]",
                                  "bodies.middle.mesh.box.cells=[3, 3, 2]",
                                  "bodies.top.mesh.box.cells=[4, 4, 2]", potential, NULL});
}

static double kinetic_speed(const SceneRun *run, int frame) {
  double largest = 0;
  double duration = run->result.trajectory.times[frame] - run->result.trajectory.times[frame - 1];
  for (int v = 0; v < run->model.vertex_count; v++) {
    Vec3 moved = vec3_sub(vec3_at(scene_position(run, frame, v)), vec3_at(scene_position(run, frame - 1, v)));
    largest = suite_larger(vec3_length(moved) / duration, largest);
  }
  return largest;
}

START_TEST(a_stack_falls_on_an_incline_and_comes_to_rest_without_short_or_failing_steps) {
  SceneRun run;
  run_slabs(&run, "contact.potential=field");
  const FemIntegratorStats *stats = &run.result.integrator;
  int last = run.result.trajectory.frame_count - 1;
  ck_assert_double_gt(kinetic_speed(&run, 4), 0.1);
  ck_assert_double_le(kinetic_speed(&run, last), 1e-4);
  ck_assert_int_le(stats->newton_failures, stats->steps / 10);
  ck_assert_double_ge(run.result.trouble.smallest_step, 1e-6);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  // Balance on the incline: friction carries what pulls downhill.
  double mass = 0;
  for (int b = 0; b < 3; b++) mass += run.model.bodies[b].mass;
  double weight = mass * vec3_length(vec3_at(run.scene.gravity)), carried = 0, pressed = 0;
  for (int i = 3; i < 6; i++) {
    carried -= scene_force(&run, last, i)[0];
    pressed += scene_force(&run, last, i)[2];
  }
  ck_assert_near(carried, 3.355217608 / 9.81 * weight, 1e-3 * weight);
  ck_assert_near(pressed, 9.218384816 / 9.81 * weight, 1e-3 * weight);
  scene_close(&run);
}
END_TEST

// The force begins at zero, so the integrator goes through the onset of contact without beginning anew.
START_TEST(an_onset_restarts_nothing_and_gains_no_energy) {
  const char *const potentials[] = {"contact.potential=field", "contact.potential=nodal"};
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    scene_run(&run, "collision", (const char *const[]){potentials[k], NULL});
    ck_assert_double_gt(run.result.contact.force_max, 0);
    ck_assert_int_eq(run.result.integrator.restarts, run.result.retries.energy + run.result.retries.momentum);
    ck_assert_double_le(scene_gain(&run), 1e-3);
    scene_close(&run);
  }
}
END_TEST

// A matrix of before it turned does not balance a stiff body: what Newton's method leaves of the balance
// works on it.
START_TEST(a_stiff_body_that_turns_freely_keeps_its_energy) {
  const char *const stiff[] = {"bodies.block.material.young=1e6", "bodies.block.material.young=1e8",
                               "effects.damping=0"};
  const double gain[] = {3e-4, 3e-3, 3e-3};
  for (int k = 0; k < 3; k++) {
    SceneRun run;
    scene_run(&run, "turning", (const char *const[]){stiff[k], NULL});
    ck_assert_double_le(scene_gain(&run), gain[k]);
    ck_assert_int_le(run.result.integrator.steps, 300);
    scene_close(&run);
  }
}
END_TEST

// The stiffer, the more the matrix of damping must leave rotations alone.
START_TEST(how_stiff_a_damped_body_is_does_not_decide_how_many_steps_it_turns_in) {
  SceneRun run;
  scene_run(&run, "turning", (const char *const[]){"bodies.block.material.young=1e10", NULL});
  ck_assert_int_le(run.result.integrator.steps, 400);
  ck_assert_int_le(run.result.integrator.newton_failures, 10);
  scene_close(&run);
}
END_TEST

START_TEST(a_wedge_is_thrown_out_of_a_gap_and_flies_on_without_short_steps) {
  SceneRun run;
  scene_run(&run, "wedge", (const char *const[]){"time.end=0.25", NULL});
  ck_assert_double_le(scene_gain(&run), 1.2e-3);
  ck_assert_int_le(run.result.integrator.steps, 1200);
  ck_assert_double_ge(run.result.trouble.smallest_step, 1e-6);
  scene_close(&run);
}
END_TEST

// Two bodies of one element each, the second ten times as stiff.
static void open_two(SceneRun *run) {
  scene_open(run, "single_tets", NULL);
  ck_assert_int_eq(run->model.body_count, 2);
  run->model.parts[1].material = run->model.parts[0].material;
  run->model.parts[1].material.young *= 100;
}

START_TEST(a_velocity_may_err_by_a_share_of_the_fastest_bodys_speed_within_its_bounds) {
  SceneRun run;
  open_two(&run);
  int n = run.model.free_count;
  FemPart part;
  FemNumbering numbering;
  ck_assert_ok(fem_numbering_create(&numbering, &run.model));
  ck_assert_ok(fem_part_create(&part, &run.model, &numbering));
  double *v = calloc((size_t)n, sizeof *v), *weights = calloc(2 * (size_t)n, sizeof *weights);
  FemErrorGroup groups[2];
  const FemMaterial *soft = &run.model.parts[0].material;
  double wave = sqrt(soft->young / soft->density);
  FemErrorTolerance tolerance = {.displacement = 1e-5, .velocity = 1e-6 * wave, .speed_share = 1e-3};
  const double speeds[] = {0, 0.02 * wave, 2 * wave}; // of the first body, along z
  const double expected[][2] = {{1e-6, 1e-6}, {2e-5, 2e-5}, {1e-3, 2e-3}};
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < n; i++) {
      int dof = numbering.dof_of_unknown[i];
      v[i] = dof % 3 == 2 && dof / 3 < run.model.bodies[0].vertex_end ? speeds[k] : 0;
    }
    fem_error_weights(&tolerance, &run.model, &part, NULL, v, groups, weights);
    for (int i = 0; i < n; i++) {
      int body = numbering.dof_of_unknown[i] / 3 >= run.model.bodies[0].vertex_end;
      ck_assert_near(weights[i], 1e5, 1e-6);
      ck_assert_near(1 / weights[n + i], expected[k][body] * wave, 1e-9 * wave);
    }
  }
  fem_error_weights(&tolerance, &run.model, &part, (const int[]){0, 1}, v, groups, weights);
  for (int i = 0; i < n; i++) { // the second has pressed nothing: it does not move
    int body = numbering.dof_of_unknown[i] / 3 >= run.model.bodies[0].vertex_end;
    ck_assert_near(1 / weights[n + i], (body ? 1e-6 : 1e-3) * wave, 1e-9 * wave);
  }
  v[0] = NAN;
  fem_error_weights(&tolerance, &run.model, &part, NULL, v, groups, weights);
  for (int i = 0; i < 2 * n; i++) ck_assert(weights[i] > 0 && isfinite(weights[i]));
  free(v), free(weights);
  fem_numbering_destroy(&numbering);
  scene_close(&run);
}
END_TEST

START_TEST(what_a_mesh_obstacle_is_made_of_is_no_body_here) {
  SceneRun run;
  scene_open(&run, "tiles", NULL);
  int n = run.model.free_count, bodies = run.scene.body_count;
  ck_assert_int_gt(run.model.body_count, bodies);
  FemPart part;
  FemNumbering numbering;
  ck_assert_ok(fem_numbering_create(&numbering, &run.model));
  ck_assert_ok(fem_part_create(&part, &run.model, &numbering));
  double *v = calloc((size_t)n, sizeof *v), *weights = calloc(2 * (size_t)n, sizeof *weights);
  FemErrorGroup *groups = calloc((size_t)bodies + 1, sizeof *groups);
  groups[bodies].speed = -1;
  FemErrorTolerance tolerance = {.displacement = 1e-5, .velocity = 1e-6, .speed_share = 1e-3};
  fem_error_weights(&tolerance, &run.model, &part, NULL, v, groups, weights);
  ck_assert_double_eq(groups[bodies].speed, -1);
  for (int i = 0; i < n; i++) ck_assert_near(weights[n + i], 1e6, 1);
  free(v), free(weights), free(groups);
  fem_numbering_destroy(&numbering);
  scene_close(&run);
}
END_TEST

START_TEST(a_tolerance_that_the_scene_gives_is_all_there_is) {
  const char *const given[] = {"time.velocity_tolerance=1e-3", "time.tolerance=1e-4"};
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    scene_open(&run, "collision", (const char *const[]){given[k], NULL});
    double share = fem_model_speed_share(&run.model);
    ck_assert_msg((share > 0) == (k == 1), "%s: a share of %g", given[k], share);
    scene_close(&run);
  }
}
END_TEST

// Two runs of a scene whose bodies share a velocity in the second: as many steps, and the same places but for
// the way of it and what rounding makes of them, within a distance.
static void compare_frames(const char *scene, const char *const *still, const char *const *moving,
                           const double common[3], double distance) {
  SceneRun a, b;
  scene_run(&a, scene, still);
  scene_run(&b, scene, moving);
  ck_assert_double_gt(a.result.contact.force_max, 0);
  ck_assert_int_le(llabs(a.result.integrator.steps - b.result.integrator.steps),
                   1 + a.result.integrator.steps / 20);
  ck_assert_near(scene_gain(&a), scene_gain(&b), 1e-4);
  ck_assert_near(a.result.momentum.gap, b.result.momentum.gap, 3e-4);
  int last = a.result.trajectory.frame_count - 1;
  for (int v = 0; v < a.model.vertex_count; v++)
    for (int c = 0; c < 3; c++) {
      double way = common[c] * a.result.trajectory.times[last];
      ck_assert_near(scene_position(&b, last, v)[c] - way, scene_position(&a, last, v)[c], distance);
    }
  scene_close(&a), scene_close(&b);
}

START_TEST(a_common_velocity_of_bodies_that_float_changes_nothing) {
  const char *const still[] = {"bodies.left.velocity=[3, 0, 0]", NULL};
  const char *const moving[] = {"bodies.left.velocity=[13, 5, -3]", "bodies.right.velocity=[10, 5, -3]",
                                NULL};
  compare_frames("collision", still, moving, (const double[]){10, 5, -3}, 1e-6);
}
END_TEST

// The block rings undamped after its blow: rounding alone changes its steps, and its places by a thousandth
// of its size.
START_TEST(a_common_velocity_along_a_plane_changes_nothing) {
  const char *const moving[] = {"bodies.block.velocity=[10, -4, 0]", NULL};
  compare_frames("drop", NULL, moving, (const double[]){10, -4, 0}, 2e-4);
}
END_TEST

// The forces of a small network give energy while little of it is in the scene: without a way out the run
// creeps in steps of a millionth of a second.
START_TEST(what_a_learned_volume_gains_by_itself_makes_no_steps_short) {
  SceneRun run;
  scene_run(&run, "../../examples/precision/press", (const char *const[]){"contact.overlap=geo-small", NULL});
  ck_assert_int_gt(run.result.retries.energy, 0);
  ck_assert_int_le(run.result.retries.energy, run.result.integrator.steps / 10);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

// The first search, before any step, is longer than all other contact.
START_TEST(no_phase_of_a_run_takes_less_than_no_time) {
  SceneRun run;
  scene_run(&run, "stack", (const char *const[]){"time.end=1e-5", NULL});
  const FemRunPhases *phases = &run.result.cost.phases;
  ck_assert_double_gt(phases->broad_phase, 0);
  ck_assert_double_gt(phases->contact, 0);
  ck_assert_double_ge(phases->total, phases->broad_phase + phases->overlap + phases->contact);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("steps");
  tcase_add_test(cases, a_stack_falls_on_an_incline_and_comes_to_rest_without_short_or_failing_steps);
  tcase_add_test(cases, a_stiff_body_that_turns_freely_keeps_its_energy);
  tcase_add_test(cases, how_stiff_a_damped_body_is_does_not_decide_how_many_steps_it_turns_in);
  tcase_add_test(cases, a_wedge_is_thrown_out_of_a_gap_and_flies_on_without_short_steps);
  tcase_add_test(cases, an_onset_restarts_nothing_and_gains_no_energy);
  tcase_add_test(cases, a_velocity_may_err_by_a_share_of_the_fastest_bodys_speed_within_its_bounds);
  tcase_add_test(cases, what_a_mesh_obstacle_is_made_of_is_no_body_here);
  tcase_add_test(cases, a_tolerance_that_the_scene_gives_is_all_there_is);
  tcase_add_test(cases, a_common_velocity_of_bodies_that_float_changes_nothing);
  tcase_add_test(cases, a_common_velocity_along_a_plane_changes_nothing);
  tcase_add_test(cases, what_a_learned_volume_gains_by_itself_makes_no_steps_short);
  tcase_add_test(cases, no_phase_of_a_run_takes_less_than_no_time);
  return suite_run("steps", cases, 120);
}

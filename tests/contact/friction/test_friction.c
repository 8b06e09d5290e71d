// SPDX-License-Identifier: GPL-3.0-or-later
// Coulomb friction in whole scenes against theory: a block on a slope, a cube that slides over tiles.
#include "scene.h"

#include <string.h>
#include <unistd.h>

#include "base/vec3.h"
#include "fem/output/vtk/vtu_read.h"

// The slope of the centre's velocity along x over the second half, by its positions: x = a t²/2 + v t + x0.
static double acceleration_at_end(const SceneRun *run) {
  int last = run->result.trajectory.frame_count - 1, half = last / 2;
  double x[3], dt = run->result.trajectory.times[last] - run->result.trajectory.times[last - half / 2];
  for (int k = 0; k < 3; k++) {
    x[k] = 0;
    for (int a = 0; a < run->model.vertex_count; a++)
      x[k] +=
          run->model.mass[a] * scene_position(run, last - k * (half / 2), a)[0] / run->model.bodies[0].mass;
  }
  return (x[0] - 2 * x[1] + x[2]) / (dt * dt);
}

static double centre_x(const SceneRun *run, int frame) {
  double x = 0;
  for (int a = run->model.bodies[0].vertex_begin; a < run->model.bodies[0].vertex_end; a++)
    x += run->model.mass[a] * scene_position(run, frame, a)[0] / run->model.bodies[0].mass;
  return x;
}

START_TEST(a_block_on_a_slope_of_one_half_sticks_at_0_51) {
  SceneRun run;
  scene_run(&run, "incline", NULL);
  int last = run.result.trajectory.frame_count - 1;
  double creep = centre_x(&run, last) - centre_x(&run, last / 2);
  ck_assert_double_lt(fabs(creep), 1e-6 * run.model.length);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

START_TEST(a_block_on_a_slope_of_one_half_slides_at_0_49) {
  SceneRun run;
  scene_run(&run, "incline", (const char *const[]){"contact.friction=0.49", NULL});
  double theory = 9.81 * (1 - 0.49 * 2) / sqrt(5); // g (sin θ − μ cos θ)
  ck_assert_near(theory, 0.0877, 1e-4);
  ck_assert_near(acceleration_at_end(&run), theory, 0.01 * theory);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

START_TEST(on_a_slope_of_15_degrees_the_forces_carry_the_weight) {
  SceneRun run;
  double slope = M_PI / 12, g = 9.81;
  char gravity[128];
  snprintf(gravity, sizeof gravity, "effects.gravity=[%.17g, 0, %.17g]", g * sin(slope), -g * cos(slope));
  scene_run(&run, "incline", (const char *const[]){gravity, NULL});
  double weight = run.model.bodies[0].mass * g;
  const double *force = scene_force(&run, run.result.trajectory.frame_count - 1, 0);
  ck_assert_near(force[0], -weight * sin(slope), 5e-4 * weight);
  ck_assert_near(force[1], 0, 5e-4 * weight);
  ck_assert_near(force[2], weight * cos(slope), 5e-4 * weight);
  scene_close(&run);
}
END_TEST

// The sum over a frame's vertices of a field's x; NAN if the frame lacks it.
static double sum_of_field(const char *folder, const char *name) {
  char path[128];
  FemVtuContent frame;
  double sum = NAN;
  snprintf(path, sizeof path, "%s/frame_00001.vtu", folder);
  ck_assert_ok(fem_vtu_read(path, &frame));
  for (int f = 0; f < frame.field_count; f++) {
    if (strcmp(frame.fields[f].name, name) != 0) continue;
    sum = 0;
    for (int v = 0; v < frame.vertex_count; v++) sum += frame.fields[f].values[3 * v];
  }
  fem_vtu_read_destroy(&frame);
  return sum;
}

START_TEST(frames_show_friction_apart_from_pressure) {
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    char folder[] = "/tmp/tetlap_friction_XXXXXX", command[64];
    ck_assert_ptr_nonnull(mkdtemp(folder));
    scene_open(&run, "incline",
               (const char *const[]){"time.end=0.2", "output.frames=1", "output.vtu=true",
                                     k ? "contact.friction=0" : "contact.friction=0.3", NULL});
    ck_assert_ok(fem_run(&run.model, &(FemRunOptions){.directory = folder}, &run.result));
    // The slope is level: what the frame calls contact force has no part along it, friction has no other.
    double weight = run.model.bodies[0].mass * 9.81;
    ck_assert_near(sum_of_field(folder, "contact_force"), 0, 1e-9 * weight);
    double rubbed = sum_of_field(folder, "friction_force");
    if (k == 0) ck_assert_near(rubbed, -0.3 * weight * cos(atan(0.5)), 0.02 * weight); // it slides
    if (k == 1) ck_assert(isnan(rubbed));
    scene_close(&run);
    snprintf(command, sizeof command, "rm -r %s", folder);
    ck_assert_int_eq(system(command), 0);
  }
}
END_TEST

START_TEST(without_friction_no_friction_is_created) {
  SceneRun run;
  scene_open(&run, "incline", (const char *const[]){"contact.friction=0", NULL});
  FemSystem system;
  ck_assert_ok(fem_system_create(&system, &run.model));
  ck_assert_ptr_nonnull(fem_system_effect(&system, &fem_effect_contact));
  ck_assert_ptr_null(fem_system_effect(&system, &fem_effect_stick));
  fem_system_destroy(&system);
  scene_close(&run);
}
END_TEST

START_TEST(a_cube_slides_over_coplanar_tiles_without_a_kick) {
  SceneRun run;
  scene_run(&run, "tiles", NULL);
  ck_assert_int_gt(run.result.contact.pairs_max, 0);
  // Σ over the tiles of the force on the cube, and how far the cube came.
  int last = run.result.trajectory.frame_count - 1, cube = run.model.bodies[0].vertex_end;
  double weight = run.model.bodies[0].mass * 9.81, z[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY};
  for (int frame = last / 2; frame <= last; frame++) {
    Vec3 force = {0, 0, 0};
    for (int i = 0; i < run.result.trajectory.interface_count; i++)
      force = vec3_add(force, vec3_at(scene_force(&run, frame, i)));
    ck_assert_near(force.y, 0, 0.02 * weight);
    double centre[2] = {0, 0};
    for (int a = 0; a < cube; a++)
      for (int c = 0; c < 2; c++) centre[c] += scene_position(&run, frame, a)[c + 1] / cube;
    y[0] = fmin(y[0], centre[0]), y[1] = fmax(y[1], centre[0]);
    z[0] = fmin(z[0], centre[1]), z[1] = fmax(z[1], centre[1]);
  }
  ck_assert_double_gt(centre_x(&run, last) - centre_x(&run, 0), 0.1);
  ck_assert_double_lt(y[1] - y[0], 1e-4); // of a cube of 0.1 m
  ck_assert_double_lt(z[1] - z[0], 1e-3);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("friction");
  tcase_add_test(test_case, a_block_on_a_slope_of_one_half_sticks_at_0_51);
  tcase_add_test(test_case, a_block_on_a_slope_of_one_half_slides_at_0_49);
  tcase_add_test(test_case, on_a_slope_of_15_degrees_the_forces_carry_the_weight);
  tcase_add_test(test_case, frames_show_friction_apart_from_pressure);
  tcase_add_test(test_case, without_friction_no_friction_is_created);
  tcase_add_test(test_case, a_cube_slides_over_coplanar_tiles_without_a_kick);
  return suite_run("friction", test_case, 120);
}

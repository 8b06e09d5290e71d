// SPDX-License-Identifier: GPL-3.0-or-later
// contact/friction: Coulomb's law on overlap volumes, its derivative and power, with every overlap model;
// whole scenes against theory.
#include "blocks.h"
#include "product.h"
#include "scene.h"

#include <string.h>
#include <unistd.h>

#include "base/vec3.h"
#include "contact/friction/friction.h"
#include "fem/model/tolerance.h"
#include "fem/output/vtk/vtu_read.h"

static const double MU = 0.4, SLIP_SPEED = 1e-3;

typedef struct Fixture {
  Blocks blocks;
  double *rest, *velocities;
  ContactShape ground;
  OverlapModel model;
  ContactSystem *system;
  ContactFriction friction;
} Fixture;

static size_t value_count(const Fixture *f) {
  return 3 * (size_t)f->blocks.vertex_count;
}

static double *zeros(const Fixture *f) {
  double *values = calloc(value_count(f), sizeof(double));
  ck_assert_ptr_nonnull(values);
  return values;
}

static void start(Fixture *f, const char *model, bool has_ground) {
  f->rest = blocks_copy(&f->blocks);
  f->velocities = zeros(f);
  ck_assert_ok(overlap_model_create(&f->model, model));
  ContactSystemDef def = blocks_def(&f->blocks, f->rest, &f->model);
  if (has_ground) def.shapes = &f->ground, def.shape_count = 1;
  ck_assert_ok(contact_system_create(&f->system, &def));
  ck_assert_ok(contact_system_update(f->system, 0, f->blocks.x, f->velocities, 0.01, NULL));
  double energy;
  ck_assert_ok(contact_system_eval(f->system, 0, f->blocks.x, &energy, NULL));
  ck_assert_ok(contact_friction_create(&f->friction, f->system, MU, SLIP_SPEED));
  ck_assert_ok(contact_friction_update(&f->friction));
  ck_assert_int_gt(f->friction.grip_count, 0);
}

// A block whose lowest layer is pressed a tenth of a cell into the ground z ≤ 0, which moves along.
static Fixture *block_on_ground(void) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  blocks_add(&f->blocks, &(BlockDef){.corner = {0, 0, -0.1}, .cell = {1, 1, 1}, .cells = {3, 3, 2}});
  f->ground = (ContactShape){.name = "ground", .normal = {0, 0, 1}, .velocity = {0.3, -0.2, 0}};
  start(f, "clip", true);
  return f;
}

// Two irregular blocks, the upper one pressed 0.3 cells into the lower.
static Fixture *pressed_blocks(const char *model, bool is_obstacle_below) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  blocks_add(
      &f->blocks,
      &(BlockDef){.cell = {1, 1, 1}, .cells = {3, 3, 2}, .jitter = 0.15, .is_obstacle = is_obstacle_below});
  blocks_add(
      &f->blocks,
      &(BlockDef){.corner = {0.63, 0.41, 1.7}, .cell = {0.83, 0.9, 0.8}, .cells = {2, 2, 2}, .jitter = 0.15});
  start(f, model, false);
  return f;
}

static void destroy(Fixture *f) {
  contact_friction_destroy(&f->friction);
  contact_system_destroy(f->system);
  overlap_model_destroy(&f->model);
  blocks_destroy(&f->blocks);
  free(f->rest), free(f->velocities), free(f);
}

static void move_body(Fixture *f, int body, Vec3 velocity) {
  for (int v = f->blocks.bodies[body].vertex_begin; v < f->blocks.bodies[body].vertex_end; v++)
    vec3_store(f->velocities + 3 * v, velocity);
}

static void move_at_random(Fixture *f, uint64_t stream, double speed) {
  Random random = random_seeded(5, stream);
  for (size_t k = 0; k < value_count(f); k++) f->velocities[k] = random_between(&random, -speed, speed);
}

static double *forces(const Fixture *f) {
  double *force = zeros(f);
  contact_friction_add_force(&f->friction, f->velocities, force);
  return force;
}

static Vec3 sum_over(const double *force, int begin, int end) {
  Vec3 sum = {0, 0, 0};
  for (int v = begin; v < end; v++) sum = vec3_add(sum, vec3_at(force + 3 * v));
  return sum;
}

START_TEST(sliding_resists_with_mu_times_the_normal_force_at_every_vertex) {
  Fixture *f = block_on_ground();
  move_body(f, 0, (Vec3){0.3 + 0.03, -0.2 + 0.04, 5}); // (.03, .04) over the moving ground, and away from it
  double *force = forces(f), largest = 0;
  const double *normal = contact_system_forces(f->system);
  for (int v = 0; v < f->blocks.vertex_count; v++) {
    ck_assert_near(force[3 * v], -0.6 * MU * normal[3 * v + 2], 1e-12);
    ck_assert_near(force[3 * v + 1], -0.8 * MU * normal[3 * v + 2], 1e-12);
    ck_assert_near(force[3 * v + 2], 0, 1e-12);
    largest = fmax(largest, normal[3 * v + 2]);
  }
  ck_assert_double_gt(largest, 1);
  free(force), destroy(f);
}
END_TEST

START_TEST(what_moves_along_feels_no_friction) {
  Fixture *f = block_on_ground();
  move_body(f, 0, (Vec3){0.3, -0.2, 1});
  double *force = forces(f);
  for (size_t k = 0; k < value_count(f); k++) ck_assert_near(force[k], 0, 1e-9);
  free(force), destroy(f);
}
END_TEST

START_TEST(slow_slip_is_held_by_a_part_of_the_friction) {
  Fixture *f = block_on_ground();
  move_body(f, 0, (Vec3){0.3 + SLIP_SPEED / 4, -0.2, 0}); // φ(1/4) = 7/16
  double *force = forces(f);
  const double *normal = contact_system_forces(f->system);
  Vec3 held = sum_over(force, 0, f->blocks.vertex_count),
       pressed = sum_over(normal, 0, f->blocks.vertex_count);
  ck_assert_near(held.x, -7.0 / 16 * MU * pressed.z, 1e-9 * pressed.z);
  free(force), destroy(f);
}
END_TEST

// _i: overlap model.
START_TEST(friction_keeps_momentum_with_every_overlap_model) {
  int count;
  const OverlapOps *const *models = overlap_model_list(&count);
  ck_assert_int_lt(_i, count);
  if (suite_leaves_out(models[_i]->name)) return;
  Fixture *f = pressed_blocks(models[_i]->name, false);
  int middle = f->blocks.bodies[1].vertex_begin;
  for (uint64_t stream = 0; stream < 5; stream++) {
    move_at_random(f, stream, 1);
    double *force = forces(f);
    Vec3 a = sum_over(force, 0, middle), b = sum_over(force, middle, f->blocks.vertex_count);
    ck_assert_double_gt(vec3_length(a), 1);
    // The weights of a side sum to 1 as well as Σ ∇V of the pair is 0.
    bool is_single = strcmp(models[_i]->name, "clip32") == 0;
    ck_assert_near(vec3_length(vec3_add(a, b)), 0, (is_single ? 1e-6 : 1e-9) * vec3_length(a));
    free(force);
  }
  // Slid as a whole, the upper block feels μ times what presses it, and somewhat more: its sides, which dip
  // into the lower block, are pressed from left and right.
  move_at_random(f, 0, 0);
  move_body(f, 1, (Vec3){2, 0, 0});
  double *force = forces(f);
  Vec3 held = sum_over(force, middle, f->blocks.vertex_count);
  Vec3 pressed = sum_over(contact_system_forces(f->system), middle, f->blocks.vertex_count);
  ck_assert_double_gt(pressed.z, 1);
  ck_assert_near(held.x, -MU * pressed.z, 0.2 * MU * pressed.z);
  free(force), destroy(f);
}
END_TEST

// _i: depth of the overlap in tenths of a cell. Flat slabs of the same outline, meshed differently: faces
// between elements of both lie in the overlap, and nothing touches there. Near the outline the slabs' sides
// press as well.
START_TEST(inside_of_a_flat_patch_friction_is_mu_times_the_normal_force) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  double width = 8 * 0.77, margin = 2;
  blocks_add(&f->blocks, &(BlockDef){.cell = {0.77, 0.77, 0.77}, .cells = {8, 8, 2}});
  blocks_add(&f->blocks, &(BlockDef){.corner = {0, 0, 1.54 - 0.077 * _i},
                                     .cell = {width / 6, width / 6, 1},
                                     .cells = {6, 6, 2}});
  start(f, "clip", false);
  move_body(f, 1, (Vec3){2, 0, 0});
  double *force = forces(f), held = 0, pressed = 0;
  const double *normal = contact_system_forces(f->system);
  for (int v = f->blocks.bodies[1].vertex_begin; v < f->blocks.vertex_count; v++) {
    const double *x = f->blocks.x + 3 * v;
    if (!(fabs(x[0] - width / 2) < width / 2 - margin && fabs(x[1] - width / 2) < width / 2 - margin))
      continue;
    held += force[3 * v], pressed += normal[3 * v + 2];
  }
  ck_assert_double_gt(pressed, 1);
  ck_assert_near(held, -MU * pressed, 0.01 * MU * pressed);
  free(force), destroy(f);
}
END_TEST

// _i: a speed, in units of the slip speed: all stick, some slip, all slip.
START_TEST(the_damping_matrix_is_the_derivative_of_the_force) {
  const double speeds[] = {0.1, 1, 100};
  Fixture *f = pressed_blocks("clip", false);
  move_at_random(f, 1, speeds[_i] * SLIP_SPEED);
  double *still = zeros(f), *d = zeros(f);
  memcpy(still, f->velocities, value_count(f) * sizeof(double));
  Random random = random_seeded(6, 1);
  for (size_t k = 0; k < value_count(f); k++) d[k] = random_between(&random, -1, 1);
  Product product = product_of(d, f->blocks.vertex_count);
  ContactStiffnessSink sink = product_sink(&product);
  contact_friction_add_damping(&f->friction, f->velocities, &sink);
  double h = 1e-5 * SLIP_SPEED, largest = 0, *differences[2];
  for (int s = 0; s < 2; s++) {
    for (size_t k = 0; k < value_count(f); k++) f->velocities[k] = still[k] + (s ? h : -h) * d[k];
    differences[s] = forces(f);
  }
  for (size_t k = 0; k < value_count(f); k++) largest = fmax(largest, fabs(product.y[k]));
  ck_assert_double_gt(largest, 1);
  for (size_t k = 0; k < value_count(f); k++)
    ck_assert_near(product.y[k], (differences[0][k] - differences[1][k]) / (2 * h), 1e-4 * largest);
  free(still), free(d), free(product.y), free(differences[0]), free(differences[1]), destroy(f);
}
END_TEST

START_TEST(at_rest_the_damping_matrix_is_finite) {
  Fixture *f = pressed_blocks("clip", true);
  double *d = zeros(f);
  for (size_t k = 0; k < value_count(f); k++) d[k] = 1 + (double)(k % 7);
  Product product = product_of(d, f->blocks.vertex_count);
  ContactStiffnessSink sink = product_sink(&product);
  contact_friction_add_damping(&f->friction, f->velocities, &sink);
  double along = 0;
  for (size_t k = 0; k < value_count(f); k++) along += d[k] * product.y[k];
  ck_assert(isfinite(along) && along > 0);
  free(d), free(product.y), destroy(f);
}
END_TEST

START_TEST(the_power_of_the_forces_is_what_is_dissipated_less_what_drives) {
  Fixture *f = block_on_ground();
  for (uint64_t stream = 0; stream < 20; stream++) {
    move_at_random(f, stream, stream % 2 ? 1 : SLIP_SPEED);
    double *force = forces(f), power = 0;
    for (size_t k = 0; k < value_count(f); k++) power += force[k] * f->velocities[k];
    ContactFrictionPower parts = contact_friction_power(&f->friction, f->velocities);
    ck_assert_double_gt(parts.dissipated, 0);
    ck_assert_near(power, parts.driven - parts.dissipated, 1e-12 * parts.dissipated);
    free(force);
  }
  destroy(f);
}
END_TEST

START_TEST(a_wrong_law_is_refused) {
  Fixture *f = block_on_ground();
  ContactFriction wrong;
  ck_assert_int_eq(contact_friction_create(&wrong, f->system, -0.1, 1), STATUS_INPUT);
  ck_assert_int_eq(contact_friction_create(&wrong, f->system, NAN, 1), STATUS_INPUT);
  ck_assert_int_eq(contact_friction_create(&wrong, f->system, 0.1, 0), STATUS_INPUT);
  destroy(f);
}
END_TEST

// Whole scenes.

// The slope of the centre's velocity along x over the second half, by its positions: x = a t²/2 + v t + x0.
static double acceleration_at_end(const SceneRun *run) {
  int last = run->result.frame_count - 1, half = last / 2;
  double x[3], dt = run->result.frame_times[last] - run->result.frame_times[last - half / 2];
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
  scene_run(&run, "incline",
            (const char *const[]){"contact={potential: nodal, stiffness: 1e7, friction: 0.51}", NULL});
  int last = run.result.frame_count - 1;
  double creep = centre_x(&run, last) - centre_x(&run, last / 2);
  double slip_speed = fem_model_slip_speed(&run.model);
  ck_assert_double_gt(creep, 0);
  ck_assert_double_lt(creep, 0.5 * run.scene.end * slip_speed);
  ck_assert_double_lt(creep, 1e-3 * run.model.length);
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
  ck_assert_double_gt(run.result.audit.dissipated, 0);
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
  const double *force = scene_force(&run, run.result.frame_count - 1, 0);
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
  ck_assert_ptr_null(fem_system_effect(&system, &fem_effect_friction));
  ck_assert(!fem_system_lags(&system));
  fem_system_destroy(&system);
  scene_close(&run);
}
END_TEST

START_TEST(a_cube_slides_over_coplanar_tiles_without_a_kick) {
  SceneRun run;
  scene_run(&run, "tiles", NULL);
  ck_assert_int_gt(run.result.pairs_max, 0);
  // Σ over the tiles of the force on the cube, and how far the cube came.
  int last = run.result.frame_count - 1, cube = run.model.bodies[0].vertex_end;
  double weight = run.model.bodies[0].mass * 9.81, z[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY};
  for (int frame = last / 2; frame <= last; frame++) {
    Vec3 force = {0, 0, 0};
    for (int i = 0; i < run.result.interface_count; i++)
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
  int models;
  overlap_model_list(&models);
  tcase_add_test(test_case, sliding_resists_with_mu_times_the_normal_force_at_every_vertex);
  tcase_add_test(test_case, what_moves_along_feels_no_friction);
  tcase_add_test(test_case, slow_slip_is_held_by_a_part_of_the_friction);
  tcase_add_loop_test(test_case, friction_keeps_momentum_with_every_overlap_model, 0, models);
  tcase_add_loop_test(test_case, inside_of_a_flat_patch_friction_is_mu_times_the_normal_force, 1, 6);
  tcase_add_loop_test(test_case, the_damping_matrix_is_the_derivative_of_the_force, 0, 3);
  tcase_add_test(test_case, at_rest_the_damping_matrix_is_finite);
  tcase_add_test(test_case, the_power_of_the_forces_is_what_is_dissipated_less_what_drives);
  tcase_add_test(test_case, a_wrong_law_is_refused);
  tcase_add_test(test_case, a_block_on_a_slope_of_one_half_sticks_at_0_51);
  tcase_add_test(test_case, a_block_on_a_slope_of_one_half_slides_at_0_49);
  tcase_add_test(test_case, on_a_slope_of_15_degrees_the_forces_carry_the_weight);
  tcase_add_test(test_case, frames_show_friction_apart_from_pressure);
  tcase_add_test(test_case, without_friction_no_friction_is_created);
  tcase_add_test(test_case, a_cube_slides_over_coplanar_tiles_without_a_kick);
  return suite_run("friction", test_case, 120);
}

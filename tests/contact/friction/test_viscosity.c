// SPDX-License-Identifier: GPL-3.0-or-later
// contact/viscosity: contact that takes energy out.
#include "product.h"
#include "scene.h"

#include "base/vec3.h"
#include "blocks.h"
#include "contact/friction/viscosity.h"
#include "contact/search/layout.h"
#include "evaluated.h"
#include "overlap/models.h"

static const double ETA = 70; // [Pa s/m²]

typedef struct Fixture {
  Blocks blocks;
  double *rest, *still;
  OverlapModel model;
  ContactShape ground;
  ContactSystem *system;
  ContactViscosity law;
} Fixture;

static Fixture *empty_fixture(void) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  ck_assert_ok(overlap_models_create(&f->model, "clip"));
  return f;
}

static void start(Fixture *f, bool has_ground) {
  f->rest = blocks_copy(&f->blocks);
  f->still = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(f->still);
  ContactSystemDef def = blocks_def(&f->blocks, f->rest, &f->model);
  def.potential = CONTACT_POTENTIAL_FIELD;
  def.shapes = &f->ground;
  def.shape_count = has_ground;
  ck_assert_ok(contact_system_create(&f->system, &def));
  ck_assert_ok(contact_system_update(f->system, 0, f->blocks.x, f->still, 0.01));
  ck_assert_ok(contact_viscosity_create(&f->law, f->system, ETA));
}

// Two irregular blocks, the upper one 0.3 elements deep in the lower.
static Fixture *pressed_blocks(bool is_obstacle_below) {
  Fixture *f = empty_fixture();
  blocks_add(
      &f->blocks,
      &(BlockDef){.cell = {1, 1, 1}, .cells = {3, 3, 2}, .jitter = 0.15, .is_obstacle = is_obstacle_below});
  blocks_add(
      &f->blocks,
      &(BlockDef){.corner = {0.63, 0.41, 1.7}, .cell = {0.83, 0.9, 0.8}, .cells = {2, 2, 2}, .jitter = 0.15});
  start(f, false);
  return f;
}

// A regular block of one cell, 0.2 of it below a ground that rises by 2 m/s.
static Fixture *block_on_rising_ground(void) {
  Fixture *f = empty_fixture();
  blocks_add(&f->blocks, &(BlockDef){.corner = {0, 0, -0.2}, .cell = {1, 1, 1}, .cells = {1, 1, 1}});
  f->ground = (ContactShape){
      .name = "ground", .kind = CONTACT_SHAPE_HALFSPACE, .normal = {0, 0, 1}, .velocity = {0, 0, 2}};
  start(f, true);
  return f;
}

static void destroy(Fixture *f) {
  contact_system_destroy(f->system);
  overlap_model_destroy(&f->model);
  blocks_destroy(&f->blocks);
  free(f->rest), free(f->still), free(f);
}

static double *random_motion(const Fixture *f, uint64_t stream) {
  Random random = random_seeded(23, stream);
  double *d = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(d);
  for (int k = 0; k < 3 * f->blocks.vertex_count; k++) d[k] = random_between(&random, -1, 1);
  return d;
}

static ContactViscosityMotion motion_of(const Fixture *f, const double *velocities) {
  return (ContactViscosityMotion){evaluated_at(f->system, 0, f->blocks.x), velocities};
}

static double *force_at(Fixture *f, const double *velocities) {
  double *force = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(force);
  contact_viscosity_add_force(&f->law, motion_of(f, velocities), force);
  return force;
}

static ContactViscosityPower power_at(Fixture *f, const double *velocities) {
  return contact_viscosity_power(&f->law, motion_of(f, velocities));
}

static double *multiply(Fixture *f, const double *velocities, const double *d) {
  Product product = product_of(d, f->blocks.vertex_count);
  ContactStiffnessSink sink = product_sink(&product);
  contact_viscosity_add_damping(&f->law, motion_of(f, velocities), 1, &sink);
  return product.y;
}

// A fifth of the block of volume 1 is below the ground, whose slope is 1 and which rises by 2 m/s: η V ḋ.
START_TEST(the_force_is_that_of_the_formula) {
  Fixture *f = block_on_rising_ground();
  double *force = force_at(f, f->still), lift = 0, expected = ETA * 0.2 * 2;
  for (int v = 0; v < f->blocks.vertex_count; v++) lift += force[3 * v + 2];
  ck_assert_near(lift, expected, 1e-9 * expected);
  ContactViscosityPower power = power_at(f, f->still);
  ck_assert_near(power.driven, 2 * lift, 1e-9 * lift);
  ck_assert_near(power.dissipated, 2 * lift, 1e-9 * lift); // the block stands still
  free(force), destroy(f);
}
END_TEST

START_TEST(what_moves_with_the_ground_feels_nothing) {
  Fixture *f = block_on_rising_ground();
  for (int v = 0; v < f->blocks.vertex_count; v++) f->still[3 * v + 2] = 2, f->still[3 * v] = 5;
  double *force = force_at(f, f->still);
  for (int k = 0; k < 3 * f->blocks.vertex_count; k++) ck_assert_near(force[k], 0, 1e-9);
  free(force), destroy(f);
}
END_TEST

START_TEST(forces_balance_and_their_power_is_dissipated) {
  Fixture *f = pressed_blocks(_i);
  int n = 3 * f->blocks.vertex_count;
  for (uint64_t stream = 0; stream < 10; stream++) {
    double *velocities = random_motion(f, stream), *force = force_at(f, velocities);
    double size = sqrt(product_dot(force, force, n)), dissipated = power_at(f, velocities).dissipated;
    Vec3 sum = {0, 0, 0};
    for (int v = 0; v < n / 3; v++) sum = vec3_add(sum, vec3_at(force + 3 * v));
    ck_assert_double_gt(size, 1e-3);
    ck_assert_double_le(vec3_length(sum), 1e-12 * size);
    ck_assert_double_gt(dissipated, 0);
    ck_assert_near(-product_dot(force, velocities, n), dissipated, 1e-12 * dissipated);
    free(velocities), free(force);
  }
  destroy(f);
}
END_TEST

START_TEST(turning_together_feels_nothing) {
  Fixture *f = pressed_blocks(false);
  Vec3 spin = {0.3, -1, 2};
  for (int v = 0; v < f->blocks.vertex_count; v++)
    vec3_store(f->still + 3 * v, vec3_cross(spin, vec3_at(f->blocks.x + 3 * v)));
  double *force = force_at(f, f->still);
  // Nudges turn along with nothing: 1e-9 of the pressure that a speed of 1 m/s would make.
  for (int k = 0; k < 3 * f->blocks.vertex_count; k++) ck_assert_near(force[k], 0, 1e-6);
  free(force), destroy(f);
}
END_TEST

START_TEST(the_damping_matrix_is_minus_the_derivative_by_velocities) {
  Fixture *f = pressed_blocks(_i);
  int n = 3 * f->blocks.vertex_count;
  double *velocities = random_motion(f, 0), *force = force_at(f, velocities);
  for (uint64_t stream = 1; stream < 5; stream++) {
    double *d = random_motion(f, stream), *faster = random_motion(f, 0);
    for (int v = 0; _i && v < f->blocks.bodies[0].vertex_end; v++)
      d[3 * v] = d[3 * v + 1] = d[3 * v + 2] = 0; // an obstacle has no unknowns
    for (int k = 0; k < n; k++) faster[k] += d[k];
    double *other = force_at(f, faster), *product = multiply(f, velocities, d);
    double size = sqrt(product_dot(product, product, n));
    ck_assert_double_gt(size, 0);
    int first = _i ? 3 * f->blocks.bodies[0].vertex_end : 0;
    for (int k = first; k < n; k++) ck_assert_near(force[k] - other[k], product[k], 1e-12 * size);
    for (int k = 0; k < first; k++) ck_assert_near(product[k], 0, 0);
    ck_assert_double_ge(product_dot(d, product, n), 0);
    free(d), free(faster), free(other), free(product);
  }
  free(velocities), free(force), destroy(f);
}
END_TEST

START_TEST(a_wrong_coefficient_is_refused) {
  Fixture *f = pressed_blocks(false);
  ContactViscosity law;
  ck_assert_int_eq(contact_viscosity_create(&law, f->system, 0), STATUS_INPUT);
  ck_assert_int_eq(contact_viscosity_create(&law, f->system, NAN), STATUS_INPUT);
  destroy(f);
}
END_TEST

// How high the centre comes after the first impact, over where it would rest on the ground [m].
static double bounce_height(const SceneRun *run) {
  double highest = -INFINITY, lowest = INFINITY;
  for (int frame = 0; frame < run->result.trajectory.frame_count; frame++) {
    double height = 0;
    for (int v = 0; v < run->model.vertex_count; v++)
      height += run->model.mass[v] * scene_position(run, frame, v)[2] / run->model.bodies[0].mass;
    if (height < lowest) lowest = height, highest = height;
    if (height > highest) highest = height;
  }
  return highest - 0.05;
}

START_TEST(the_more_viscous_the_lower_it_bounces_and_the_audit_knows_why) {
  const char *const viscosities[] = {NULL, "contact.viscosity=1.2e5", "contact.viscosity=4e5",
                                     "contact.viscosity=1.6e6"};
  double last = INFINITY, lost_last = -1, missing_without = 0;
  for (int k = 0; k < 4; k++) {
    SceneRun run;
    scene_run(&run, "bounce", (const char *const[]){viscosities[k], NULL});
    ck_assert_int_gt(run.result.contact.pairs_max, 0);
    double weight = 9.81 * run.model.bodies[0].mass, height = bounce_height(&run);
    double missing = weight * (0.1 - height), lost = run.result.energy.audit.dissipated; // it falls by 0.1 m
    ck_assert_double_lt(scene_gain(&run), 1e-3);
    // The balance closes up to what the integrator itself damps.
    ck_assert_near(run.result.energy.audit.total, weight * 0.15, 0.05 * weight * 0.1);
    if (k == 0) {
      ck_assert_near(lost, 0, 0);
      missing_without = missing;
      ck_assert_double_gt(height, 0.08);
    } else {
      ck_assert_double_lt(height, last - 0.01);
      ck_assert_double_gt(lost, lost_last);
      // What it lacks in height was dissipated; the rest trembles in the block, or did so without viscosity.
      ck_assert_double_le(lost, 1.02 * missing); // and 1 % for the height between two frames
      ck_assert_double_ge(lost, 0.95 * (missing - missing_without));
    }
    last = height, lost_last = lost;
    scene_close(&run);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("viscosity");
  tcase_add_test(cases, the_force_is_that_of_the_formula);
  tcase_add_test(cases, what_moves_with_the_ground_feels_nothing);
  tcase_add_loop_test(cases, forces_balance_and_their_power_is_dissipated, 0, 2);
  tcase_add_test(cases, turning_together_feels_nothing);
  tcase_add_loop_test(cases, the_damping_matrix_is_minus_the_derivative_by_velocities, 0, 2);
  tcase_add_test(cases, a_wrong_coefficient_is_refused);
  tcase_add_test(cases, the_more_viscous_the_lower_it_bounces_and_the_audit_knows_why);
  return suite_run("viscosity", cases, 120);
}

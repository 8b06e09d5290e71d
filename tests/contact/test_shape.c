// SPDX-License-Identifier: GPL-3.0-or-later
// contact/shape: half-spaces and balls that move, as obstacles of a contact system and of scenes.
#include "blocks.h"
#include "evaluated.h"
#include "scene.h"

#include "base/vec3.h"
#include "contact/shape/convex.h"
#include "contact/shape/shape.h"
#include "overlap/models.h"

typedef struct Fixture {
  Blocks blocks;
  double *rest, *still;
  ContactShape shape;
  OverlapModel model;
  ContactSystem *system;
} Fixture;

// A block of 3 × 3 × 2 cells from the origin, jittered, with a shape below.
static Fixture *block_on(ContactShape shape) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  blocks_add(&f->blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {3, 3, 2}, .jitter = 0.1});
  f->shape = shape;
  f->rest = blocks_copy(&f->blocks);
  f->still = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(f->still);
  ck_assert_ok(overlap_models_create(&f->model, "clip"));
  ContactSystemDef def = blocks_def(&f->blocks, f->rest, &f->model);
  def.shapes = &f->shape, def.shape_count = 1, def.margin = 0.5;
  ck_assert_ok(contact_system_create(&f->system, &def));
  ck_assert_ok(contact_system_update(f->system, 0, f->blocks.x, f->still, 0.01));
  return f;
}

static void destroy(Fixture *f) {
  contact_system_destroy(f->system);
  overlap_model_destroy(&f->model);
  blocks_destroy(&f->blocks);
  free(f->rest), free(f->still), free(f);
}

// A swing along (1, 2, 0.5) and a turn about z through (1, 1, 0) at ½ rad/s.
static void swing(const void *motion, double time, const double rest[3], double position[3],
                  double velocity[3]) {
  ck_assert_ptr_null(motion);
  double c = cos(0.5 * time), s = sin(0.5 * time), x = rest[0] - 1, y = rest[1] - 1,
         way = 0.1 * sin(3 * time);
  double speed = 0.3 * cos(3 * time);
  vec3_store(position, (Vec3){1 + c * x - s * y + way, 1 + s * x + c * y + 2 * way, rest[2] + way / 2});
  vec3_store(velocity, (Vec3){0.5 * (-s * x - c * y) + speed, 0.5 * (c * x - s * y) + 2 * speed, speed / 2});
}

static ContactShape ball_below(void) {
  return (ContactShape){
      .name = "ball", .kind = CONTACT_SHAPE_BALL, .point = {1.7, 1.2, -1.6}, .radius = 2, .move = swing};
}

static ContactShape plane_below(void) {
  return (ContactShape){
      .name = "plane", .normal = {0, 0.6, 0.8}, .point = {1, 0.5, 0}, .velocity = {0, 1, -0.3}};
}

// A box and a cylinder, turned and moving; what they are made of outlives every test.
static ContactShape box_below(void) {
  static ContactConvex box;
  const FemPlacement turn = {.axis = {1, 2, 0.5}, .angle_degrees = 25};
  contact_convex_make_box(&box, (double[3]){0.9, 1.1, 0.8});
  ContactShape shape = {
      .name = "box", .kind = CONTACT_SHAPE_CONVEX, .convex = &box, .point = {1.7, 1.2, -0.4}, .move = swing};
  fem_mesh_placement_axes(&turn, shape.axes);
  return shape;
}

static ContactShape cylinder_below(void) {
  const FemPlacement turn = {.axis = {2, -1, 0}, .angle_degrees = 70};
  ContactShape shape = {.name = "cylinder",
                        .kind = CONTACT_SHAPE_CYLINDER,
                        .radius = 0.8,
                        .half_length = 1.2,
                        .round = 0.8,
                        .point = {1.7, 1.2, -0.4},
                        .move = swing};
  fem_mesh_placement_axes(&turn, shape.axes);
  return shape;
}

static double energy_at(Fixture *f, double time, const double *x) {
  return evaluated_at(f->system, time, x)->energy;
}

// _i: which shape.
static Fixture *fixture_of(int i) {
  switch (i) {
  case 0:
    return block_on(ball_below());
  case 1:
    return block_on(plane_below());
  case 2:
    return block_on(box_below());
  default:
    return block_on(cylinder_below());
  }
}

START_TEST(forces_are_minus_the_gradient_of_the_energy) {
  Fixture *f = fixture_of(_i);
  double largest = 0, h = 1e-6, *x = blocks_copy(&f->blocks);
  double *force = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  const ContactEvaluation *evaluation = evaluated_at(f->system, 0.1, x);
  contact_system_add_force(f->system, evaluation, force);
  ck_assert_double_gt(evaluation->energy, 0);
  for (int k = 0; k < 3 * f->blocks.vertex_count; k++) largest = fmax(largest, fabs(force[k]));
  for (int k = 0; k < 3 * f->blocks.vertex_count; k++) {
    double kept = x[k];
    x[k] = kept + h;
    double high = energy_at(f, 0.1, x);
    x[k] = kept - h;
    double low = energy_at(f, 0.1, x);
    x[k] = kept;
    ck_assert_near(force[k], (low - high) / (2 * h), 1e-6 * largest);
  }
  free(x), free(force), destroy(f);
}
END_TEST

START_TEST(the_power_of_a_moving_shape_is_the_rate_of_the_energy) {
  Fixture *f = fixture_of(_i);
  for (int k = 0; k < 5; k++) {
    double time = 0.02 * k, h = 1e-6;
    double rate = (energy_at(f, time + h, f->blocks.x) - energy_at(f, time - h, f->blocks.x)) / (2 * h);
    const ContactEvaluation *evaluation = evaluated_at(f->system, time, f->blocks.x);
    ck_assert(fabs(rate) > 1);
    ck_assert_near(contact_system_shape_power(f->system, evaluation), rate, 1e-5 * fabs(rate));
  }
  destroy(f);
}
END_TEST

START_TEST(material_of_a_turning_ball_moves_with_it) {
  ContactShape ball = ball_below();
  // A point carried along: its velocity by the motion, and by the shape where it is now.
  double rest[3] = {1.9, 0.4, -0.3}, x[3], velocity[3];
  swing(NULL, 0.7, rest, x, velocity);
  Vec3 by_shape = contact_shape_velocity(&ball, 0.7, vec3_at(x));
  ck_assert_near(vec3_length(vec3_sub(by_shape, vec3_at(velocity))), 0, 1e-13);
}
END_TEST

// _i: 2, the box; 3, the cylinder.
START_TEST(a_turned_solid_has_the_derivatives_of_its_volume_and_energy) {
  ContactShape shape = _i == 2 ? box_below() : cylinder_below();
  double tet[12] = {1.5, 1.1, 0.2, 2.4, 1.3, 0.4, 1.6, 2, 0.3, 1.8, 1.3, 0.9}, h = 1e-6;
  double volume, gradient[12], high, low, energy, press[12], hessian[144], sides[2][12];
  double rest = 1.1 * fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6;
  contact_shape_overlap(&shape, 0.4, tet, &volume, gradient);
  contact_shape_press(&shape, 0.4, tet, rest, &volume, &energy, press, hessian);
  ck_assert_double_gt(volume, 1e-3);
  ck_assert_double_gt(energy, 1e-4);
  ck_assert_double_lt(contact_shape_separation(&shape, 0.4, tet, INFINITY), 0);
  for (int k = 0; k < 12; k++) {
    double kept = tet[k], energies[2];
    for (int side = 0; side < 2; side++) {
      tet[k] = kept + (side ? -h : h);
      contact_shape_overlap(&shape, 0.4, tet, side ? &low : &high, NULL);
      contact_shape_press(&shape, 0.4, tet, rest, &volume, &energies[side], sides[side], NULL);
    }
    tet[k] = kept;
    ck_assert_near(gradient[k], (high - low) / (2 * h), 1e-8);
    ck_assert_near(press[k], (energies[0] - energies[1]) / (2 * h), 1e-8);
    for (int r = 0; r < 12; r++)
      ck_assert_near(hessian[12 * r + k], (sides[0][r] - sides[1][r]) / (2 * h), 1e-6);
  }
}
END_TEST

START_TEST(no_corner_of_a_turning_solid_moves_farther_than_it_says) {
  ContactShape shape = box_below();
  double most = 0, fastest = 0;
  for (int k = 0; k < shape.convex->corner_count; k++)
    for (int sign = -1; sign <= 1; sign += 2) {
      const Vec3 corner = vec3_scale(sign, shape.convex->corners[k]);
      const double own[3] = {corner.x, corner.y, corner.z};
      double rest[3], from[3], to[3], velocity[3];
      for (int c = 0; c < 3; c++) {
        rest[c] = shape.point[c];
        for (int a = 0; a < 3; a++) rest[c] += own[a] * shape.axes[a][c];
      }
      swing(NULL, 0.9, rest, to, velocity);
      swing(NULL, 0.2, rest, from, velocity);
      most = suite_larger(most, vec3_length(vec3_sub(vec3_at(to), vec3_at(from))));
      fastest = suite_larger(fastest, vec3_length(vec3_at(velocity)));
    }
  ck_assert_double_ge(contact_shape_motion(&shape, 0.2, 0.9), most);
  ck_assert_double_le(contact_shape_motion(&shape, 0.2, 0.9), 2.5 * most);
  ck_assert_double_ge(contact_shape_speed(&shape, 0.2), fastest);
  ck_assert_double_le(contact_shape_speed(&shape, 0.2), 2.5 * fastest);
}
END_TEST

// Rings of its rims and of its middle, as they lie at 0.9; by how much each has come nearer is its gap at
// 0.2.
START_TEST(no_point_of_a_turning_cylinder_comes_nearer_than_it_says) {
  ContactShape shape = cylinder_below();
  double most = 0, said = contact_shape_motion(&shape, 0.2, 0.9);
  for (int k = 0; k < 48; k++) {
    double angle = 2 * M_PI * k / 16, rest[3], place[3], velocity[3];
    const double own[3] = {0.8 * cos(angle), 0.8 * sin(angle), 1.2 * (k / 16 - 1)};
    for (int c = 0; c < 3; c++) {
      rest[c] = shape.point[c];
      for (int a = 0; a < 3; a++) rest[c] += own[a] * shape.axes[a][c];
    }
    swing(NULL, 0.9, rest, place, velocity);
    most = suite_larger(most, contact_shape_gap(&shape, 0.2, vec3_at(place)));
  }
  ck_assert_double_gt(most, 0.05);
  ck_assert_double_ge(said, most);
}
END_TEST

START_TEST(clearance_is_never_more_than_the_distance_of_any_element) {
  Fixture *f = fixture_of(_i);
  const ContactSystemDef *def = &contact_system_layout(f->system)->def;
  for (int step = 0; step < 20; step++) {
    double lift = 0.2 * step, nearest = INFINITY, *x = blocks_copy(&f->blocks);
    for (int v = 0; v < f->blocks.vertex_count; v++) x[3 * v] += 0.5 * lift, x[3 * v + 2] += lift;
    for (int i = 0; i < def->tet_count; i++) {
      double tet[12];
      contact_layout_gather(contact_system_layout(f->system), i, x, tet);
      nearest = fmin(nearest, contact_shape_separation(&f->shape, 0.3, tet, INFINITY));
    }
    double clearance = contact_shape_clearance(&f->shape, 0.3, x, 0, f->blocks.vertex_count);
    ck_assert(clearance <= fmax(nearest, 0) + 1e-12 || clearance <= 0);
    if (step == 19) ck_assert_double_gt(clearance, 0.3 * nearest);
    free(x);
  }
  destroy(f);
}
END_TEST

START_TEST(a_wrong_shape_is_refused) {
  ContactShape ball = ball_below(), plane = plane_below();
  ck_assert_ok(contact_shape_check(&ball));
  ck_assert_ok(contact_shape_check(&plane));
  ball.radius = 0, plane.normal[0] = 1;
  ck_assert_int_eq(contact_shape_check(&ball), STATUS_INPUT);
  ck_assert_int_eq(contact_shape_check(&plane), STATUS_INPUT);
  ContactShape box = box_below();
  ck_assert_ok(contact_shape_check(&box));
  box.axes[1][0] += 0.1;
  ck_assert_int_eq(contact_shape_check(&box), STATUS_INPUT);
  ball.radius = NAN;
  ck_assert_int_eq(contact_shape_check(&ball), STATUS_INPUT);
}
END_TEST

START_TEST(a_block_rests_between_balls) {
  SceneRun run;
  // A coarse tolerance damps the rocking that contact leaves it.
  scene_run(&run, "balls", (const char *const[]){"time.velocity_tolerance=3e-3", "time.end=1", NULL});
  int last = run.result.trajectory.frame_count - 1;
  double weight = run.model.bodies[0].mass * 9.81;
  Vec3 sum = {0, 0, 0};
  for (int i = 0; i < run.result.trajectory.interface_count; i++) {
    ck_assert_double_gt(scene_force(&run, last, i)[2], 0.1 * weight);
    sum = vec3_add(sum, vec3_at(scene_force(&run, last, i)));
  }
  ck_assert_int_eq(run.result.trajectory.interface_count, 3);
  ck_assert_near(vec3_length(vec3_sub(sum, (Vec3){0, 0, weight})), 0, 2e-3 * weight);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

// On a box's edge on one side, on a cylinder on the other: both as strong, as its middle is between them, but
// for the millimetres that it slides without friction.
START_TEST(a_block_rests_on_a_box_and_a_cylinder) {
  SceneRun run;
  scene_run(&run, "trestle", NULL);
  int last = run.result.trajectory.frame_count - 1;
  double weight = run.model.bodies[0].mass * 9.81;
  ck_assert_int_eq(run.result.trajectory.interface_count, 2);
  ck_assert_int_eq(run.model.free_count, 3 * (run.model.bodies[0].vertex_end));
  Vec3 sum = {0, 0, 0};
  for (int i = 0; i < 2; i++) {
    ck_assert_near(scene_force(&run, last, i)[2], weight / 2, 0.03 * weight);
    sum = vec3_add(sum, vec3_at(scene_force(&run, last, i)));
  }
  ck_assert_near(sum.z, weight, 2e-3 * weight);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

// A paddle turns at a steady rate and throws a ball: the power that it puts in is the energy that it gave.
START_TEST(a_turning_box_throws_a_block) {
  SceneRun run;
  scene_run(&run, "paddle", NULL);
  ck_assert_double_gt(run.result.contact.force_max, 1);
  ck_assert_double_gt(run.result.energy.audit.work, 0);
  const double *x = run.result.trajectory.positions + (size_t)(run.result.trajectory.frame_count - 1) * 3 *
                                                          (size_t)run.result.trajectory.vertex_count;
  Vec3 mean = {0, 0, 0};
  for (int v = 0; v < run.result.trajectory.vertex_count; v++)
    mean = vec3_add(mean, vec3_scale(1.0 / run.result.trajectory.vertex_count, vec3_at(x + 3 * v)));
  ck_assert_double_gt(mean.y, 0.2); // it was thrown along y
  ck_assert_double_le(scene_gain(&run), 1e-3);
  // what was put in is there: as motion, or taken by the integrator's damping, never more
  ck_assert_double_le(fabs(run.result.energy.audit.total - run.result.energy.audit.lowest),
                      1e-3 * run.result.energy.audit.scale);
  scene_close(&run);
}
END_TEST

// The ball comes down along a table, presses 2 cm in, and goes up again: the work done comes back but for
// what damping takes.
START_TEST(a_driven_ball_presses_and_leaves) {
  SceneRun run;
  scene_run(&run, "indent", NULL);
  int last = run.result.trajectory.frame_count - 1, middle = last / 2;
  ck_assert_double_lt(scene_force(&run, middle, 0)[2], -5);
  ck_assert_double_eq(scene_force(&run, last, 0)[2], 0);
  ck_assert_double_gt(run.result.energy.audit.work, 0);
  ck_assert_double_le(run.result.energy.audit.dissipated, run.result.energy.audit.work * 1.02);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("shape");
  tcase_add_loop_test(test_case, forces_are_minus_the_gradient_of_the_energy, 0, 4);
  tcase_add_loop_test(test_case, the_power_of_a_moving_shape_is_the_rate_of_the_energy, 0, 4);
  tcase_add_test(test_case, material_of_a_turning_ball_moves_with_it);
  tcase_add_loop_test(test_case, a_turned_solid_has_the_derivatives_of_its_volume_and_energy, 2, 4);
  tcase_add_test(test_case, no_corner_of_a_turning_solid_moves_farther_than_it_says);
  tcase_add_test(test_case, no_point_of_a_turning_cylinder_comes_nearer_than_it_says);
  tcase_add_loop_test(test_case, clearance_is_never_more_than_the_distance_of_any_element, 0, 4);
  tcase_add_test(test_case, a_wrong_shape_is_refused);
  tcase_add_test(test_case, a_block_rests_between_balls);
  tcase_add_test(test_case, a_block_rests_on_a_box_and_a_cylinder);
  tcase_add_test(test_case, a_turning_box_throws_a_block);
  tcase_add_test(test_case, a_driven_ball_presses_and_leaves);
  return suite_run("shape", test_case, 120);
}

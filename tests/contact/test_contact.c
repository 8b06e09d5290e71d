// SPDX-License-Identifier: GPL-3.0-or-later
// contact/system: energy, forces and stiffness of every potential, obstacles, audit.
#include "blocks.h"
#include "evaluated.h"
#include "product.h"

#include "base/memory.h"
#include "base/vec3.h"
#include "overlap/models.h"

// Overlap models see bodies shifted by less than this (contact/search/layout.h) [m].
static const double NUDGE = 2e-9;

typedef struct Fixture {
  Blocks blocks;
  double *rest, *still; // positions at rest, zero velocities
  OverlapModel model;
  ContactSystem *system;
} Fixture;

// Makes the system of def(blocks) and its first list.
static void start(Fixture *f, const ContactSystemDef *def) {
  ck_assert_ok(contact_system_create(&f->system, def));
  ck_assert_ok(contact_system_update(f->system, 0, f->blocks.x, f->still, 0.01));
}

// Blocks are added to an empty fixture; systems borrow from it, so that it stays where it is.
static Fixture *empty_fixture(void) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  return f;
}

static void prepare(Fixture *f) {
  f->rest = blocks_copy(&f->blocks);
  f->still = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(f->still);
  ck_assert_ok(overlap_models_create(&f->model, "clip"));
}

// Two irregular blocks, the upper one pressed 0.3 elements into the lower.
static Fixture *pressed_blocks(bool is_obstacle_below) {
  Fixture *f = empty_fixture();
  blocks_add(
      &f->blocks,
      &(BlockDef){.cell = {1, 1, 1}, .cells = {3, 3, 2}, .jitter = 0.15, .is_obstacle = is_obstacle_below});
  blocks_add(
      &f->blocks,
      &(BlockDef){.corner = {0.63, 0.41, 1.7}, .cell = {0.83, 0.9, 0.8}, .cells = {2, 2, 2}, .jitter = 0.15});
  prepare(f);
  return f;
}

static Fixture *pressed_system(ContactPotential potential, bool is_obstacle_below) {
  Fixture *f = pressed_blocks(is_obstacle_below);
  ContactSystemDef def = blocks_def(&f->blocks, f->rest, &f->model);
  def.potential = potential;
  start(f, &def);
  return f;
}

static void destroy(Fixture *f) {
  contact_system_destroy(f->system);
  overlap_model_destroy(&f->model);
  blocks_destroy(&f->blocks);
  free(f->rest), free(f->still), free(f);
}

static double energy_at(const Fixture *f, const double *x) {
  return evaluated_at(f->system, 0, x)->energy;
}

// Owned by the caller (free).
static double *forces_at(const Fixture *f, const double *x) {
  double *force = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(force);
  evaluated_with_force(f->system, x, force);
  return force;
}

// x + h d
static void step_to(const Fixture *f, double h, const double *d, double *x) {
  for (int k = 0; k < 3 * f->blocks.vertex_count; k++) x[k] = f->blocks.x[k] + h * d[k];
}

static double *random_motion(const Fixture *f, uint64_t stream, bool obstacles_move) {
  Random random = random_seeded(21, stream);
  double *d = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(d);
  for (int b = 0; b < f->blocks.body_count; b++)
    for (int k = 3 * f->blocks.bodies[b].vertex_begin; k < 3 * f->blocks.bodies[b].vertex_end; k++)
      d[k] = f->blocks.bodies[b].is_obstacle && !obstacles_move ? 0 : random_between(&random, -1, 1);
  return d;
}

static Product multiply(const Fixture *f, const double *d) {
  Product product = product_of(d, f->blocks.vertex_count);
  ContactStiffnessSink sink = product_sink(&product);
  ck_assert_ok(contact_system_stiffness(f->system, evaluated_at(f->system, 0, f->blocks.x), &sink));
  return product;
}

// _i: potential, + 5 with an obstacle below.
static Fixture *fixture_of(int i) {
  return pressed_system((ContactPotential)(i % CONTACT_POTENTIAL_COUNT), i >= CONTACT_POTENTIAL_COUNT);
}

START_TEST(forces_are_minus_the_gradient_of_the_energy) {
  Fixture *f = fixture_of(_i);
  double *x = blocks_copy(&f->blocks), *force = forces_at(f, f->blocks.x);
  const ContactEvaluation *evaluation = evaluated_at(f->system, 0, f->blocks.x);
  ck_assert_int_gt(contact_evaluation_active_count(evaluation), 20);
  ck_assert(evaluation->energy > 0);
  for (uint64_t k = 0; k < 10; k++) {
    double h = 1e-6, *d = random_motion(f, k, true);
    step_to(f, h, d, x);
    double above = energy_at(f, x);
    step_to(f, -h, d, x);
    double below = energy_at(f, x), power = product_dot(force, d, 3 * f->blocks.vertex_count);
    double size = sqrt(product_dot(force, force, 3 * f->blocks.vertex_count));
    ck_assert_near((above - below) / (2 * h), -power, 1e-7 * size);
    free(d);
  }
  free(x), free(force), destroy(f);
}
END_TEST

// That of `nodal` leaves a part out.
START_TEST(stiffness_is_minus_the_derivative_of_the_forces) {
  Fixture *f = fixture_of(CONTACT_POTENTIAL_COUNT * _i + CONTACT_POTENTIAL_FIELD);
  int n = 3 * f->blocks.vertex_count;
  double *x = blocks_copy(&f->blocks);
  for (uint64_t k = 0; k < 5; k++) {
    double h = 1e-6, *d = random_motion(f, k, false);
    step_to(f, h, d, x);
    double *above = forces_at(f, x);
    step_to(f, -h, d, x);
    double *below = forces_at(f, x);
    Product product = multiply(f, d);
    double size = sqrt(product_dot(product.y, product.y, n));
    ck_assert(size > 0);
    ck_assert_int_gt(product.dense_count, 0);
    for (int b = 0; b < f->blocks.body_count; b++)
      for (int v = 3 * f->blocks.bodies[b].vertex_begin; v < 3 * f->blocks.bodies[b].vertex_end; v++)
        if (!f->blocks.bodies[b].is_obstacle)
          ck_assert_near(-(above[v] - below[v]) / (2 * h), product.y[v], 1e-6 * size);
        else
          ck_assert_near(product.y[v], 0, 0);
    free(d), free(above), free(below), free(product.y);
  }
  free(x), destroy(f);
}
END_TEST

// The forces on both bodies sum to nothing, and so do their moments about the origin. Returns Σ |f|.
static double check_balance(const Fixture *f, const double *force) {
  double sum[3] = {0}, torque[3] = {0}, size = 0;
  for (int v = 0; v < f->blocks.vertex_count; v++) {
    Vec3 on_v = vec3_at(force + 3 * v);
    vec3_accumulate(sum, on_v);
    vec3_accumulate(torque, vec3_cross(vec3_at(f->blocks.x + 3 * v), on_v));
    size += vec3_length(on_v);
  }
  ck_assert(size > 0);
  ck_assert_near(vec3_length(vec3_at(sum)), 0, 1e-13 * size);
  ck_assert_near(vec3_length(vec3_at(torque)), 0, NUDGE * size);
  return size;
}

START_TEST(two_bodies_keep_momentum_and_angular_momentum) {
  Fixture *f = fixture_of(_i);
  double *force = forces_at(f, f->blocks.x), on_a[3] = {0}, size = check_balance(f, force);
  for (int v = 0; v < f->blocks.bodies[0].vertex_end; v++) vec3_accumulate(on_a, vec3_at(force + 3 * v));
  const ContactEvaluation *evaluation = evaluated_at(f->system, 0, f->blocks.x);
  const ContactInterface *interfaces = evaluation->interfaces;
  ck_assert_int_eq(contact_system_layout(f->system)->interface_count, 1);
  ck_assert_int_eq(interfaces[0].a, 0);
  ck_assert_int_eq(interfaces[0].b, 1);
  ck_assert_int_eq(interfaces[0].active_count, contact_evaluation_active_count(evaluation));
  for (int c = 0; c < 3; c++) ck_assert_near(interfaces[0].force[c], on_a[c], 1e-13 * size);
  ck_assert(on_a[2] < 0); // the lower body is pushed down
  const double *forces = evaluation->given_forces;
  for (int k = 0; k < 3 * f->blocks.vertex_count; k++) ck_assert_near(forces[k], force[k], 0);
  free(force), destroy(f);
}
END_TEST

// Six times the smallest signed volume of an element of the upper block at which contact pushes.
static double smallest_det(const Fixture *f, const double *force) {
  double smallest = INFINITY;
  for (int t = f->blocks.bodies[1].tet_begin; t < f->blocks.bodies[1].tet_end; t++) {
    const int *tet = f->blocks.tets[t];
    Vec3 corners[4];
    double pushed = 0;
    for (int v = 0; v < 4; v++) {
      corners[v] = vec3_at(f->blocks.x + 3 * tet[v]);
      pushed += vec3_length(vec3_at(force + 3 * tet[v]));
    }
    Vec3 edges[3];
    for (int k = 0; k < 3; k++) edges[k] = vec3_sub(corners[k + 1], corners[0]);
    if (pushed > 0) smallest = fmin(smallest, vec3_dot(edges[0], vec3_cross(edges[1], edges[2])));
  }
  return smallest;
}

// The middle of the upper block's lower face is pulled up through its elements.
START_TEST(elements_turned_inside_out_keep_momentum_and_angular_momentum) {
  Fixture *f = fixture_of(_i);
  enum { MIDDLE = 4 }; // of three by three
  f->blocks.x[3 * (f->blocks.bodies[1].vertex_begin + MIDDLE) + 2] += 1.2;
  ck_assert_ok(contact_system_update(f->system, 0, f->blocks.x, f->still, 0.01));
  double *force = forces_at(f, f->blocks.x);
  check_balance(f, force);
  ck_assert_double_lt(smallest_det(f, force), 0);
  free(force), destroy(f);
}
END_TEST

START_TEST(covered_volumes_sum_to_the_overlap) {
  Fixture *f = pressed_system(CONTACT_POTENTIAL_NODAL, false);
  const ContactEvaluation *evaluation = evaluated_at(f->system, 0, f->blocks.x);
  const double *covered = evaluation->given_covered;
  double sum[2] = {0};
  for (int b = 0; b < 2; b++)
    for (int i = f->blocks.bodies[b].tet_begin; i < f->blocks.bodies[b].tet_end; i++) sum[b] += covered[i];
  int active, *tets;
  double *pairs;
  const ContactInterface *interface = evaluation->interfaces;
  ck_assert(interface->volume > 0);
  ck_assert_near(sum[0], interface->volume, 1e-13 * interface->volume);
  ck_assert_near(sum[1], interface->volume, 1e-13 * interface->volume);
  ck_assert_ok(contact_system_active_pairs(f->system, evaluation, &active, &pairs, &tets));
  ck_assert_int_eq(active, interface->active_count);
  for (int k = 0; k < active; k++)
    for (int s = 0; s < 2; s++)
      for (int v = 0; v < 12; v++)
        ck_assert_near(pairs[24 * k + 12 * s + v],
                       f->blocks.x[3 * f->blocks.tets[tets[2 * k + s]][v / 3] + v % 3], NUDGE);
  memory_free(pairs), memory_free(tets), destroy(f);
}
END_TEST

// ---- By hand: one tetrahedron, tip down, its tip at height −s into a half-space of surface z = 0. The part
// below is similar to the whole: W = s³ V for height 1, V = 1/6.

static const double TIP_DOWN[12] = {0, 0, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1};

static Fixture *single_tet(double depth, ContactPotential potential, const double velocity[3]) {
  static const double UP[3] = {0, 0, 1};
  static ContactShape ground;
  Fixture *f = empty_fixture();
  f->blocks.vertex_count = 4, f->blocks.tet_count = 1, f->blocks.body_count = 1;
  f->blocks.x = malloc(sizeof TIP_DOWN);
  f->blocks.tets = malloc(sizeof *f->blocks.tets);
  memcpy(f->blocks.x, TIP_DOWN, sizeof TIP_DOWN);
  memcpy(f->blocks.tets[0], (int[]){0, 1, 2, 3}, sizeof *f->blocks.tets);
  f->blocks.bodies[0] = (ContactBody){.name = "tip", .vertex_end = 4, .tet_end = 1};
  prepare(f);
  ground = (ContactShape){.name = "ground", .point = {3, 1, depth}};
  memcpy(ground.normal, UP, sizeof UP);
  if (velocity) memcpy(ground.velocity, velocity, sizeof UP);
  ContactSystemDef def = blocks_def(&f->blocks, f->rest, &f->model);
  def.shapes = &ground, def.shape_count = 1;
  def.potential = potential;
  start(f, &def);
  return f;
}

START_TEST(a_tip_in_a_halfspace_is_as_by_hand) {
  double s = 0.5, V = 1.0 / 6, W = s * s * s * V, dW = 3 * s * s * V, kappa = 1000;
  double energies[] = {
      [CONTACT_POTENTIAL_NODAL] = kappa * W * W / (2 * V), [CONTACT_POTENTIAL_FIELD] = kappa * W * s / 4};
  double pressures[] = {
      [CONTACT_POTENTIAL_NODAL] = kappa * W / V, [CONTACT_POTENTIAL_FIELD] = kappa * W / dW};
  Fixture *f = single_tet(s, (ContactPotential)_i, NULL);
  const ContactEvaluation *evaluation = evaluated_at(f->system, 0, f->blocks.x);
  const ContactInterface *interface = evaluation->interfaces;
  ck_assert_near(evaluation->energy, energies[_i], 1e-13 * energies[_i]);
  ck_assert_int_eq(contact_system_layout(f->system)->interface_count, 1);
  ck_assert_int_eq(interface->b, 1); // body_count + 0
  ck_assert_near(interface->volume, W, 1e-15);
  ck_assert_near(interface->force[2], pressures[_i] * dW, 1e-12 * pressures[_i]);
  ck_assert_near(interface->force[0], 0, 1e-13 * pressures[_i]);
  ck_assert_near(interface->force[1], 0, 1e-13 * pressures[_i]);
  destroy(f);
}
END_TEST

START_TEST(a_halfspace_moves_with_its_velocity) {
  Fixture *moving = single_tet(0.2, CONTACT_POTENTIAL_NODAL, (double[]){7, 0, 0.5});
  Fixture *still = single_tet(0.25, CONTACT_POTENTIAL_NODAL, NULL);
  double energy = evaluated_at(moving->system, 0.1, moving->blocks.x)->energy;
  ck_assert_near(energy, energy_at(still, still->blocks.x), 1e-12 * energy);
  destroy(moving), destroy(still);
}
END_TEST

START_TEST(stiffness_against_a_halfspace_is_the_derivative) {
  Fixture *f = single_tet(0.4, CONTACT_POTENTIAL_FIELD, NULL);
  double h = 1e-6, x[12], *d = random_motion(f, 3, true);
  step_to(f, h, d, x);
  double *above = forces_at(f, x);
  step_to(f, -h, d, x);
  double *below = forces_at(f, x);
  Product product = multiply(f, d);
  double size = sqrt(product_dot(product.y, product.y, 12));
  ck_assert(size > 0);
  for (int k = 0; k < 12; k++) ck_assert_near(-(above[k] - below[k]) / (2 * h), product.y[k], 1e-7 * size);
  free(d), free(above), free(below), free(product.y), destroy(f);
}
END_TEST

// A block 0.3 into flat ground: a half-space, or a coarse block of tetrahedra wide enough.
static Fixture *block_on_ground(ContactPotential potential, bool is_mesh) {
  static ContactShape ground = {.name = "ground", .normal = {0, 0, 1}};
  Fixture *f = empty_fixture();
  blocks_add(
      &f->blocks,
      &(BlockDef){.corner = {0.1, 0.2, -0.3}, .cell = {1, 0.9, 0.8}, .cells = {2, 2, 2}, .jitter = 0.1});
  if (is_mesh)
    blocks_add(&f->blocks, &(BlockDef){.corner = {-3.07, -2.9, -4},
                                       .cell = {2.3, 2.1, 2},
                                       .cells = {4, 4, 2},
                                       .is_obstacle = true});
  prepare(f);
  ContactSystemDef def = blocks_def(&f->blocks, f->rest, &f->model);
  def.potential = potential;
  if (!is_mesh) def.shapes = &ground, def.shape_count = 1;
  start(f, &def);
  return f;
}

START_TEST(ground_of_tetrahedra_pushes_like_a_halfspace) {
  Fixture *mesh = block_on_ground(CONTACT_POTENTIAL_NODAL, true),
          *plane = block_on_ground(CONTACT_POTENTIAL_NODAL, false);
  double energy = energy_at(plane, plane->blocks.x);
  ck_assert(energy > 0);
  ck_assert_near(energy_at(mesh, mesh->blocks.x), energy, 10 * NUDGE * energy);
  double *on_mesh = forces_at(mesh, mesh->blocks.x), *on_plane = forces_at(plane, plane->blocks.x);
  double size = sqrt(product_dot(on_plane, on_plane, 3 * plane->blocks.vertex_count));
  for (int k = 0; k < 3 * plane->blocks.vertex_count; k++)
    ck_assert_near(on_mesh[k], on_plane[k], 10 * NUDGE * size);
  free(on_mesh), free(on_plane), destroy(mesh), destroy(plane);
}
END_TEST

START_TEST(a_third_body_does_not_change_the_force_between_two) {
  Fixture *two = pressed_system(CONTACT_POTENTIAL_NODAL, false);
  Fixture *three = pressed_blocks(false);
  // Covers some of the same elements of the lower block, from beside.
  blocks_add(&three->blocks, &(BlockDef){.corner = {2.4, 0.2, 1.6}, .cell = {1, 1, 1}, .cells = {1, 2, 1}});
  free(three->rest), free(three->still), overlap_model_destroy(&three->model);
  prepare(three);
  ContactSystemDef def = blocks_def(&three->blocks, three->rest, &three->model);
  start(three, &def);
  const ContactInterface *alone = evaluated_at(two->system, 0, two->blocks.x)->interfaces;
  const ContactInterface *with = evaluated_at(three->system, 0, three->blocks.x)->interfaces;
  ck_assert_int_eq(contact_system_layout(three->system)->interface_count, 3);
  ck_assert_int_gt(with[1].active_count, 0);
  for (int c = 0; c < 3; c++) ck_assert_near(with[0].force[c], alone[0].force[c], 0);
  destroy(two), destroy(three);
}
END_TEST

START_TEST(bodies_apart_have_no_energy_and_no_force) {
  Fixture *f = pressed_system(CONTACT_POTENTIAL_NODAL, false);
  blocks_shift(&f->blocks, f->blocks.x, 1, (double[]){0, 0, 5});
  ck_assert_ok(contact_system_update(f->system, 0, f->blocks.x, f->still, 0.01));
  double *force = forces_at(f, f->blocks.x);
  const ContactEvaluation *evaluation = evaluated_at(f->system, 0, f->blocks.x);
  ck_assert_near(evaluation->energy, 0, 0);
  for (int k = 0; k < 3 * f->blocks.vertex_count; k++) ck_assert_near(force[k], 0, 0);
  ck_assert_int_eq(contact_evaluation_active_count(evaluation), 0);
  free(force), destroy(f);
}
END_TEST

// ---- Audit

static Status eval_scaled(const void *self, const double pair[24], const OverlapAnswer *answer) {
  const OverlapModel *model = self;
  TRY(model->ops->eval_pair(model->self, pair, answer));
  *answer->volume *= 1.001;
  for (int k = 0; answer->gradient && k < 24; k++) answer->gradient[k] *= 1.001;
  return STATUS_OK;
}

START_TEST(an_audit_measures_a_known_error_and_changes_nothing) {
  static const OverlapOps SCALED = {.name = "scaled", .eval_pair = eval_scaled};
  Fixture *f = pressed_system(CONTACT_POTENTIAL_NODAL, false);
  const ContactEvaluation *evaluation = evaluated_at(f->system, 0, f->blocks.x);
  double energy = evaluation->energy, *moved = blocks_copy(&f->blocks);
  blocks_shift(&f->blocks, moved, 1, (double[]){0, 0, 0.05});
  ContactCounters before = *contact_system_counters(f->system);
  OverlapModel scaled = {&SCALED, &f->model};
  ContactAudit audit;
  ck_assert_ok(contact_system_audit(f->system, 0, moved, &scaled, &f->model, &audit));
  ck_assert_near(contact_audit_error(audit.volume), 1e-3, 1e-12);
  ck_assert_near(contact_audit_error(audit.gradient), 1.001 * 1.001 - 1, 1e-12);
  ck_assert_near(contact_audit_error(audit.force), 1.001 * 1.001 - 1, 1e-12);
  ck_assert_near(contact_audit_error(audit.total), 1.001 * 1.001 - 1, 1e-12);
  ck_assert_int_gt(audit.pair_count, 20);
  ck_assert_ok(contact_system_audit(f->system, 0, moved, &f->model, &f->model, &audit));
  ck_assert_near(contact_audit_error(audit.volume), 0, 0);
  ck_assert_near(contact_audit_error(audit.gradient), 0, 0);
  ck_assert_near(contact_audit_error(audit.force), 0, 0);
  ck_assert_near(contact_audit_error(audit.total), 0, 0);
  ck_assert_near(evaluation->energy, energy, 0);
  ck_assert_int_eq(contact_system_counters(f->system)->evaluations, before.evaluations);
  free(moved), destroy(f);
}
END_TEST

// ---- What is refused

START_TEST(a_definition_that_cannot_be_is_refused) {
  Fixture *f = pressed_blocks(false);
  ContactSystem *system;
  ContactSystemDef def = blocks_def(&f->blocks, f->rest, &f->model), wrong = def;
  wrong.stiffness = NAN;
  ck_assert_int_eq(contact_system_create(&system, &wrong), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "stiffness"));
  wrong = def, wrong.margin = -1;
  ck_assert_int_eq(contact_system_create(&system, &wrong), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "margin"));
  ContactShape skew = {.name = "skew", .normal = {0, 0, 2}};
  wrong = def, wrong.shapes = &skew, wrong.shape_count = 1;
  ck_assert_int_eq(contact_system_create(&system, &wrong), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "skew"));
  memcpy(f->rest + 3 * f->blocks.tets[5][1], f->rest + 3 * f->blocks.tets[5][0], 3 * sizeof(double));
  ck_assert_int_eq(contact_system_create(&system, &def), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "volume"));
  destroy(f);
}
END_TEST

static Status eval_nan(const void *self, const double pair[24], const OverlapAnswer *answer) {
  TRY(eval_scaled(self, pair, answer));
  *answer->volume = NAN;
  return STATUS_OK;
}

START_TEST(a_model_that_answers_nan_is_named) {
  static const OverlapOps BROKEN = {.name = "broken", .eval_pair = eval_nan};
  Fixture *f = pressed_blocks(false);
  OverlapModel broken = {&BROKEN, &f->model};
  ContactSystemDef def = blocks_def(&f->blocks, f->rest, &broken);
  start(f, &def);
  const ContactEvaluation *evaluation;
  ck_assert_int_eq(contact_evaluate(f->system, 0, 0, f->blocks.x, &evaluation), STATUS_SOLVER);
  ck_assert_ptr_nonnull(strstr(status_message(), "element"));
  destroy(f);
}
END_TEST

static void ignore_outer(void *self, int count, const int *vertices, const double *w, double scale) {
  (void)self, (void)count, (void)vertices, (void)w, (void)scale;
}

static void ignore_dense(void *self, int count, const int *vertices, const double *matrix) {
  (void)self, (void)count, (void)vertices, (void)matrix;
}

static Status ignore_clique(void *self, int count, const int *vertices) {
  (void)self, (void)count, (void)vertices;
  return STATUS_OK;
}

static Status whole_life(const Fixture *f) {
  ContactSystemDef def = blocks_def(&f->blocks, f->rest, &f->model);
  ContactStiffnessSink sink = {NULL, ignore_outer, ignore_dense};
  ContactSystem *system = NULL;
  ContactAudit audit;
  ContactCoupled coupled = {0};
  const ContactEvaluation *evaluation;
  Status status = contact_system_create(&system, &def);
  if (!status) status = contact_system_update(system, 0, f->blocks.x, f->still, 0.01);
  if (!status) status = contact_evaluate(system, 0, 0, f->blocks.x, &evaluation);
  if (!status) status = contact_system_stiffness(system, evaluation, &sink);
  if (!status) status = contact_system_couple(system, evaluation, 0.1, &coupled, NULL, ignore_clique);
  if (!status) status = contact_system_audit(system, 0, f->blocks.x, &f->model, &f->model, &audit);
  contact_coupled_destroy(&coupled);
  contact_system_destroy(system);
  return status;
}

START_TEST(every_failed_allocation_is_reported) {
  Fixture *f = pressed_blocks(false);
  Status status = STATUS_MEMORY;
  int k = 1;
  for (; status == STATUS_MEMORY && k < 1000; k++) {
    memory_fail_at(k);
    status = whole_life(f);
    memory_fail_at(0);
  }
  ck_assert_ok(status);
  ck_assert_int_gt(k, 50);
  destroy(f);
}
END_TEST

int main(void) {
  int all = CONTACT_POTENTIAL_COUNT;
  TCase *cases = tcase_create("contact");
  tcase_add_loop_test(cases, forces_are_minus_the_gradient_of_the_energy, 0, 2 * all);
  tcase_add_loop_test(cases, stiffness_is_minus_the_derivative_of_the_forces, 0, 2);
  tcase_add_loop_test(cases, two_bodies_keep_momentum_and_angular_momentum, 0, 2 * all);
  tcase_add_loop_test(cases, elements_turned_inside_out_keep_momentum_and_angular_momentum, 0, 2 * all);
  tcase_add_test(cases, covered_volumes_sum_to_the_overlap);
  tcase_add_loop_test(cases, a_tip_in_a_halfspace_is_as_by_hand, 0, all);
  tcase_add_test(cases, a_halfspace_moves_with_its_velocity);
  tcase_add_test(cases, stiffness_against_a_halfspace_is_the_derivative);
  tcase_add_test(cases, ground_of_tetrahedra_pushes_like_a_halfspace);
  tcase_add_test(cases, a_third_body_does_not_change_the_force_between_two);
  tcase_add_test(cases, bodies_apart_have_no_energy_and_no_force);
  tcase_add_test(cases, an_audit_measures_a_known_error_and_changes_nothing);
  tcase_add_test(cases, a_definition_that_cannot_be_is_refused);
  tcase_add_test(cases, a_model_that_answers_nan_is_named);
  tcase_add_test(cases, every_failed_allocation_is_reported);
  return suite_run("contact", cases, 60);
}

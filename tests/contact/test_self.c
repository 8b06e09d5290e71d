// SPDX-License-Identifier: GPL-3.0-or-later
// contact/self: a body that meets itself.
#include "blocks.h"
#include "evaluated.h"
#include "product.h"

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/search/layout.h"
#include "overlap/models.h"
#include "overlap/separation.h"

// Overlap models see vertices shifted by less than this (contact/search/layout.h) [m].
static const double NUDGE = 2e-9;

typedef struct Fixture {
  Blocks blocks;
  double *rest, *still, *x; // at rest; zero velocities; now
  OverlapModel model;
  ContactSystem *system;
} Fixture;

static Fixture *empty_fixture(void) {
  Fixture *f = calloc(1, sizeof *f);
  ck_assert_ptr_nonnull(f);
  ck_assert_ok(overlap_models_create(&f->model, "clip"));
  return f;
}

// All blocks become one body, which may meet itself.
static void join(Blocks *blocks, bool meets_itself) {
  blocks->bodies[0].vertex_end = blocks->vertex_count;
  blocks->bodies[0].tet_end = blocks->tet_count;
  blocks->bodies[0].meets_itself = meets_itself;
  blocks->body_count = 1;
}

static void start(Fixture *f, ContactPotential potential) {
  f->rest = blocks_copy(&f->blocks);
  f->x = blocks_copy(&f->blocks);
  f->still = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(f->still);
  ContactSystemDef def = blocks_def(&f->blocks, f->rest, &f->model);
  def.potential = potential;
  ck_assert_ok(contact_system_create(&f->system, &def));
}

static void update(Fixture *f) {
  ck_assert_ok(contact_system_update(f->system, 0, f->x, f->still, 0.01));
}

static void destroy(Fixture *f) {
  contact_system_destroy(f->system);
  overlap_model_destroy(&f->model);
  blocks_destroy(&f->blocks);
  free(f->rest), free(f->still), free(f->x), free(f);
}

// Two irregular blocks that stand apart at rest; then the upper one is pressed 0.3 elements into the lower.
static Fixture *pressed_blocks(ContactPotential potential, bool as_one_body) {
  Fixture *f = empty_fixture();
  blocks_add(&f->blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {3, 3, 2}, .jitter = 0.15});
  blocks_add(
      &f->blocks,
      &(BlockDef){.corner = {0.63, 0.41, 2.7}, .cell = {0.83, 0.9, 0.8}, .cells = {2, 2, 2}, .jitter = 0.15});
  int upper = f->blocks.bodies[1].vertex_begin;
  if (as_one_body) join(&f->blocks, true);
  start(f, potential);
  for (int v = upper; v < f->blocks.vertex_count; v++) f->x[3 * v + 2] -= 1;
  update(f);
  return f;
}

// A strip of 12 × 2 × 1 cells rolled up to 1.1 turns, so that its ends overlap.
static Fixture *rolled_strip(ContactPotential potential) {
  Fixture *f = empty_fixture();
  blocks_add(&f->blocks, &(BlockDef){.cell = {0.5, 0.5, 0.4}, .cells = {12, 2, 1}, .jitter = 0.1});
  join(&f->blocks, true);
  start(f, potential);
  for (int v = 0; v < f->blocks.vertex_count; v++) {
    double *x = f->x + 3 * v, angle = 1.1 * 2 * M_PI * x[0] / 6,
           radius = 6 / (2 * M_PI) - x[2] + 0.05 * angle;
    x[0] = radius * sin(angle), x[2] = -radius * cos(angle);
  }
  update(f);
  return f;
}

static double eval(Fixture *f, const double *x, double *force) {
  if (!force) return evaluated_at(f->system, 0, x)->energy;
  memset(force, 0, 3 * sizeof(double) * (size_t)f->blocks.vertex_count);
  return evaluated_with_force(f->system, x, force)->energy;
}

static double *random_motion(const Fixture *f, uint64_t stream) {
  Random random = random_seeded(22, stream);
  double *d = calloc(3 * (size_t)f->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(d);
  for (int k = 0; k < 3 * f->blocks.vertex_count; k++) d[k] = random_between(&random, -1, 1);
  return d;
}

static double *multiply(Fixture *f, const double *d) {
  Product product = product_of(d, f->blocks.vertex_count);
  ContactStiffnessSink sink = product_sink(&product);
  ck_assert_ok(contact_system_stiffness(f->system, evaluated_at(f->system, 0, f->x), &sink));
  return product.y;
}

START_TEST(parts_of_a_body_press_each_other_as_two_bodies_would) {
  Fixture *one = pressed_blocks((ContactPotential)_i, true),
          *two = pressed_blocks((ContactPotential)_i, false);
  int n = 3 * one->blocks.vertex_count;
  double *force = random_motion(one, 0), *expected = random_motion(one, 0), *d = random_motion(one, 1);
  double energy = eval(one, one->x, force), energy_of_two = eval(two, two->x, expected);
  const ContactEvaluation *within = evaluated_at(one->system, 0, one->x),
                          *across = evaluated_at(two->system, 0, two->x);
  ck_assert_int_gt(contact_evaluation_active_count(within), 20);
  ck_assert_int_eq(contact_evaluation_active_count(within), contact_evaluation_active_count(across));
  // The nudges differ: heights by up to 2 NUDGE of an overlap 0.3 deep, sides by more of what is cut there.
  ck_assert_near(energy, energy_of_two, 100 * NUDGE * energy);
  double size = sqrt(product_dot(expected, expected, n));
  for (int k = 0; k < n; k++) ck_assert_near(force[k], expected[k], 100 * NUDGE * size);
  double *product = multiply(one, d), *product_of_two = multiply(two, d);
  double product_size = sqrt(product_dot(product_of_two, product_of_two, n));
  for (int k = 0; k < n; k++) ck_assert_near(product[k], product_of_two[k], 1e-5 * product_size);
  const ContactInterface *own = within->interfaces, *between = across->interfaces;
  ck_assert_int_eq(contact_system_layout(one->system)->interface_count, 1);
  ck_assert_int_eq(contact_system_layout(two->system)->interface_count, 1);
  for (int c = 0; c < 3; c++)
    ck_assert_near(own->force[c], between->force[c], 1e-5 * vec3_length(vec3_at(between->force)));
  free(force), free(expected), free(d), free(product), free(product_of_two), destroy(one), destroy(two);
}
END_TEST

START_TEST(forces_within_a_body_are_minus_the_gradient_and_balance) {
  Fixture *f = rolled_strip((ContactPotential)_i);
  int n = 3 * f->blocks.vertex_count;
  double *force = random_motion(f, 0), *x = random_motion(f, 0);
  eval(f, f->x, force);
  ck_assert_int_gt(contact_evaluation_active_count(evaluated_at(f->system, 0, f->x)), 20);
  double size = sqrt(product_dot(force, force, n));
  Vec3 sum = {0, 0, 0}, torque = {0, 0, 0};
  for (int v = 0; v < f->blocks.vertex_count; v++) {
    sum = vec3_add(sum, vec3_at(force + 3 * v));
    torque = vec3_add(torque, vec3_cross(vec3_at(f->x + 3 * v), vec3_at(force + 3 * v)));
  }
  ck_assert_double_le(vec3_length(sum), 1e-12 * size);
  ck_assert_double_le(vec3_length(torque), 100 * NUDGE * size);
  for (uint64_t stream = 1; stream < 6; stream++) {
    double h = 1e-6, *d = random_motion(f, stream);
    for (int k = 0; k < n; k++) x[k] = f->x[k] + h * d[k];
    double above = eval(f, x, NULL);
    for (int k = 0; k < n; k++) x[k] = f->x[k] - h * d[k];
    ck_assert_near((above - eval(f, x, NULL)) / (2 * h), -product_dot(force, d, n), 1e-6 * size);
    free(d);
  }
  free(force), free(x), destroy(f);
}
END_TEST

START_TEST(stiffness_within_a_body_is_minus_the_derivative_of_the_forces) {
  Fixture *f = rolled_strip(CONTACT_POTENTIAL_FIELD);
  int n = 3 * f->blocks.vertex_count;
  double *above = random_motion(f, 0), *below = random_motion(f, 0), *x = random_motion(f, 0);
  for (uint64_t stream = 1; stream < 4; stream++) {
    double h = 1e-6, *d = random_motion(f, stream);
    for (int k = 0; k < n; k++) x[k] = f->x[k] + h * d[k];
    eval(f, x, above);
    for (int k = 0; k < n; k++) x[k] = f->x[k] - h * d[k];
    eval(f, x, below);
    double *product = multiply(f, d), size = sqrt(product_dot(product, product, n));
    ck_assert_double_gt(size, 0);
    for (int k = 0; k < n; k++) ck_assert_near(-(above[k] - below[k]) / (2 * h), product[k], 2e-5 * size);
    free(d), free(product);
  }
  free(above), free(below), free(x), destroy(f);
}
END_TEST

START_TEST(a_body_that_is_crumpled_without_folding_does_not_push_its_neighbours_apart) {
  Fixture *f = empty_fixture();
  blocks_add(&f->blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {4, 4, 3}, .jitter = 0.15});
  join(&f->blocks, true);
  start(f, CONTACT_POTENTIAL_NODAL);
  update(f);
  ck_assert_near(eval(f, f->x, NULL), 0, 0);
  ck_assert_int_eq((int)contact_system_counters(f->system)->resting, 0);
  for (int v = 0; v < f->blocks.vertex_count; v++) f->x[3 * v + 2] *= 0.1, f->x[3 * v] += f->x[3 * v + 1];
  update(f);
  ck_assert_near(eval(f, f->x, NULL), 0, 0); // an affine map keeps what is disjoint disjoint
  destroy(f);
}
END_TEST

START_TEST(pairs_that_overlap_at_rest_are_left_out_and_counted) {
  Fixture *f = empty_fixture();
  blocks_add(&f->blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {2, 2, 2}, .jitter = 0.1});
  blocks_add(&f->blocks,
             &(BlockDef){.corner = {0.6, 0.7, 1.8}, .cell = {1, 1, 1}, .cells = {2, 2, 2}, .jitter = 0.1});
  int upper = f->blocks.bodies[1].vertex_begin;
  join(&f->blocks, true);
  start(f, CONTACT_POTENTIAL_NODAL);
  update(f);
  ck_assert_near(eval(f, f->x, NULL), 0, 0);
  ck_assert_int_gt((int)contact_system_counters(f->system)->resting, 5);
  // Others meet when the upper part goes on.
  for (int v = upper; v < f->blocks.vertex_count; v++) f->x[3 * v + 2] -= 0.7;
  update(f);
  ck_assert_double_gt(eval(f, f->x, NULL), 0);
  destroy(f);
}
END_TEST

static bool share_vertex(const int a[4], const int b[4]) {
  for (int v = 0; v < 16; v++)
    if (a[v / 4] == b[v % 4]) return true;
  return false;
}

START_TEST(every_pair_that_overlaps_is_found) {
  Fixture *f = rolled_strip(CONTACT_POTENTIAL_NODAL);
  int expected = 0, count, *tets;
  double *pairs;
  ck_assert_ok(
      contact_system_active_pairs(f->system, evaluated_at(f->system, 0, f->x), &count, &pairs, &tets));
  for (int i = 0; i < f->blocks.tet_count; i++)
    for (int j = i + 1; j < f->blocks.tet_count; j++) {
      double x[24], volume;
      if (share_vertex(f->blocks.tets[i], f->blocks.tets[j])) continue;
      for (int v = 0; v < 4; v++)
        for (int c = 0; c < 3; c++) {
          x[3 * v + c] = f->x[3 * f->blocks.tets[i][v] + c];
          x[12 + 3 * v + c] = f->x[3 * f->blocks.tets[j][v] + c];
        }
      ck_assert_ok(
          overlap_model_eval(&f->model, &(OverlapBatch){.pair_count = 1, .pairs = x, .volume = &volume}));
      if (!(volume > 1e-8)) continue;
      bool is_found = false;
      for (int k = 0; k < count; k++) is_found = is_found || (tets[2 * k] == i && tets[2 * k + 1] == j);
      ck_assert_msg(is_found, "%d and %d share %g", i, j, volume);
      expected++;
    }
  ck_assert_int_gt(expected, 20);
  ck_assert_int_ge(count, expected);
  memory_free(pairs), memory_free(tets), destroy(f);
}
END_TEST

START_TEST(a_body_that_only_flies_is_searched_once) {
  Fixture *f = rolled_strip(CONTACT_POTENTIAL_NODAL);
  double before = eval(f, f->x, NULL);
  for (int step = 0; step < 20; step++) {
    for (int v = 0; v < f->blocks.vertex_count; v++) f->x[3 * v] += 1, f->still[3 * v] = 100;
    update(f);
    ck_assert_near(eval(f, f->x, NULL), before, 1e-6 * before);
  }
  ck_assert_int_eq((int)contact_system_counters(f->system)->searches, 1);
  destroy(f);
}
END_TEST

START_TEST(motion_within_a_body_beyond_the_margin_is_refused) {
  Fixture *f = rolled_strip(CONTACT_POTENTIAL_NODAL);
  const ContactEvaluation *evaluation;
  for (int v = 0; v < f->blocks.vertex_count; v++) f->x[3 * v] *= 1.5;
  ck_assert_int_eq(contact_evaluate(f->system, 0, 0, f->x, &evaluation), STATUS_RETRY);
  f->x[0] = NAN;
  ck_assert_int_eq(contact_evaluate(f->system, 0, 0, f->x, &evaluation), STATUS_RETRY);
  destroy(f);
}
END_TEST

START_TEST(a_body_without_self_contact_costs_nothing) {
  Fixture *f = empty_fixture();
  blocks_add(&f->blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {2, 2, 2}});
  start(f, CONTACT_POTENTIAL_NODAL);
  update(f);
  const ContactLayout *layout = contact_system_layout(f->system);
  ck_assert_int_eq(layout->interface_count, 0);
  ck_assert_ptr_null(layout->shifts);
  ck_assert_ptr_null(layout->self.outer);
  eval(f, f->x, NULL);
  ck_assert_int_eq((int)contact_system_counters(f->system)->pairs.tried, 0);
  destroy(f);
}
END_TEST

START_TEST(the_surface_is_where_faces_stand_alone) {
  Fixture *f = empty_fixture();
  blocks_add(&f->blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {5, 5, 5}});
  join(&f->blocks, true);
  start(f, CONTACT_POTENTIAL_NODAL);
  const ContactSelf *self = &contact_system_layout(f->system)->self;
  // All but the tetrahedra of cells that touch no face of the block: those of the inner 27 cells.
  ck_assert_int_eq(self->outer_count, f->blocks.tet_count - 27 * 6);
  destroy(f);
}
END_TEST

START_TEST(a_failed_allocation_leaves_nothing_behind) {
  for (int k = 1; k < 200; k++) {
    Fixture *f = empty_fixture();
    blocks_add(&f->blocks, &(BlockDef){.cell = {1, 1, 1}, .cells = {2, 1, 1}});
    join(&f->blocks, true);
    f->rest = blocks_copy(&f->blocks);
    ContactSystemDef def = blocks_def(&f->blocks, f->rest, &f->model);
    memory_fail_at(k);
    Status status = contact_system_create(&f->system, &def);
    memory_fail_at(0);
    bool is_done = status == STATUS_OK;
    if (is_done) ck_assert_int_gt(k, 10);
    if (!is_done) ck_assert_int_eq(status, STATUS_MEMORY);
    destroy(f);
    if (is_done) return;
  }
  ck_abort_msg("never enough memory");
}
END_TEST

int main(void) {
  TCase *tcase = tcase_create("self");
  tcase_add_loop_test(tcase, parts_of_a_body_press_each_other_as_two_bodies_would, 0,
                      CONTACT_POTENTIAL_COUNT);
  tcase_add_loop_test(tcase, forces_within_a_body_are_minus_the_gradient_and_balance, 0,
                      CONTACT_POTENTIAL_COUNT);
  tcase_add_test(tcase, stiffness_within_a_body_is_minus_the_derivative_of_the_forces);
  tcase_add_test(tcase, a_body_that_is_crumpled_without_folding_does_not_push_its_neighbours_apart);
  tcase_add_test(tcase, pairs_that_overlap_at_rest_are_left_out_and_counted);
  tcase_add_test(tcase, every_pair_that_overlaps_is_found);
  tcase_add_test(tcase, a_body_that_only_flies_is_searched_once);
  tcase_add_test(tcase, motion_within_a_body_beyond_the_margin_is_refused);
  tcase_add_test(tcase, a_body_without_self_contact_costs_nothing);
  tcase_add_test(tcase, the_surface_is_where_faces_stand_alone);
  tcase_add_test(tcase, a_failed_allocation_leaves_nothing_behind);
  return suite_run("self", tcase, 60);
}

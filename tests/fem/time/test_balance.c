// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's balance at its edges: what is allowed of a body's weight, of its inertia, and without either.
#include "scene.h"

#include <math.h>

#include "fem/time/newton/balance.h"

typedef struct Balanced {
  SceneRun run;
  FemNumbering numbering;
  FemPart part;
  FemBalance balance;
  FemState state;
  double *forces, *residual;
} Balanced;

// A block in the air; no force acts unless a test says so.
static void open_balanced(Balanced *balanced, const char *const *overrides) {
  scene_open(&balanced->run, "free_fall", overrides);
  const FemModel *model = &balanced->run.model;
  ck_assert_ok(fem_numbering_create(&balanced->numbering, model));
  ck_assert_ok(fem_part_create(&balanced->part, model, &balanced->numbering));
  ck_assert_ok(fem_balance_create(&balanced->balance, model->body_count));
  balanced->forces = calloc(3 * (size_t)model->vertex_count, sizeof(double));
  ck_assert_ok(fem_state_create(&balanced->state, model->vertex_count, model->rest, balanced->forces));
  balanced->residual = calloc((size_t)balanced->numbering.count, sizeof(double));
}

static double excess_under(Balanced *balanced, const double *pressing) {
  return fem_balance_excess(&balanced->balance, &balanced->run.model, &balanced->part, &balanced->state,
                            balanced->forces, pressing, balanced->residual);
}

static double excess(Balanced *balanced) {
  return excess_under(balanced, NULL);
}

// What is allowed of the residual is just allowed, and a little more is not.
static void check_edge(Balanced *balanced, const double *pressing, double *residual, double allowed) {
  *residual = allowed * (1 - 1e-9);
  ck_assert_double_le(excess_under(balanced, pressing), 1);
  *residual = allowed * (1 + 1e-9);
  ck_assert_double_gt(excess_under(balanced, pressing), 1);
}

static void close_balanced(Balanced *balanced) {
  free(balanced->residual), free(balanced->forces);
  fem_state_destroy(&balanced->state);
  fem_balance_destroy(&balanced->balance);
  fem_part_destroy(&balanced->part);
  fem_numbering_destroy(&balanced->numbering);
  scene_close(&balanced->run);
}

START_TEST(forces_at_rest_balance_to_a_share_of_the_weight) {
  Balanced balanced;
  open_balanced(&balanced, NULL);
  double weight = 9.81 * balanced.run.model.bodies[0].mass;
  check_edge(&balanced, NULL, &balanced.residual[5], 2e-4 * weight);
  balanced.residual[5] = -(1 - 1e-6) * 2e-4 * weight; // its sign means nothing
  ck_assert_double_lt(excess(&balanced), 1);
  balanced.residual[6] = 2e-6 * 2e-4 * weight; // of several the sum
  ck_assert_double_gt(excess(&balanced), 1);
  close_balanced(&balanced);
}
END_TEST

START_TEST(what_accelerates_balances_to_a_share_of_what_that_takes) {
  Balanced balanced;
  open_balanced(&balanced, NULL);
  double weight = 9.81 * balanced.run.model.bodies[0].mass;
  balanced.forces[balanced.numbering.dof_of_unknown[3]] = 10 * weight;
  // which is part of what the acceleration takes
  check_edge(&balanced, NULL, &balanced.residual[5], 2e-3 * 10 * weight / (1 - 2e-3));
  close_balanced(&balanced);
}
END_TEST

START_TEST(without_gravity_the_forces_of_contact_count_in_place_of_the_weight) {
  Balanced balanced;
  open_balanced(&balanced, (const char *const[]){"effects.gravity=[0,0,0]", NULL});
  double *pressing = calloc(3 * (size_t)balanced.run.model.vertex_count, sizeof(double));
  pressing[0] = 3, pressing[1] = -4; // of two vertices 5 N and 2 N
  pressing[3] = 2;
  check_edge(&balanced, pressing, &balanced.residual[5], 2e-4 * 7);
  free(pressing);
  close_balanced(&balanced);
}
END_TEST

START_TEST(without_weight_and_motion_rounding_of_what_the_tolerance_strains_is_allowed) {
  Balanced balanced;
  open_balanced(&balanced, (const char *const[]){"effects.gravity=[0,0,0]", "time.tolerance=1e-4", NULL});
  double edge = balanced.run.model.edge;
  check_edge(&balanced, NULL, &balanced.residual[5], 1e-6 * 1e-4 * 1e6 * edge * edge);
  close_balanced(&balanced);
}
END_TEST

START_TEST(a_residual_that_is_no_number_does_not_balance) {
  Balanced balanced;
  open_balanced(&balanced, NULL);
  balanced.residual[5] = NAN;
  ck_assert(!(excess(&balanced) <= 1));
  close_balanced(&balanced);
}
END_TEST

// What a step leaves unbalanced turns a stiff body on: with 20 times as much this bar gains 6e-3 of its
// energy.
START_TEST(a_stiff_bar_that_spins_about_a_hinge_gains_no_energy) {
  SceneRun run;
  scene_open(&run, "cantilever",
             (const char *const[]){
                 "time={end: 0.2}", "effects.gravity=[0, 0, 0]",
                 "bodies.beam.mesh.box={size: [0.4, 0.04, 0.04], cells: [10, 2, 2]}",
                 "bodies.beam.material={young: 1e8, poisson: 0.3, density: 1000}",
                 "bodies.beam.spin=[0, 10, 0]",
                 "bodies.beam.fixed=[{box: {min: [-1e-6, -1, -1e-6], max: [1e-6, 1, 1e-6]}}]", NULL});
  scene_run_from(&run, NULL);
  ck_assert_int_eq(run.status, STATUS_OK);
  ck_assert_double_gt(run.result.energy.audit.scale, 0);
  ck_assert_double_lt(run.result.energy.audit.gain, 1e-4 * run.result.energy.audit.scale);
  scene_close(&run);
}
END_TEST

// Once what is left along a rotation has given it some, it may go on with a share of Σ m |v̇| |v|; against it,
// and across, it may be more.
START_TEST(what_is_left_gives_a_rotation_a_promise_of_its_energy_in_a_turn) {
  Balanced balanced;
  open_balanced(&balanced, (const char *const[]){"effects.gravity=[0,0,0]", NULL});
  const FemModel *model = &balanced.run.model;
  const double spin = 3;
  double turnover = 0;
  for (int a = 0; a < model->vertex_count; a++) { // about z through the middle, the forces those of the turn
    double x = model->rest[3 * a] - 0.1, y = model->rest[3 * a + 1] - 0.1, square = spin * spin;
    double *v = balanced.state.velocities + 3 * a, *f = balanced.forces + 3 * a;
    v[0] = -spin * y + 5, v[1] = spin * x, v[2] = -7; // and moves on, which means nothing
    f[0] = -square * model->mass[a] * x, f[1] = -square * model->mass[a] * y;
    turnover += 2 * fabs(square * spin * model->mass[a] * x * y);
  }
  int last = 3 * (model->vertex_count - 1);               // at a corner: x = y = 0.1
  double allowed = 0.08e-3 * turnover / (spin * 0.1 * 2); // along the turn
  balanced.residual[last] = -allowed, balanced.residual[last + 1] = allowed;
  ck_assert_double_le(excess(&balanced), 1); // nothing was given yet
  fem_balance_keep(&balanced.balance, model, 1e6);
  balanced.residual[last] = -allowed * (1 - 1e-3), balanced.residual[last + 1] = allowed * (1 - 1e-3);
  ck_assert_double_le(excess(&balanced), 1);
  balanced.residual[last] = -allowed * (1 + 1e-2), balanced.residual[last + 1] = allowed * (1 + 1e-2);
  ck_assert_double_gt(excess(&balanced), 1);
  balanced.residual[last] = 2 * allowed, balanced.residual[last + 1] = -2 * allowed; // it takes some back
  ck_assert_double_le(excess(&balanced), 1);
  balanced.residual[last] = balanced.residual[last + 1] = 2 * allowed; // across it
  ck_assert_double_lt(excess(&balanced), 1);
  close_balanced(&balanced);
}
END_TEST

// By Newton's last corrections alone, which shorter steps do not remove, it would gain several per cent.
START_TEST(a_block_that_spins_freely_keeps_its_energy) {
  SceneRun run;
  scene_open(&run, "free_fall",
             (const char *const[]){"time.end=1", "effects.gravity=[0, 0, 0]",
                                   "bodies.block.material={young: 1e7, poisson: 0.3, density: 1000}",
                                   "bodies.block.mesh.box={size: [0.1, 0.1, 0.02], cells: [4, 4, 1]}",
                                   "bodies.block.spin=[0, 0, 100]", "effects.damping=1e-3", NULL});
  scene_run_from(&run, NULL);
  ck_assert_int_eq(run.status, STATUS_OK);
  ck_assert_double_lt(run.result.energy.audit.gain, 1e-3 * run.result.energy.audit.scale);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("balance");
  tcase_add_test(cases, forces_at_rest_balance_to_a_share_of_the_weight);
  tcase_add_test(cases, what_accelerates_balances_to_a_share_of_what_that_takes);
  tcase_add_test(cases, without_gravity_the_forces_of_contact_count_in_place_of_the_weight);
  tcase_add_test(cases, without_weight_and_motion_rounding_of_what_the_tolerance_strains_is_allowed);
  tcase_add_test(cases, a_stiff_bar_that_spins_about_a_hinge_gains_no_energy);
  tcase_add_test(cases, a_residual_that_is_no_number_does_not_balance);
  tcase_add_test(cases, what_is_left_gives_a_rotation_a_promise_of_its_energy_in_a_turn);
  tcase_add_test(cases, a_block_that_spins_freely_keeps_its_energy);
  return suite_run("balance", cases, 20);
}

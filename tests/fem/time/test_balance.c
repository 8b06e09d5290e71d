// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's balance at its edges: what is allowed of a body's weight, of its inertia, and without either.
#include "scene.h"

#include <math.h>
#include <string.h>

#include "fem/time/newton/balance.h"

typedef struct Balanced {
  SceneRun run;
  FemSystem system;
  FemPart part;
  FemBalance balance;
  double *residual;
} Balanced;

// A block in the air; no force acts unless a test says so.
static void open_balanced(Balanced *balanced, const char *const *overrides) {
  scene_open(&balanced->run, "free_fall", overrides);
  const FemModel *model = &balanced->run.model;
  ck_assert_ok(fem_system_create(&balanced->system, model));
  ck_assert_ok(fem_part_create(&balanced->part, model, &balanced->system.numbering));
  ck_assert_ok(fem_balance_create(&balanced->balance, model->body_count));
  balanced->residual = calloc((size_t)balanced->system.numbering.count, sizeof(double));
  memset(balanced->system.forces, 0, 3 * (size_t)model->vertex_count * sizeof(double));
}

static double excess(Balanced *balanced) {
  return fem_balance_excess(&balanced->balance, &balanced->system, NULL, &balanced->part, balanced->residual);
}

static void close_balanced(Balanced *balanced) {
  free(balanced->residual);
  fem_balance_destroy(&balanced->balance);
  fem_part_destroy(&balanced->part);
  fem_system_destroy(&balanced->system);
  scene_close(&balanced->run);
}

START_TEST(forces_at_rest_balance_to_a_share_of_the_weight) {
  Balanced balanced;
  open_balanced(&balanced, NULL);
  double weight = 9.81 * balanced.run.model.bodies[0].mass;
  balanced.residual[5] = 2e-4 * weight;
  ck_assert_near(excess(&balanced), 1, 1e-9);
  balanced.residual[5] *= -1 + 1e-6; // its sign means nothing
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
  balanced.system.forces[balanced.system.numbering.dof_of_unknown[3]] = 10 * weight;
  balanced.residual[5] = 2e-3 * 10 * weight / (1 - 2e-3); // which is part of what the acceleration takes
  ck_assert_near(excess(&balanced), 1, 1e-9);
  close_balanced(&balanced);
}
END_TEST

START_TEST(without_weight_and_motion_rounding_of_what_the_tolerance_strains_is_allowed) {
  Balanced balanced;
  open_balanced(&balanced, (const char *const[]){"effects.gravity=[0,0,0]", "time.tolerance=1e-4", NULL});
  double edge = balanced.run.model.edge;
  balanced.residual[5] = 1e-6 * 1e-4 * 1e6 * edge * edge;
  ck_assert_near(excess(&balanced), 1, 1e-9);
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

int main(void) {
  TCase *cases = tcase_create("balance");
  tcase_add_test(cases, forces_at_rest_balance_to_a_share_of_the_weight);
  tcase_add_test(cases, what_accelerates_balances_to_a_share_of_what_that_takes);
  tcase_add_test(cases, without_weight_and_motion_rounding_of_what_the_tolerance_strains_is_allowed);
  tcase_add_test(cases, a_residual_that_is_no_number_does_not_balance);
  return suite_run("balance", cases, 20);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// GMRES, and that it says how far it came.
#include "fem/sparse/krylov.h"

#include <string.h>

#include "suite.h"

enum { COUNT = 3 };

// Diagonals; of the matrix an entry above it, too.
typedef struct System {
  double matrix[COUNT], upper, preconditioner[COUNT];
} System;

static Status multiply(void *self, const double *x, double *y) {
  const System *system = self;
  for (int i = 0; i < COUNT; i++) y[i] = system->matrix[i] * x[i];
  y[0] += system->upper * x[2];
  return STATUS_OK;
}

static Status precondition(void *self, const double *x, double *y) {
  const System *system = self;
  for (int i = 0; i < COUNT; i++) y[i] = system->preconditioner[i] * x[i];
  return STATUS_OK;
}

static Status solve(System system, const double b[COUNT], double x[COUNT], double *residual) {
  FemKrylov krylov = {.self = &system, .multiply = multiply, .precondition = precondition};
  ck_assert_ok(fem_krylov_create(&krylov, COUNT));
  Status status = fem_krylov_solve(&krylov, b, 1e-12, x, residual);
  fem_krylov_destroy(&krylov);
  return status;
}

static const double b[COUNT] = {1, 4, 2};

// Backward substitution: x₂ = 2/4, x₁ = 4/3, x₀ = (1 − 5 x₂)/2. The second preconditioner makes the condition
// 1e6.
START_TEST(a_system_is_solved_also_with_a_bad_preconditioner) {
  const System systems[] = {{{2, 3, 4}, 5, {0.5, 1.0 / 3, 0.25}}, {{2, 3, 4}, 5, {1e-4, 1, -30}}};
  const double tolerances[] = {1e-12, 1e-8};
  double x[COUNT], residual;
  ck_assert_ok(solve(systems[_i], b, x, &residual));
  ck_assert_near(x[0], -0.75, tolerances[_i]);
  ck_assert_near(x[1], 4.0 / 3, tolerances[_i]);
  ck_assert_near(x[2], 0.5, tolerances[_i]);
  ck_assert_double_le(residual, tolerances[_i]);
  ck_assert_ok(solve(systems[_i], b, x, NULL));
  ck_assert_near(x[0], -0.75, tolerances[_i]);
}
END_TEST

// |b|² = 21, of which A cannot reach 21, 4 or 16.
START_TEST(what_a_singular_system_leaves_is_said) {
  const struct {
    System system;
    double left;
  } cases[] = {{{{0, 0, 0}, 0, {1, 1, 1}}, 21},
               {{{2, 3, 0}, 0, {1, 1, 1}}, 4},
               {{{2, 3, 4}, 5, {0, 0, 0}}, 21},
               {{{2, 3, 4}, 0, {1, 0, 1}}, 16}};
  System system = cases[_i].system;
  double x[COUNT], product[COUNT], residual, left = 0;
  ck_assert_ok(solve(system, b, x, &residual));
  ck_assert_double_ge(residual, sqrt(cases[_i].left / 21) - 1e-12);
  ck_assert_ok(multiply(&system, x, product));
  for (int i = 0; i < COUNT; i++) left += (b[i] - product[i]) * (b[i] - product[i]);
  ck_assert_near(residual, sqrt(left / 21), 1e-12 * residual);
}
END_TEST

START_TEST(nothing_is_solved_by_nothing) {
  const System system = {{0, 0, 0}, 0, {1, 1, 1}};
  double x[COUNT] = {1, 1, 1}, residual = 1;
  ck_assert_ok(solve(system, (const double[COUNT]){0}, x, &residual));
  for (int i = 0; i < COUNT; i++) ck_assert(x[i] == 0);
  ck_assert(residual == 0);
}
END_TEST

START_TEST(what_is_no_number_is_refused) {
  const System good = {{2, 2, 2}, 0, {1, 1, 1}}, bad = {{2, NAN, 2}, 0, {1, 1, 1}};
  const double wrong[COUNT] = {1, NAN, 2};
  double x[COUNT], residual;
  ck_assert_int_eq(solve(good, wrong, x, &residual), STATUS_SOLVER);
  ck_assert_ptr_nonnull(strstr(status_message(), "not a number"));
  ck_assert_int_eq(solve(good, wrong, x, NULL), STATUS_SOLVER);
  ck_assert_int_eq(solve(bad, b, x, &residual), STATUS_SOLVER);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("krylov");
  tcase_add_loop_test(test_case, a_system_is_solved_also_with_a_bad_preconditioner, 0, 2);
  tcase_add_loop_test(test_case, what_a_singular_system_leaves_is_said, 0, 4);
  tcase_add_test(test_case, nothing_is_solved_by_nothing);
  tcase_add_test(test_case, what_is_no_number_is_refused);
  return suite_run("krylov", test_case, 10);
}

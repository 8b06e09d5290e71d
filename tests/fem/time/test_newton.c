// SPDX-License-Identifier: GPL-3.0-or-later
// What a linear solution of Newton's method may leave: a residual that just stands, and one that just does
// not.
#include "toy.h"

#include "fem/model/limits.h"
#include "fem/time/newton/direct.h"
#include "fem/time/ida/solver.h"
#include "fem/time/newton/newton.h"
#include "fem/time/nvector.h"
#include "fem/time/sundials.h"

// The linear solver that IDA would be given.
static SUNLinearSolver given;

Status __real_fem_direct_create(FemDirect *direct, SUNContext context, void *content, FemDirectSetUp *set_up,
                                FemDirectSolve *solve);
Status __wrap_fem_direct_create(FemDirect *direct, SUNContext context, void *content, FemDirectSetUp *set_up,
                                FemDirectSolve *solve);
Status __wrap_fem_direct_create(FemDirect *direct, SUNContext context, void *content, FemDirectSetUp *set_up,
                                FemDirectSolve *solve) {
  Status status = __real_fem_direct_create(direct, context, content, set_up, solve);
  given = direct->linear;
  return status;
}

// Three masses of 1 kg between fixed ends, on springs of 1 N/m: S(c) = K + c² in modes p = 1 and 3.
static double mode_of(int p, int vertex) {
  return sin(p * M_PI * (vertex + 1) / 4);
}
static double entry_of(int p, double c) {
  return 2 * (1 - cos(p * M_PI / 4)) + c * c;
}

// What of a right-hand side of both modes one iteration of conjugate gradients leaves at c, with the factor
// of c = 1 as the preconditioner.
static double left_by_one(double c) {
  double up = 0, down = 0, left = 0;
  for (int p = 1; p <= 3; p += 2) {
    double z = 1 / entry_of(p, 1);
    up += z, down += z * entry_of(p, c) * z;
  }
  for (int p = 1; p <= 3; p += 2) left += pow(1 - up / down * entry_of(p, c) / entry_of(p, 1), 2);
  return sqrt(left / 2);
}

// The c > 1 at which that is `share`.
static double c_that_leaves(double share) {
  double low = 1, high = 1.5;
  ck_assert_double_gt(left_by_one(high), share);
  for (int k = 0; k < 60; k++) {
    double middle = 0.5 * (low + high);
    *(left_by_one(middle) > share ? &high : &low) = middle;
  }
  return low;
}

// How often the factor of c = 1 is applied to solve at another c, to what `goal` allows.
static int applications(double c, double goal) {
  Toy toy = {.count = 3, .mass = 1, .link_stiffness = 1};
  FemPart part;
  FemIdaSolver *solver;
  FemIdaFailure failure = {0};
  SUNContext context;
  toy_open(&toy);
  ck_assert_ok(fem_part_create(&part, &toy.model, &toy.system.numbering));
  ck_assert(fem_sundials_create(&context));
  ck_assert_ok(
      fem_ida_solver_create(&solver, &toy.system, &part, &fem_solver_cholmod, 1e-12, &failure, context));
  N_Vector x = fem_nvector_create(6, context), b = fem_nvector_create(6, context);
  for (int i = 0; i < 3; i++) N_VGetArrayPointer(b)[3 + i] = mode_of(1, i) + mode_of(3, i);
  ck_assert_ok(fem_ida_solver_assemble(solver, &toy.state, 1));
  ck_assert_int_eq(given->ops->setup(given, NULL), 0);
  fem_ida_solver_aim(solver, c, goal);
  ck_assert_int_eq(given->ops->solve(given, NULL, x, b, 0), 0);
  int count = (int)fem_ida_solver_stats(solver)->solves;
  N_VDestroy(x), N_VDestroy(b);
  fem_ida_solver_destroy(solver);
  fem_part_destroy(&part);
  SUNContext_Free(&context);
  toy_close(&toy);
  return count;
}

START_TEST(a_linear_solution_may_leave_a_fiftieth_or_what_is_asked_if_that_is_less) {
  static const double goals[] = {0, 0.5, 2e-3}, edges[] = {0.02, 0.02, 2e-3}; // 0: nothing is asked
  for (int k = 0; k < 3; k++) {
    ck_assert_int_eq(applications(c_that_leaves(0.999 * edges[k]), goals[k]), 1);
    ck_assert_int_eq(applications(c_that_leaves(1.001 * edges[k]), goals[k]), 2);
  }
}
END_TEST

// One equation u = 1, whose linear solver leaves LEFT of the way; velocities stay.
typedef struct Equation {
  double allowed; // of the balance
  double aims[FEM_NEWTON_ITERATIONS];
  int count; // of aims
} Equation;
static const double LEFT = 1e-3, TOLERANCE = 1e-4;

static const double *no_right(void *self) {
  (void)self;
  return NULL;
}
static double unbalance(void *self, const double *balance) {
  return fabs(balance[0]) / ((Equation *)self)->allowed;
}
static void aim(void *self, double tolerance) {
  Equation *equation = self;
  equation->aims[equation->count++] = tolerance;
}
static int evaluate(N_Vector y, N_Vector residual, void *memory) {
  (void)memory;
  N_VGetArrayPointer(residual)[0] = 0;
  N_VGetArrayPointer(residual)[1] = N_VGetArrayPointer(y)[0] - 1;
  return 0;
}
static int set_up(sunbooleantype was_bad, sunbooleantype *is_current, void *memory) {
  (void)was_bad, (void)memory;
  *is_current = true;
  return 0;
}
static int solve(N_Vector b, void *memory) {
  (void)memory;
  double *direction = N_VGetArrayPointer(b);
  direction[0] = (1 - LEFT) * direction[1], direction[1] = 0;
  return 0;
}
static int test(SUNNonlinearSolver solver, N_Vector y, N_Vector direction, sunrealtype tolerance,
                N_Vector weights, void *self) {
  (void)solver, (void)y, (void)self;
  return N_VWrmsNorm(direction, weights) <= tolerance ? SUN_SUCCESS : SUN_NLS_CONTINUE;
}

static Equation solved(double allowed) {
  Equation equation = {.allowed = allowed};
  FemNewtonUser user = {.self = &equation, .n = 1, .right = no_right, .unbalance = unbalance, .aim = aim};
  FemNewton newton;
  SUNContext context;
  ck_assert(fem_sundials_create(&context));
  N_Vector start = fem_nvector_create(2, context), correction = N_VClone(start), weights = N_VClone(start);
  N_VConst(0, correction), N_VConst(sqrt(2), weights); // the size of a direction is its |u|
  ck_assert_ok(fem_newton_create(&newton, &user, start, context));
  newton.evaluate = evaluate, newton.set_up = set_up, newton.solve = solve, newton.test = test;
  ck_assert_int_eq(
      newton.solver->ops->solve(newton.solver, start, correction, weights, TOLERANCE, true, NULL),
      SUN_SUCCESS);
  fem_newton_destroy(&newton);
  N_VDestroy(start), N_VDestroy(correction), N_VDestroy(weights);
  SUNContext_Free(&context);
  return equation;
}

// After a first correction of 1 − LEFT the balance is LEFT. A fiftieth of what Newton's test lets pass is
// asked of the second solution, by the test that is the stricter one; nothing is known before the first.
START_TEST(of_a_linear_solution_a_fiftieth_of_what_the_test_lets_pass_is_asked) {
  Equation equation = solved(1e-2 * LEFT);
  ck_assert_int_ge(equation.count, 2);
  ck_assert_double_eq(equation.aims[0], 0);
  ck_assert_near(equation.aims[1], 0.02 * TOLERANCE / (1 - LEFT), 1e-12);
  equation = solved(1e-6 * LEFT);
  ck_assert_near(equation.aims[1], 0.02 * 1e-6, 1e-14);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("newton");
  tcase_add_test(cases, a_linear_solution_may_leave_a_fiftieth_or_what_is_asked_if_that_is_less);
  tcase_add_test(cases, of_a_linear_solution_a_fiftieth_of_what_the_test_lets_pass_is_asked);
  return suite_run("newton", cases, 20);
}

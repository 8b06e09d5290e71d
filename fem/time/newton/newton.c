// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/newton/newton.h"

#include <math.h>

#include "fem/model/limits.h"
#include "fem/sparse/solver.h"
#include "fem/sparse/vector.h"
#include "fem/time/part.h"
#include "fem/time/sundials.h"

// A matrix of an earlier iteration is renewed once the iterations that are left, at the rate of the last one,
// are more: a new one costs about as much.
static const double WORTH_A_MATRIX = 2;

static FemNewton *newton_of(SUNNonlinearSolver solver) {
  return solver->content;
}

static SUNNonlinearSolver_Type type_of(SUNNonlinearSolver solver) {
  (void)solver;
  return SUNNONLINEARSOLVER_ROOTFIND;
}
static int initialize(SUNNonlinearSolver solver) {
  (void)solver;
  return SUN_SUCCESS;
}
static int set_system(SUNNonlinearSolver solver, SUNNonlinSolSysFn evaluate) {
  newton_of(solver)->evaluate = evaluate;
  return SUN_SUCCESS;
}
static int set_set_up(SUNNonlinearSolver solver, SUNNonlinSolLSetupFn set_up) {
  newton_of(solver)->set_up = set_up;
  return SUN_SUCCESS;
}
static int set_solve(SUNNonlinearSolver solver, SUNNonlinSolLSolveFn solve) {
  newton_of(solver)->solve = solve;
  return SUN_SUCCESS;
}
static int set_test(SUNNonlinearSolver solver, SUNNonlinSolConvTestFn test, void *data) {
  newton_of(solver)->test = test;
  newton_of(solver)->test_data = data;
  return SUN_SUCCESS;
}
static int set_most(SUNNonlinearSolver solver, int most) {
  (void)solver, (void)most; // FEM_NEWTON_ITERATIONS counts instead
  return SUN_SUCCESS;
}
static int get_iterations(SUNNonlinearSolver solver, long int *count) {
  *count = newton_of(solver)->iterations;
  return SUN_SUCCESS;
}
static int get_current(SUNNonlinearSolver solver, int *current) {
  *current = newton_of(solver)->current;
  return SUN_SUCCESS;
}
static int get_failures(SUNNonlinearSolver solver, long int *count) {
  *count = newton_of(solver)->failures;
  return SUN_SUCCESS;
}

// A solve while it goes on.
typedef struct Solve {
  FemNewton *newton;
  N_Vector correction, weights;
  double tolerance;
  void *memory;        // IDA's
  bool wants_matrix;   // before the next iteration
  bool was_bad;        // because the last one was bad
  bool is_newest;      // it was made for this iteration
  bool is_good_enough; // IDA's test has passed once
  double excess;       // of the balance, after the last whole step
  double size;         // of the last whole step, by the weights; 0: there was none
  int renewals;
  double slope;  // g(0) of the step being taken; 0: not known
  double settle; // δu · (what the kinematics' residual adds to the condensed one)
} Solve;

static int evaluate(Solve *solve) {
  return solve->newton->evaluate(solve->correction, solve->newton->residual, solve->memory);
}

static int make_matrix(Solve *solve) {
  int is_current = 0;
  int flag = solve->newton->set_up(solve->was_bad, &is_current, solve->memory);
  solve->wants_matrix = solve->was_bad = false;
  fem_mixing_forget(&solve->newton->mixing);
  solve->size = 0;
  solve->newton->current = 0;
  return flag;
}

// Asks for a matrix of where the iteration stands; false: there were enough.
static bool renew(Solve *solve) {
  if (solve->renewals >= FEM_NEWTON_RENEWALS) return false;
  solve->renewals++;
  solve->wants_matrix = solve->was_bad = true;
  return true;
}

// δu · r of the balance at the correction.
static double slope_of_balance(const FemNewton *newton) {
  int n = newton->user.n;
  return fem_part_sum(
      fem_vector_dot(n, N_VGetArrayPointer(newton->direction), N_VGetArrayPointer(newton->residual) + n));
}

// g(0) along the direction. The condensed right-hand side is minus the condensed residual.
static void find_slope(Solve *solve) {
  const FemNewton *newton = solve->newton;
  const double *right = newton->user.right(newton->user.self);
  double balance = slope_of_balance(newton);
  solve->slope = balance;
  if (right)
    solve->slope =
        -fem_part_sum(fem_vector_dot(newton->user.n, N_VGetArrayPointer(newton->direction), right));
  solve->settle = solve->slope - balance;
}

static double unbalance(const FemNewton *newton) {
  const double *balance = N_VGetArrayPointer(newton->residual) + newton->user.n;
  return newton->user.unbalance(newton->user.self, balance);
}

// An iterative linear solver may leave what Newton's test would let pass: a share of what is still allowed of
// the balance, and of the correction, whose size is that of the last one at most, or of the last step's first
// one.
static void set_accuracy(Solve *solve) {
  FemNewton *newton = solve->newton;
  double size = solve->size > 0 ? solve->size : newton->first_size;
  double excess = isinf(solve->excess) ? unbalance(newton) : solve->excess;
  double tolerance = FEM_SOLVED * fmin(1 / excess, solve->tolerance / size);
  newton->user.aim(newton->user.self, size > 0 && excess > 0 ? tolerance : 0);
}

// The direction from the residual; once a matrix had to be made anew, mixed with those that it gave before
// unless that leads uphill.
static int find_direction(Solve *solve) {
  FemNewton *newton = solve->newton;
  set_accuracy(solve);
  N_VScale(-1, newton->residual, newton->direction);
  int flag = newton->solve(newton->direction, solve->memory);
  if (flag != 0) return flag;
  if (solve->renewals == 0) {
    fem_mixing_note(&newton->mixing, N_VGetArrayPointer(newton->direction));
    find_slope(solve);
    return 0;
  }
  N_VScale(1, newton->direction, newton->pure);
  fem_mixing_mix(&newton->mixing, N_VGetArrayPointer(solve->weights), N_VGetArrayPointer(newton->direction));
  find_slope(solve);
  if (solve->slope < 0) return 0;
  N_VScale(1, newton->pure, newton->direction);
  find_slope(solve);
  return 0;
}

// Whether the slope at the end of a step has turned and grown. A step shorter than the error that a step may
// have is never cut.
static bool overshoots(const Solve *solve, double share, double end) {
  double size = share * N_VWrmsNorm(solve->newton->direction, solve->weights);
  return size > 1 && solve->slope < 0 && end > -solve->slope;
}

// Takes the step, shortened as far as it must be; *share: what of it. The residual is that of its end.
static int step_along_direction(Solve *solve, double *share) {
  FemNewton *newton = solve->newton;
  N_VScale(1, solve->correction, newton->start);
  *share = 1;
  for (int cut = 0;; cut++) {
    N_VLinearSum(1, newton->start, *share, newton->direction, solve->correction);
    int flag = evaluate(solve);
    if (flag < 0 || (flag > 0 && cut >= FEM_NEWTON_ITERATIONS)) return flag;
    if (flag > 0) {
      *share *= FEM_CUT;
      continue;
    }
    double end = slope_of_balance(newton) + (1 - *share) * solve->settle;
    if (cut >= FEM_NEWTON_ITERATIONS || !overshoots(solve, *share, end)) return 0;
    *share *= fmax(solve->slope / (solve->slope - end), 0.5 * FEM_CUT);
  }
}

// Whether at the rate of the last iteration, with a matrix that is not of here, more are left than that is
// worth.
static bool is_slow(const Solve *solve, double size, double before, double excess) {
  if (!(size > 0 && before > 0)) return false;
  double rate = size / before, beyond = fmax(size / solve->tolerance, excess);
  return rate >= 1 || log(beyond) / -log(rate) > WORTH_A_MATRIX;
}

// Decides after a whole step by IDA's test and the balance. Where the forces jump they cannot be balanced:
// once IDA's test has passed, iterations go on only while each halves the excess, or while a new matrix may
// help (one from before a body turned does not balance it).
static int check_convergence(Solve *solve, bool *has_converged) {
  FemNewton *newton = solve->newton;
  double before = solve->size, excess_before = solve->excess;
  solve->excess = unbalance(newton);
  solve->size = N_VWrmsNorm(newton->direction, solve->weights);
  if (newton->iterations == 1) newton->first_size = solve->size;
  int verdict = newton->test(newton->solver, solve->correction, newton->direction, solve->tolerance,
                             solve->weights, newton->test_data);
  newton->current++;
  if (verdict < 0) return verdict;
  bool passes = verdict == SUN_SUCCESS, is_stuck = !(solve->excess <= 0.5 * excess_before);
  *has_converged = passes && solve->excess <= 1;
  bool is_left = !*has_converged && solve->is_good_enough && (is_stuck || !passes);
  if (is_left && !solve->is_newest && renew(solve)) return 0;
  *has_converged = *has_converged || is_left;
  if (*has_converged) return 0;
  solve->is_good_enough = solve->is_good_enough || passes;
  if (!passes && verdict != SUN_NLS_CONTINUE) return renew(solve) ? 0 : SUN_NLS_CONV_RECVR;
  if (!solve->is_newest && is_slow(solve, solve->size, before, solve->excess)) renew(solve);
  return 0;
}

// One iteration; *has_converged. > 0: no way from here, as IDA or the caller says it.
static int iterate(Solve *solve, bool *has_converged) {
  FemNewton *newton = solve->newton;
  double share;
  solve->is_newest = solve->wants_matrix;
  if (solve->wants_matrix) {
    int flag = make_matrix(solve);
    if (flag != 0) return flag;
  }
  int flag = find_direction(solve);
  if (flag > 0 && !solve->is_newest && renew(solve)) return 0;
  if (flag != 0) return flag;
  newton->iterations++;
  flag = step_along_direction(solve, &share);
  if (flag != 0) return flag;
  fem_mixing_take(&newton->mixing, share, N_VGetArrayPointer(newton->direction));
  if (share == 1) return check_convergence(solve, has_converged);
  solve->size = 0;
  return renew(solve) ? 0 : SUN_NLS_CONV_RECVR;
}

static int run(Solve *solve) {
  bool has_converged = false;
  int flag = evaluate(solve);
  while (flag == 0 && !has_converged && solve->newton->iterations < FEM_NEWTON_ITERATIONS)
    flag = iterate(solve, &has_converged);
  if (flag != 0) return flag;
  return has_converged || solve->is_good_enough ? SUN_SUCCESS : SUN_NLS_CONV_RECVR;
}

static int solve_step(SUNNonlinearSolver solver, N_Vector predicted, N_Vector correction, N_Vector weights,
                      sunrealtype tolerance, sunbooleantype wants_matrix, void *memory) {
  (void)predicted;
  FemNewton *newton = newton_of(solver);
  Solve solve = {.newton = newton,
                 .correction = correction,
                 .weights = weights,
                 .tolerance = tolerance,
                 .memory = memory,
                 .wants_matrix = wants_matrix,
                 .excess = INFINITY};
  newton->iterations = newton->failures = newton->current = 0;
  fem_mixing_forget(&newton->mixing);
  int flag = run(&solve);
  newton->failures = flag != SUN_SUCCESS;
  return flag;
}

Status fem_newton_create(FemNewton *newton, const FemNewtonUser *user, N_Vector like, SUNContext context) {
  *newton = (FemNewton){.user = *user, .solver = SUNNonlinSolNewEmpty(context)};
  N_Vector *vectors[] = {&newton->residual, &newton->direction, &newton->start, &newton->pure};
  for (int i = 0; i < 4; i++)
    if (!(*vectors[i] = N_VClone(like))) return status_no_memory("Newton's method");
  TRY(fem_mixing_create(&newton->mixing, 2 * user->n));
  if (!newton->solver) return status_no_memory("Newton's method");
  newton->solver->content = newton;
  newton->solver->ops->gettype = type_of;
  newton->solver->ops->initialize = initialize;
  newton->solver->ops->solve = solve_step;
  newton->solver->ops->setsysfn = set_system;
  newton->solver->ops->setlsetupfn = set_set_up;
  newton->solver->ops->setlsolvefn = set_solve;
  newton->solver->ops->setctestfn = set_test;
  newton->solver->ops->setmaxiters = set_most;
  newton->solver->ops->getnumiters = get_iterations;
  newton->solver->ops->getcuriter = get_current;
  newton->solver->ops->getnumconvfails = get_failures;
  return STATUS_OK;
}

void fem_newton_destroy(FemNewton *newton) {
  N_Vector vectors[] = {newton->residual, newton->direction, newton->start, newton->pure};
  for (int i = 0; i < 4; i++)
    if (vectors[i]) N_VDestroy(vectors[i]);
  fem_mixing_destroy(&newton->mixing);
  if (newton->solver) SUNNonlinSolFreeEmpty(newton->solver);
  *newton = (FemNewton){0};
}

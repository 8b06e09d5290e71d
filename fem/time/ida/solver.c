// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/ida/solver.h"

#include <ida/ida.h>
#include <math.h>
#include <string.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/model/limits.h"
#include "fem/sparse/cg.h"
#include "fem/sparse/vector.h"
#include "fem/time/newton/direct.h"

// IDA asks for a matrix where c is beyond (1 + x)/(1 − x) of the matrix's, either way: three times. Its own
// is 0.25.
static const double FOLLOWED_CHANGE = 0.5;

struct FemIdaSolver {
  FemSystem *system;   // borrowed
  const FemPart *part; // borrowed
  const FemSolverOps *ops;
  void *solver;           // of ops
  FemIdaFailure *failure; // borrowed
  double rounding;        // of the kinematics' residual r₁ [m/s]: below, it is zero
  FemDirect direct;
  double *masses; // of the unknowns [kg]                      (part->count)
  double *right;  // right-hand side of the condensed system   (part->count)
  double *all;    // of all unknowns: scratch; one process: none (n)
  // Of a linear system: K once, and the c that was factorised; assembling adds c D + c² M.
  bool is_linear, is_factorised;
  FemMatrix stiffness;
  double factorised_c;
  bool has_damping;
  FemMatrix damping; // D, in the layout of the system's matrix; zeroed without damping
  long long layout;  // that was analysed; 0: none
  double c;          // of the assembled matrix [1/s]
  // Where the factor is exact and assembling costs, the solutions follow c without a new factor.
  bool follows;
  double factor_c, matrix_c; // of the factor, of the system's matrix as it stands [1/s]
  double goal;               // of the next solution; 0: FEM_SOLVED
  int followed;              // iterations since the last factor
  FemCg cg;
  double *piece; // scratch, over ranks                        (part->count)
  double product_s;
};

static Status factorise(FemIdaSolver *solver) {
  const FemMatrix *matrix = &solver->system->matrix;
  if (solver->layout != matrix->layout) {
    TRY(solver->ops->analyse(solver->solver, matrix));
    solver->layout = matrix->layout;
    solver->is_factorised = false;
  }
  if (solver->ops->is_condensed) {
    if (solver->is_linear && solver->is_factorised && solver->factorised_c == solver->c) return STATUS_OK;
    solver->is_factorised = false;
    TRY(solver->ops->factorise(solver->solver, matrix, NULL, NULL, solver->c));
    solver->is_factorised = true;
    solver->factorised_c = solver->factor_c = solver->c;
    solver->followed = 0;
    return STATUS_OK;
  }
  return solver->ops->factorise(solver->solver, matrix, solver->has_damping ? &solver->damping : NULL,
                                solver->masses, solver->c);
}

// right = D r₁
static void multiply_damping(FemIdaSolver *solver, const double *b) {
  const FemPart *part = solver->part;
  const double *r = fem_part_join(part, b);
  double *product = part->order ? solver->all : solver->right;
  fem_matrix_multiply(&solver->damping, r, product);
  if (!part->order) return;
  ranks()->sum(product, (size_t)part->n);
  fem_part_take(part, product, solver->right);
}

// S x = right. Over ranks a solver asks for each one's own part of the right side.
static Status solve_condensed(FemIdaSolver *solver, double *x) {
  const FemPart *part = solver->part;
  if (!part->order) return solver->ops->solve(solver->solver, solver->right, x);
  fem_part_give(part, solver->right, solver->all);
  TRY(solver->ops->solve(solver->solver, solver->all, part->whole));
  fem_part_take(part, part->whole, x);
  return STATUS_OK;
}

// r₂ + (c M + D) r₁ for b = (r₁; r₂). u̇ = v is linear: once a whole step has been taken r₁ is rounding.
static void condense(FemIdaSolver *solver, const double *b) {
  int n = solver->part->count;
  double *right = solver->right;
  if (fem_part_most(fem_vector_largest(n, b)) <= solver->rounding) {
    fem_vector_copy(n, b + n, right);
    return;
  }
  if (solver->has_damping)
    multiply_damping(solver, b);
  else
    fem_vector_fill(n, 0, right);
#pragma omp parallel for schedule(static) if (n > FEM_VECTOR_LONG)
  for (int i = 0; i < n; i++) right[i] += b[n + i] + solver->c * solver->masses[i] * b[i];
}

// The values of all unknowns from each rank's own.
static void join(const FemPart *part, const double *own, double *all) {
  memset(all, 0, (size_t)part->n * sizeof *all);
  fem_part_give(part, own, all);
  ranks()->sum(all, (size_t)part->n);
}

// S(c) = S(c₀) + (c − c₀) D + (c² − c₀²) M in the system's matrix.
static void shift(FemIdaSolver *solver) {
  FemMatrix *matrix = &solver->system->matrix;
  double c = solver->c, before = solver->matrix_c;
  if (c == before) return;
  if (solver->has_damping)
    fem_vector_sum(matrix->entry_count, 1, matrix->value, c - before, solver->damping.value, matrix->value);
  fem_matrix_add_mass(matrix, solver->system->model->mass, (c - before) * (c + before));
  solver->matrix_c = c;
}

// All of z = S(c₀)⁻¹ r by all of r.
static Status solve_by_factor(void *self, const double *r, double *z) {
  FemIdaSolver *solver = self;
  const FemPart *part = solver->part;
  TRY(solver->ops->solve(solver->solver, r, z));
  if (!part->order) return STATUS_OK;
  fem_part_take(part, z, solver->piece);
  join(part, solver->piece, z);
  return STATUS_OK;
}

// The factor at c, of K and D as they are.
static Status catch_up(FemIdaSolver *solver) {
  Status status = factorise(solver);
  if (status) solver->factor_c = NAN;
  return status;
}

// S(c) x = right. With the factor of S(c₀) as the preconditioner all eigenvalues lie between 1 and (c/c₀)².
static Status solve_following(FemIdaSolver *solver, double *x) {
  double goal = solver->goal > 0 ? solver->goal : FEM_SOLVED;
  long long iterations = 0;
  FemCgEnd end;
  FemCgProblem problem = {.matrix = &solver->system->matrix,
                          .precondition = solve_by_factor,
                          .self = solver,
                          .name = solver->ops->name,
                          .tolerance = fmax(fmin(goal, FEM_SOLVED), FEM_ROUNDING),
                          .by_residual = true,
                          .limit = FEM_NEWTON_ITERATIONS};
  const FemPart *part = solver->part;
  double *right = solver->right, *left = x;
  shift(solver);
  if (solver->followed >= 2 * FEM_NEWTON_ITERATIONS) {
    TRY(catch_up(solver));
    if (!solver->ops->be_rough) return solve_condensed(solver, x);
  }
  if (part->order) {
    right = solver->all, left = part->whole;
    join(part, solver->right, right);
  }
  Status status = fem_cg_solve(&solver->cg, &problem, right, left, &iterations, &end);
  solver->followed += (int)iterations;
  if (part->order) fem_part_take(part, left, x);
  return status;
}

static Status solve(FemIdaSolver *solver, const double *b, double *x) {
  if (!solver->ops->is_condensed) return solver->ops->solve(solver->solver, b, x);
  int n = solver->part->count;
  condense(solver, b);
  if (solver->follows && (solver->c != solver->factor_c || solver->ops->be_rough))
    TRY(solve_following(solver, x));
  else
    TRY(solve_condensed(solver, x));
  fem_vector_sum(n, solver->c, x, -1, b, x + n);
  return STATUS_OK;
}

static int set_up_callback(SUNLinearSolver linear, SUNMatrix matrix) {
  (void)matrix;
  FemIdaSolver *solver = linear->content;
  return fem_direct_flag(fem_ida_failure_answer(solver->failure, factorise(solver)));
}

static double solver_s(const FemIdaSolver *solver) {
  const FemSolverStats *stats = solver->ops->stats(solver->solver);
  return stats->analyse_s + stats->factorise_s + stats->solve_s;
}

static int solve_callback(SUNLinearSolver linear, SUNMatrix matrix, N_Vector x, N_Vector b,
                          sunrealtype tolerance) {
  (void)matrix, (void)tolerance;
  FemIdaSolver *solver = linear->content;
  double began = clock_wall_s() - solver_s(solver);
  Status status = solve(solver, N_VGetArrayPointer(b), N_VGetArrayPointer(x));
  solver->product_s += clock_wall_s() - solver_s(solver) - began;
  return fem_direct_flag(fem_ida_failure_answer(solver->failure, status));
}

static Status create(FemIdaSolver *solver, SUNContext context) {
  const FemModel *model = solver->system->model;
  TRY(solver->ops->create(&solver->solver, model->scene->threads,
                          fem_solver_tolerance(solver->ops, model->scene->solver_tolerance)));
  const FemPart *part = solver->part;
  size_t n = (size_t)part->count;
  solver->all = memory_zeroed(part->order ? (size_t)part->n : 0, sizeof *solver->all);
  solver->masses = memory_zeroed(n, sizeof *solver->masses);
  solver->right = memory_zeroed(n, sizeof *solver->right);
  if (!solver->masses || !solver->right || !solver->all) return status_no_memory("the linear solver");
  for (int i = 0; i < part->count; i++) solver->masses[i] = model->mass[fem_part_dof(part, i) / 3];
  if (solver->follows) {
    if (solver->ops->be_rough) solver->ops->be_rough(solver->solver);
    TRY(fem_cg_create(&solver->cg, part->n));
    solver->piece = memory_zeroed(part->order ? n : 0, sizeof *solver->piece);
    if (!solver->piece) return status_no_memory("the linear solver");
  }
  return fem_direct_create(&solver->direct, context, solver, set_up_callback, solve_callback);
}

Status fem_ida_solver_create(FemIdaSolver **solver, FemSystem *system, const FemPart *part,
                             const FemSolverOps *ops, double rounding, FemIdaFailure *failure,
                             SUNContext context) {
  *solver = memory_zeroed(1, sizeof **solver);
  if (!*solver) return status_no_memory("the linear solver");
  bool is_linear = ops->is_condensed && fem_system_is_linear(system), is_exact = !(ops->tolerance > 0);
  **solver = (FemIdaSolver){.system = system,
                            .part = part,
                            .ops = ops,
                            .failure = failure,
                            .rounding = rounding,
                            .has_damping = fem_system_dissipates(system),
                            .is_linear = is_linear,
                            .follows = ops->is_condensed && is_exact && !is_linear};
  Status status = create(*solver, context);
  if (status == STATUS_OK) return STATUS_OK;
  fem_ida_solver_destroy(*solver);
  *solver = NULL;
  return status;
}

void fem_ida_solver_destroy(FemIdaSolver *solver) {
  if (!solver) return;
  if (solver->solver) solver->ops->destroy(solver->solver);
  fem_direct_destroy(&solver->direct);
  fem_cg_destroy(&solver->cg);
  memory_free(solver->piece);
  fem_matrix_destroy(&solver->damping);
  fem_matrix_destroy(&solver->stiffness);
  memory_free(solver->masses);
  memory_free(solver->right);
  memory_free(solver->all);
  memory_free(solver);
}

// Solutions that do not follow c are scaled by IDA.
bool fem_ida_solver_attach(FemIdaSolver *solver, void *ida) {
  return IDASetLinearSolver(ida, solver->direct.linear, solver->direct.matrix) == IDA_SUCCESS &&
         IDASetLinearSolutionScaling(ida, !solver->follows) == IDA_SUCCESS &&
         (!solver->follows || IDASetDeltaCjLSetup(ida, FOLLOWED_CHANGE) == IDA_SUCCESS);
}

static Status assemble_damping(FemIdaSolver *solver, const FemState *state) {
  const FemMatrix *matrix = &solver->system->matrix;
  if (solver->damping.layout != matrix->layout) {
    fem_matrix_destroy(&solver->damping);
    TRY(fem_matrix_copy_layout(&solver->damping, matrix));
  }
  return fem_system_assemble(solver->system, state, 0, 1, 0, &solver->damping);
}

// S = K + c D + c² M from K and D, which are assembled once.
static Status combine(FemIdaSolver *solver, const FemState *state) {
  FemSystem *system = solver->system;
  FemMatrix *matrix = &system->matrix;
  if (solver->stiffness.layout != matrix->layout) {
    fem_matrix_destroy(&solver->stiffness);
    TRY(fem_matrix_copy_layout(&solver->stiffness, matrix));
    TRY(fem_system_assemble(system, state, 1, 0, 0, &solver->stiffness));
    if (solver->has_damping) TRY(assemble_damping(solver, state));
  }
  if (solver->has_damping)
    fem_vector_sum(matrix->entry_count, 1, solver->stiffness.value, solver->c, solver->damping.value,
                   matrix->value);
  else
    fem_vector_copy(matrix->entry_count, solver->stiffness.value, matrix->value);
  fem_matrix_add_mass(matrix, system->model->mass, solver->c * solver->c);
  return STATUS_OK;
}

Status fem_ida_solver_assemble(FemIdaSolver *solver, const FemState *state, double c) {
  FemSystem *system = solver->system;
  TRY(fem_system_couple(system, state));
  solver->c = solver->matrix_c = c;
  if (solver->is_linear) return combine(solver, state);
  if (solver->has_damping) TRY(assemble_damping(solver, state));
  bool is_condensed = solver->ops->is_condensed;
  TRY(fem_system_assemble(system, state, 1, 0, is_condensed ? c * c : 0, &system->matrix));
  // D is there already: its elements are not visited again for S.
  if (is_condensed && solver->has_damping)
    fem_vector_sum(system->matrix.entry_count, 1, system->matrix.value, c, solver->damping.value,
                   system->matrix.value);
  return STATUS_OK;
}

const double *fem_ida_solver_right(const FemIdaSolver *solver) {
  return solver->ops->is_condensed ? solver->right : NULL;
}

void fem_ida_solver_aim(FemIdaSolver *solver, double c, double tolerance) {
  if (solver->follows) solver->c = c;
  solver->goal = tolerance;
  bool is_said = solver->system->model->scene->solver_tolerance > 0;
  if (solver->ops->aim && !is_said) solver->ops->aim(solver->solver, tolerance);
}

const double *fem_ida_solver_masses(const FemIdaSolver *solver) {
  return solver->masses;
}

const FemSolverStats *fem_ida_solver_stats(const FemIdaSolver *solver) {
  return solver->ops->stats(solver->solver);
}

double fem_ida_solver_product_s(const FemIdaSolver *solver) {
  return solver->product_s;
}

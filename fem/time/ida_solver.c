// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/ida_solver.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/ranks.h"
#include "fem/time/direct.h"

struct FemIdaSolver {
  FemSystem *system; // borrowed
  const FemSolverOps *ops;
  void *solver;           // of ops
  FemIdaFailure *failure; // borrowed
  double rounding;        // of the kinematics' residual r₁ [m/s]: below, it is zero
  FemDirect direct;
  double *masses; // of the unknowns [kg]                      (unknown_count)
  double *right;  // right-hand side of the condensed system   (unknown_count)
  // Of a linear system: K once, and the c that was factorised; assembling adds c D + c² M.
  bool is_linear, is_factorised;
  FemMatrix stiffness;
  double factorised_c;
  bool has_damping;
  FemMatrix damping; // D, in the layout of the system's matrix; zeroed without damping
  long long layout;  // that was analysed; 0: none
  double c;          // of the assembled matrix [1/s]
};

int fem_ida_solver_answer(FemIdaFailure *failure, Status status) {
  if (status == STATUS_OK) return 0;
  if (status > 0) {
    snprintf(failure->retry_message, sizeof failure->retry_message, "%s", status_message());
    return 1;
  }
  failure->fatal = status;
  snprintf(failure->fatal_message, sizeof failure->fatal_message, "%s", status_message());
  return -1;
}

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
    solver->factorised_c = solver->c;
    return STATUS_OK;
  }
  return solver->ops->factorise(solver->solver, matrix, solver->has_damping ? &solver->damping : NULL,
                                solver->masses, solver->c);
}

// r₂ + (c M + D) r₁ for b = (r₁; r₂). u̇ = v is linear: once a whole step has been taken r₁ is rounding.
static void condense(FemIdaSolver *solver, const double *b) {
  int n = solver->system->model->unknown_count;
  double *right = solver->right, largest = 0;
  for (int i = 0; i < n; i++) largest = fmax(largest, fabs(b[i]));
  if (largest <= solver->rounding) {
    memcpy(right, b + n, (size_t)n * sizeof *right);
    return;
  }
  if (solver->has_damping) {
    fem_matrix_multiply(&solver->damping, b, right);
    ranks()->sum(right, (size_t)n);
  } else
    for (int i = 0; i < n; i++) right[i] = 0;
  for (int i = 0; i < n; i++) right[i] += b[n + i] + solver->c * solver->masses[i] * b[i];
}

static Status solve(FemIdaSolver *solver, const double *b, double *x) {
  if (!solver->ops->is_condensed) return solver->ops->solve(solver->solver, b, x);
  int n = solver->system->model->unknown_count;
  condense(solver, b);
  TRY(solver->ops->solve(solver->solver, solver->right, x));
  for (int i = 0; i < n; i++) x[n + i] = solver->c * x[i] - b[i];
  return STATUS_OK;
}

static int set_up_callback(SUNLinearSolver linear, SUNMatrix matrix) {
  (void)matrix;
  FemIdaSolver *solver = linear->content;
  return fem_direct_flag(fem_ida_solver_answer(solver->failure, factorise(solver)));
}

static int solve_callback(SUNLinearSolver linear, SUNMatrix matrix, N_Vector x, N_Vector b,
                          realtype tolerance) {
  (void)matrix, (void)tolerance;
  FemIdaSolver *solver = linear->content;
  Status status = solve(solver, N_VGetArrayPointer(b), N_VGetArrayPointer(x));
  return fem_direct_flag(fem_ida_solver_answer(solver->failure, status));
}

static Status create(FemIdaSolver *solver, SUNContext context) {
  const FemModel *model = solver->system->model;
  TRY(solver->ops->create(&solver->solver, model->scene->threads,
                          fem_solver_tolerance(solver->ops, model->scene->solver_tolerance)));
  size_t n = (size_t)model->unknown_count;
  solver->masses = memory_zeroed(n, sizeof *solver->masses);
  solver->right = memory_zeroed(n, sizeof *solver->right);
  if (!solver->masses || !solver->right) return status_no_memory("the linear solver");
  for (size_t i = 0; i < n; i++) solver->masses[i] = model->mass[model->dof_of_unknown[i] / 3];
  return fem_direct_create(&solver->direct, context, solver, set_up_callback, solve_callback);
}

Status fem_ida_solver_create(FemIdaSolver **solver, FemSystem *system, const FemSolverOps *ops,
                             double rounding, FemIdaFailure *failure, SUNContext context) {
  *solver = memory_zeroed(1, sizeof **solver);
  if (!*solver) return status_no_memory("the linear solver");
  **solver = (FemIdaSolver){.system = system,
                            .ops = ops,
                            .failure = failure,
                            .rounding = rounding,
                            .has_damping = fem_system_dissipates(system),
                            .is_linear = ops->is_condensed && fem_system_is_linear(system)};
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
  fem_matrix_destroy(&solver->damping);
  fem_matrix_destroy(&solver->stiffness);
  memory_free(solver->masses);
  memory_free(solver->right);
  memory_free(solver);
}

SUNLinearSolver fem_ida_solver_linear(FemIdaSolver *solver) {
  return solver->direct.linear;
}

SUNMatrix fem_ida_solver_matrix(FemIdaSolver *solver) {
  return solver->direct.matrix;
}

static Status assemble_damping(FemIdaSolver *solver, double time) {
  const FemMatrix *matrix = &solver->system->matrix;
  if (solver->damping.layout != matrix->layout) {
    fem_matrix_destroy(&solver->damping);
    TRY(fem_matrix_copy_layout(&solver->damping, matrix));
  }
  return fem_system_assemble(solver->system, time, 0, 1, 0, &solver->damping);
}

// S = K + c D + c² M from K and D, which are assembled once.
static Status combine(FemIdaSolver *solver, double time) {
  FemSystem *system = solver->system;
  FemMatrix *matrix = &system->matrix;
  if (solver->stiffness.layout != matrix->layout) {
    fem_matrix_destroy(&solver->stiffness);
    TRY(fem_matrix_copy_layout(&solver->stiffness, matrix));
    TRY(fem_system_assemble(system, time, 1, 0, 0, &solver->stiffness));
    if (solver->has_damping) TRY(assemble_damping(solver, time));
  }
  for (int i = 0; i < matrix->entry_count; i++) {
    matrix->value[i] = solver->stiffness.value[i];
    if (solver->has_damping) matrix->value[i] += solver->c * solver->damping.value[i];
  }
  fem_matrix_add_mass(matrix, system->model->mass, solver->c * solver->c);
  return STATUS_OK;
}

Status fem_ida_solver_assemble(FemIdaSolver *solver, double time, double c, const double *u,
                               const double *v) {
  FemSystem *system = solver->system;
  fem_system_scatter(system, time, u, v);
  TRY(fem_system_couple(system, time));
  solver->c = c;
  if (solver->is_linear) return combine(solver, time);
  if (solver->has_damping) TRY(assemble_damping(solver, time));
  bool is_condensed = solver->ops->is_condensed;
  TRY(fem_system_assemble(system, time, 1, 0, is_condensed ? c * c : 0, &system->matrix));
  // D is there already: its elements are not visited again for S.
  if (is_condensed && solver->has_damping)
    for (int i = 0; i < system->matrix.entry_count; i++)
      system->matrix.value[i] += c * solver->damping.value[i];
  return STATUS_OK;
}

const double *fem_ida_solver_right(const FemIdaSolver *solver) {
  return solver->ops->is_condensed ? solver->right : NULL;
}

void fem_ida_solver_aim(FemIdaSolver *solver, double tolerance) {
  bool is_said = solver->system->model->scene->solver_tolerance > 0;
  if (solver->ops->aim && !is_said) solver->ops->aim(solver->solver, tolerance);
}

const double *fem_ida_solver_masses(const FemIdaSolver *solver) {
  return solver->masses;
}

const FemSolverStats *fem_ida_solver_stats(const FemIdaSolver *solver) {
  return solver->ops->stats(solver->solver);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Condensed system by conjugate gradients, preconditioned by the inverses of the diagonal blocks of vertices
// (block Jacobi, at most 3 × 3).
#include "fem/sparse/solver.h"

#include <math.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "fem/sparse/cg.h"
#include "fem/sparse/vector.h"

enum { PARALLEL_SIZE = 4000, PCG_ITERATIONS = 2000 };

typedef struct PcgSolver {
  int threads;
  double tolerance;
  int size;
  int block_count;
  int *first;              // first unknown of each vertex that has some   (block_count + 1)
  double *inverse;         // of its diagonal block, row-major             (block_count, 9)
  FemCg cg;                // its vectors
  const FemMatrix *matrix; // borrowed, of the last factorise; NULL: none
  long long layout;
  FemSolverStats stats;
} PcgSolver;

static void forget(PcgSolver *solver) {
  memory_free(solver->first), memory_free(solver->inverse);
  fem_cg_destroy(&solver->cg);
  solver->first = NULL, solver->inverse = NULL;
  solver->matrix = NULL;
  solver->layout = 0;
}

static Status create(void **self, int threads, double tolerance) {
  *self = NULL;
  if (!(tolerance > 0 && tolerance < 1))
    return status_fail(STATUS_INPUT, "solver pcg: the tolerance must lie between 0 and 1, not %g", tolerance);
  PcgSolver *solver = memory_zeroed(1, sizeof *solver);
  *self = solver;
  if (!solver) return status_no_memory("the solver pcg");
  solver->threads = threads;
  solver->tolerance = tolerance;
  return STATUS_OK;
}

static void destroy(void *self) {
  if (!self) return;
  forget(self);
  memory_free(self);
}

static Status analyse(void *self, const FemMatrix *pattern) {
  PcgSolver *solver = self;
  double began = clock_wall_s();
  forget(solver);
  size_t size = (size_t)pattern->size;
  solver->size = pattern->size;
  solver->first = memory_zeroed(size + 1, sizeof *solver->first);
  solver->inverse = memory_zeroed(9 * size, sizeof *solver->inverse);
  if (!solver->first || !solver->inverse) return status_no_memory("the solver pcg");
  TRY(fem_cg_create(&solver->cg, pattern->size));
  int unknown = 0;
  solver->block_count = 0;
  for (int v = 0; v < pattern->vertex_count; v++) {
    int before = unknown;
    for (int c = 0; c < 3; c++) unknown += pattern->unknown_of_dof[3 * v + c] >= 0;
    if (unknown > before) solver->first[solver->block_count++] = before;
  }
  solver->first[solver->block_count] = unknown;
  solver->layout = pattern->layout;
  solver->stats.analyses++;
  solver->stats.analyse_s += clock_wall_s() - began;
  return STATUS_OK;
}

// The inverse of a symmetric positive definite matrix of size 1 … 3, given by its lower triangle: A = L Lᵀ,
// then L⁻¹, then L⁻ᵀ L⁻¹. False if it is not positive definite.
static bool invert(int size, const double A[9], double inverse[9]) {
  double L[3][3] = {{0}}, M[3][3] = {{0}}; // M = L⁻¹
  for (int j = 0; j < size; j++) {
    double pivot = A[3 * j + j];
    for (int k = 0; k < j; k++) pivot -= L[j][k] * L[j][k];
    if (!(pivot > 0) || isinf(pivot)) return false;
    L[j][j] = sqrt(pivot);
    for (int i = j + 1; i < size; i++) {
      double sum = A[3 * i + j];
      for (int k = 0; k < j; k++) sum -= L[i][k] * L[j][k];
      L[i][j] = sum / L[j][j];
    }
  }
  for (int j = 0; j < size; j++) {
    M[j][j] = 1 / L[j][j];
    for (int i = j + 1; i < size; i++) {
      double sum = 0;
      for (int k = j; k < i; k++) sum -= L[i][k] * M[k][j];
      M[i][j] = sum / L[i][i];
    }
  }
  for (int i = 0; i < size; i++)
    for (int j = 0; j < size; j++) {
      double sum = 0;
      for (int k = 0; k < size; k++) sum += M[k][i] * M[k][j];
      inverse[3 * i + j] = sum;
    }
  return true;
}

static Status invert_blocks(PcgSolver *solver, const FemMatrix *matrix) {
  for (int b = 0; b < solver->block_count; b++) {
    int first = solver->first[b], size = solver->first[b + 1] - first;
    double block[9] = {0};
    for (int c = 0; c < size; c++)
      for (int r = c; r < size; r++) block[3 * r + c] = matrix->value[matrix->col_begin[first + c] + r - c];
    if (!invert(size, block, solver->inverse + 9 * b))
      return status_fail(STATUS_RETRY, "the condensed matrix is not positive definite");
  }
  return STATUS_OK;
}

static Status factorise(void *self, const FemMatrix *stiffness, const FemMatrix *damping,
                        const double *mass_of_unknown, double c) {
  PcgSolver *solver = self;
  (void)damping, (void)mass_of_unknown, (void)c;
  solver->matrix = NULL;
  if (!solver->layout || stiffness->layout != solver->layout)
    return status_fail(STATUS_SOLVER, "pcg: this layout of the matrix has not been analysed");
  double began = clock_wall_s();
  Status status = fem_vector_is_finite(stiffness->entry_count, stiffness->value)
                      ? invert_blocks(solver, stiffness)
                      : status_fail(STATUS_RETRY, "the condensed matrix is not finite");
  if (status == STATUS_OK) {
    solver->matrix = stiffness;
    solver->stats.factorisations++;
  } else
    solver->stats.failed_factorisations++;
  solver->stats.factorise_s += clock_wall_s() - began;
  return status;
}

// z = P r
static Status precondition(void *self, const double *r, double *z) {
  const PcgSolver *solver = self;
#pragma omp parallel for schedule(static) if (solver->size > PARALLEL_SIZE)
  for (int b = 0; b < solver->block_count; b++) {
    int first = solver->first[b], size = solver->first[b + 1] - first;
    const double *inverse = solver->inverse + 9 * b;
    for (int i = 0; i < size; i++) {
      double sum = 0;
      for (int j = 0; j < size; j++) sum += inverse[3 * i + j] * r[first + j];
      z[first + i] = sum;
    }
  }
  return STATUS_OK;
}

static Status solve(void *self, const double *b, double *x) {
  PcgSolver *solver = self;
  if (!solver->matrix) return status_fail(STATUS_SOLVER, "pcg: no matrix to solve with");
  double began = clock_wall_s();
  int before = fem_solver_use_threads(solver->threads);
  FemCgProblem problem = {.matrix = solver->matrix,
                          .precondition = precondition,
                          .self = solver,
                          .name = "pcg",
                          .tolerance = solver->tolerance,
                          .limit = solver->size < PCG_ITERATIONS / 2 ? 2 * solver->size : PCG_ITERATIONS};
  FemCgEnd end;
  Status status = fem_cg_solve(&solver->cg, &problem, b, x, &solver->stats.iterations, &end);
  fem_solver_use_threads(before);
  solver->stats.solves++;
  solver->stats.solve_s += clock_wall_s() - began;
  return status;
}

static const FemSolverStats *stats(const void *self) {
  return &((const PcgSolver *)self)->stats;
}

const FemSolverOps fem_solver_pcg = {
    .name = "pcg",
    .help = "condensed system, conjugate gradients with block-Jacobi preconditioning",
    .is_condensed = true,
    .tolerance = 1e-8,
    .create = create,
    .analyse = analyse,
    .factorise = factorise,
    .solve = solve,
    .destroy = destroy,
    .stats = stats,
};

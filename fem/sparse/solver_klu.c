// SPDX-License-Identifier: GPL-3.0-or-later
// The full Newton matrix of y = [u; v] by KLU's sparse LU factorisation:
//
//   [ c I   −I      ]   rows of u̇ − v = 0
//   [ K      c M + D ]   rows of M v̇ − f = 0
//
// Here to compare with the condensed form; nothing requires it to be positive definite.
#include "fem/sparse/solver.h"

#include <limits.h>
#include <math.h>
#include <string.h>
#include <suitesparse/klu.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "fem/sparse/vector.h"

// A refactorisation keeps the old pivots. It is given up for new ones when the reciprocal pivot growth (1: no
// growth of entries) has fallen to this share of what it was with pivots of its own.
static const double ACCEPTED_GROWTH = 1e-2;

typedef struct KluSolver {
  klu_common common;
  klu_symbolic *symbolic;
  klu_numeric *numeric;
  int size;         // n; the system has 2n rows
  long long layout; // of K and D; 0: not analysed
  bool has_damping; // what `begin`, `row` and the slots are laid out for
  bool is_laid_out, is_factorised;
  int *begin, *row; // the full matrix in compressed columns
  double *value;
  int *lower, *upper;                 // of entry k of K: where (i, j) and (j, i) stand       (entry_count)
  int *damping_lower, *damping_upper; // the same for D; without damping only the diagonal
  double growth;                      // reciprocal pivot growth of the last full factorisation
  FemSolverStats stats;
} KluSolver;

static Status fail_in(const KluSolver *solver, const char *what) {
  if (solver->common.status == KLU_OUT_OF_MEMORY) return status_no_memory("the factor of the full system");
  if (solver->common.status == KLU_TOO_LARGE)
    return status_fail(STATUS_SOLVER,
                       "klu: the full system is too large to be numbered: use solver.linear: cholmod");
  return status_fail(STATUS_SOLVER, "klu: %s failed with status %d", what, solver->common.status);
}

static void forget_layout(KluSolver *solver) {
  klu_free_numeric(&solver->numeric, &solver->common);
  klu_free_symbolic(&solver->symbolic, &solver->common);
  memory_free(solver->begin), memory_free(solver->row), memory_free(solver->value);
  memory_free(solver->lower), memory_free(solver->upper);
  memory_free(solver->damping_lower), memory_free(solver->damping_upper);
  solver->begin = solver->row = NULL, solver->value = NULL;
  solver->lower = solver->upper = solver->damping_lower = solver->damping_upper = NULL;
  solver->is_laid_out = solver->is_factorised = false;
}

static Status create(void **self, int threads, double tolerance) {
  (void)threads, (void)tolerance;
  KluSolver *solver = memory_zeroed(1, sizeof *solver);
  *self = solver;
  if (!solver) return status_no_memory("the solver klu");
  klu_defaults(&solver->common);
  return STATUS_OK;
}

static void destroy(void *self) {
  if (!self) return;
  forget_layout(self);
  memory_free(self);
}

// Entries of the columns: n of u, then n of v. `end` is a scratch list of where the next entry goes.
static size_t count_entries(KluSolver *solver, const FemMatrix *K, bool has_damping) {
  int n = K->size;
  size_t total = 0;
  for (int j = 0; j < n; j++) {
    for (int k = K->col_begin[j]; k < K->col_begin[j + 1]; k++) {
      int i = K->row[k];
      solver->begin[j + 1]++;
      if (i != j) solver->begin[i + 1]++;
      if (i == j || has_damping) solver->begin[n + j + 1]++;
      if (i != j && has_damping) solver->begin[n + i + 1]++;
    }
    solver->begin[j + 1]++, solver->begin[n + j + 1]++; // c I and −I
  }
  for (int j = 0; j < 2 * n; j++) total += (size_t)solver->begin[j + 1];
  return total;
}

// Rows in ascending order, because column j's part above the diagonal was met in columns before j.
static void place_entries(KluSolver *solver, const FemMatrix *K, bool has_damping, int *end) {
  int n = K->size;
  memcpy(end, solver->begin, 2 * (size_t)n * sizeof *end);
  for (int j = 0; j < 2 * n; j++) solver->row[end[j]++] = j % n;
  for (int j = 0; j < n; j++)
    for (int k = K->col_begin[j]; k < K->col_begin[j + 1]; k++) {
      int i = K->row[k];
      solver->row[solver->lower[k] = end[j]++] = n + i;
      solver->upper[k] = solver->lower[k];
      if (i != j) solver->row[solver->upper[k] = end[i]++] = n + j;
      if (i != j && !has_damping) continue;
      solver->row[solver->damping_lower[k] = end[n + j]++] = n + i;
      solver->damping_upper[k] = solver->damping_lower[k];
      if (i != j) solver->row[solver->damping_upper[k] = end[n + i]++] = n + j;
    }
}

static Status lay_out(KluSolver *solver, const FemMatrix *K, bool has_damping) {
  size_t columns = 2 * (size_t)K->size, entries = (size_t)K->entry_count;
  if (columns >= INT_MAX / 8 || 4 * entries + 2 * columns > INT_MAX)
    return status_fail(
        STATUS_INPUT, "klu: the full system has too many entries to be numbered: use solver.linear: cholmod");
  solver->begin = memory_zeroed(columns + 1, sizeof *solver->begin);
  solver->lower = memory_zeroed(entries, sizeof *solver->lower);
  solver->upper = memory_zeroed(entries, sizeof *solver->upper);
  solver->damping_lower = memory_zeroed(entries, sizeof *solver->damping_lower);
  solver->damping_upper = memory_zeroed(entries, sizeof *solver->damping_upper);
  int *end = memory_zeroed(columns, sizeof *end);
  bool has_room = solver->begin && solver->lower && solver->upper && solver->damping_lower &&
                  solver->damping_upper && end;
  if (has_room) {
    size_t total = count_entries(solver, K, has_damping);
    solver->row = memory_zeroed(total, sizeof *solver->row);
    solver->value = memory_zeroed(total, sizeof *solver->value);
    has_room = solver->row && solver->value;
  }
  if (has_room) {
    for (size_t j = 0; j < columns; j++) solver->begin[j + 1] += solver->begin[j];
    place_entries(solver, K, has_damping, end);
  }
  memory_free(end);
  if (!has_room) return status_no_memory("the full system");
  solver->has_damping = has_damping;
  solver->is_laid_out = true;
  return STATUS_OK;
}

// Whether there is damping is known with the first numbers only, so the layout waits for them.
static Status analyse(void *self, const FemMatrix *pattern) {
  KluSolver *solver = self;
  forget_layout(solver);
  solver->size = pattern->size;
  solver->layout = pattern->layout;
  return STATUS_OK;
}

static Status analyse_full(KluSolver *solver, const FemMatrix *K, bool has_damping) {
  double began = clock_wall_s();
  forget_layout(solver);
  TRY(lay_out(solver, K, has_damping));
  solver->symbolic = klu_analyze(2 * solver->size, solver->begin, solver->row, &solver->common);
  if (!solver->symbolic) {
    solver->is_laid_out = false;
    return fail_in(solver, "analysis");
  }
  solver->stats.analyses++;
  solver->stats.analyse_s += clock_wall_s() - began;
  return STATUS_OK;
}

static void fill(KluSolver *solver, const FemMatrix *K, const FemMatrix *D, const double *mass, double c) {
  int n = solver->size;
  for (int j = 0; j < n; j++) {
    solver->value[solver->begin[j]] = c;
    solver->value[solver->begin[n + j]] = -1;
    for (int k = K->col_begin[j]; k < K->col_begin[j + 1]; k++) {
      solver->value[solver->lower[k]] = solver->value[solver->upper[k]] = K->value[k];
      if (D) solver->value[solver->damping_lower[k]] = solver->value[solver->damping_upper[k]] = D->value[k];
    }
    double *diagonal = &solver->value[solver->damping_lower[K->col_begin[j]]];
    *diagonal = c * mass[j] + (D ? D->value[K->col_begin[j]] : 0);
  }
}

static Status fail_singular(void) {
  return status_fail(STATUS_RETRY, "the full matrix is singular or not finite");
}

static Status factor_anew(KluSolver *solver) {
  klu_common *common = &solver->common;
  klu_free_numeric(&solver->numeric, common);
  solver->numeric = klu_factor(solver->begin, solver->row, solver->value, solver->symbolic, common);
  if (common->status == KLU_SINGULAR) return fail_singular();
  if (!solver->numeric) return fail_in(solver, "factorisation");
  klu_rgrowth(solver->begin, solver->row, solver->value, solver->symbolic, solver->numeric, common);
  solver->growth = common->rgrowth;
  return STATUS_OK;
}

// With the old pivots if they still serve, else with new ones.
static Status refactor(KluSolver *solver) {
  klu_common *common = &solver->common;
  if (!fem_vector_is_finite(solver->begin[2 * solver->size], solver->value)) return fail_singular();
  if (solver->numeric &&
      klu_refactor(solver->begin, solver->row, solver->value, solver->symbolic, solver->numeric, common) &&
      common->status == KLU_OK &&
      klu_rgrowth(solver->begin, solver->row, solver->value, solver->symbolic, solver->numeric, common) &&
      common->rgrowth >= ACCEPTED_GROWTH * solver->growth)
    return STATUS_OK;
  return factor_anew(solver);
}

static Status factorise(void *self, const FemMatrix *stiffness, const FemMatrix *damping,
                        const double *mass_of_unknown, double c) {
  KluSolver *solver = self;
  solver->is_factorised = false;
  if (!solver->layout || stiffness->layout != solver->layout ||
      (damping && damping->layout != solver->layout))
    return status_fail(STATUS_SOLVER, "klu: this layout of the matrix has not been analysed");
  if (!solver->is_laid_out || solver->has_damping != (damping != NULL))
    TRY(analyse_full(solver, stiffness, damping != NULL));
  double began = clock_wall_s();
  fill(solver, stiffness, damping, mass_of_unknown, c);
  Status status = refactor(solver);
  solver->is_factorised = status == STATUS_OK;
  if (status == STATUS_OK) {
    solver->stats.factorisations++;
    solver->stats.factor_entries = (double)solver->numeric->lnz + (double)solver->numeric->unz;
  } else
    solver->stats.failed_factorisations++;
  solver->stats.factorise_s += clock_wall_s() - began;
  return status;
}

static Status solve(void *self, const double *b, double *x) {
  KluSolver *solver = self;
  if (!solver->is_factorised) return status_fail(STATUS_SOLVER, "klu: no factor to solve with");
  double began = clock_wall_s();
  memcpy(x, b, 2 * (size_t)solver->size * sizeof *x);
  if (!klu_solve(solver->symbolic, solver->numeric, 2 * solver->size, 1, x, &solver->common))
    return fail_in(solver, "solution");
  solver->stats.solves++;
  solver->stats.solve_s += clock_wall_s() - began;
  if (!fem_vector_is_finite(2 * solver->size, x))
    return status_fail(STATUS_RETRY, "the solution of the full system is not finite");
  return STATUS_OK;
}

static const FemSolverStats *stats(const void *self) {
  return &((const KluSolver *)self)->stats;
}

const FemSolverOps fem_solver_klu = {
    .name = "klu",
    .help = "full system of displacements and velocities, LU factorisation (KLU); for comparison",
    .is_condensed = false,
    .create = create,
    .analyse = analyse,
    .factorise = factorise,
    .solve = solve,
    .destroy = destroy,
    .stats = stats,
};

// SPDX-License-Identifier: GPL-3.0-or-later
// Condensed system by conjugate gradients with algebraic multigrid of PETSc (fem/sparse/petsc/multigrid.h):
// `amg` is BoomerAMG, `gamg` smoothed aggregation.
//
// A hierarchy costs as much as some five iterations and still serves after small changes of the matrix: it is
// kept while the number of iterations stays near that of when it was new. Conjugate gradients always use the
// newest matrix, so the solution does not depend on it. Counts decide and no clock, so a run is reproducible.
#include "base/machine/clock.h"
#include "base/memory.h"
#include "fem/sparse/cg.h"
#include "fem/sparse/petsc/multigrid.h"
#include "fem/sparse/solver.h"
#include "fem/sparse/vector.h"
#include "fem/sparse/wear.h"

// Iterations before a kept hierarchy is made anew at once, and before a new one gives up.
enum { LIMIT_KEPT = 60, LIMIT = 500 };

bool fem_solver_has_multigrid(void) {
  return fem_petsc_library_has_hypre();
}

typedef struct PetscSolver {
  int threads;
  double tolerance, aimed; // relative: its own, and that of the next solve
  FemVertexRows rows;      // of the unknowns that were analysed
  FemPetscMultigrid multigrid;
  FemWear wear; // of its hierarchy
  FemCg cg;
  const FemMatrix *current; // borrowed, of the last factorise; NULL: none
  long long layout;         // that was analysed
  FemSolverStats stats;
} PetscSolver;

static const char *name_of(const PetscSolver *solver) {
  return fem_petsc_multigrid_name(solver->multigrid.kind);
}

static void wear(void *self) {
  ((PetscSolver *)self)->wear.is_worn = true;
}

static void forget(PetscSolver *solver) {
  fem_petsc_multigrid_clear(&solver->multigrid);
  fem_vertex_rows_destroy(&solver->rows);
  fem_cg_destroy(&solver->cg);
  solver->current = NULL;
  solver->layout = 0;
}

static void destroy(void *self) {
  if (!self) return;
  forget(self);
  memory_free(self);
}

static Status create(FemPetscKind kind, void **self, int threads, double tolerance) {
  *self = NULL;
  FemPetscMultigrid multigrid;
  if (!(tolerance > 0 && tolerance < 1))
    return status_fail(STATUS_INPUT, "solver %s: the tolerance must lie between 0 and 1, not %g",
                       fem_petsc_multigrid_name(kind), tolerance);
  TRY(fem_petsc_multigrid_open(&multigrid, kind));
  PetscSolver *solver = memory_zeroed(1, sizeof *solver);
  if (!solver) return status_no_memory("the solver amg");
  *self = solver;
  solver->multigrid = multigrid;
  solver->threads = threads;
  solver->tolerance = solver->aimed = tolerance;
  return STATUS_OK;
}

static Status create_amg(void **self, int threads, double tolerance) {
  return create(FEM_PETSC_BOOMER, self, threads, tolerance);
}
static Status create_gamg(void **self, int threads, double tolerance) {
  return create(FEM_PETSC_GAMG, self, threads, tolerance);
}

// Another pattern over the same unknowns leaves the hierarchy be.
static Status analyse_rows(PetscSolver *solver, const FemMatrix *pattern) {
  FemVertexRows rows;
  TRY(fem_vertex_rows_create(&rows, pattern));
  if (solver->rows.place && fem_vertex_rows_are_same(&solver->rows, &rows)) {
    fem_vertex_rows_destroy(&rows);
    return STATUS_OK;
  }
  forget(solver);
  solver->rows = rows;
  Status status = fem_petsc_multigrid_lay_out(&solver->multigrid, rows.count);
  if (!status) status = fem_cg_create(&solver->cg, rows.size);
  if (status) forget(solver);
  return status;
}

static Status analyse(void *self, const FemMatrix *pattern) {
  PetscSolver *solver = self;
  double began = clock_wall_s();
  solver->current = NULL;
  solver->layout = 0;
  TRY(analyse_rows(solver, pattern));
  solver->layout = pattern->layout;
  solver->stats.analyses++;
  solver->stats.analyse_s += clock_wall_s() - began;
  return STATUS_OK;
}

// A new hierarchy, by one thread of the BLAS in it.
static Status build(PetscSolver *solver, const FemMatrix *matrix) {
  fem_wear_renew(&solver->wear);
  int before = fem_solver_use_threads(1);
  Status status = fem_petsc_multigrid_build(&solver->multigrid, &solver->rows, matrix);
  fem_solver_use_threads(before);
  solver->stats.hierarchies += status == STATUS_OK;
  return status;
}

static bool has_positive_diagonal(const FemMatrix *matrix) {
  bool is_positive = true;
  for (int u = 0; u < matrix->size; u++) is_positive = is_positive && matrix->value[matrix->col_begin[u]] > 0;
  return is_positive;
}

static Status renew(PetscSolver *solver, const FemMatrix *matrix) {
  if (!fem_vector_is_finite(matrix->entry_count, matrix->value))
    return status_fail(STATUS_RETRY, "the condensed matrix is not finite");
  if (!has_positive_diagonal(matrix))
    return status_fail(STATUS_RETRY, "the condensed matrix is not positive definite");
  if (fem_petsc_multigrid_is_built(&solver->multigrid) && !solver->wear.is_worn) return STATUS_OK;
  return build(solver, matrix);
}

// Counts a factorisation that ended with `status`, and its time.
static void count_factorisation(PetscSolver *solver, Status status, double began_s) {
  if (status == STATUS_OK)
    solver->stats.factorisations++;
  else
    solver->stats.failed_factorisations++;
  solver->stats.factorise_s += clock_wall_s() - began_s;
}

static Status factorise(void *self, const FemMatrix *stiffness, const FemMatrix *damping,
                        const double *mass_of_unknown, double c) {
  PetscSolver *solver = self;
  (void)damping, (void)mass_of_unknown, (void)c;
  solver->current = NULL;
  if (!solver->layout || stiffness->layout != solver->layout)
    return status_fail(STATUS_SOLVER, "%s: this layout of the matrix has not been analysed", name_of(solver));
  double began = clock_wall_s();
  Status status = renew(solver, stiffness);
  if (status == STATUS_OK) solver->current = stiffness;
  count_factorisation(solver, status, began);
  return status;
}

static void aim(void *self, double tolerance) {
  PetscSolver *solver = self;
  solver->aimed = fem_wear_aim(solver->tolerance, tolerance);
}

static Status precondition(void *self, const double *r, double *z) {
  PetscSolver *solver = self;
  const FemVertexRows *rows = &solver->rows;
  FemPetscMultigrid *multigrid = &solver->multigrid;
#pragma omp parallel for schedule(static) if (rows->size > FEM_VECTOR_LONG)
  for (int u = 0; u < rows->size; u++) multigrid->right[rows->place[u]] = r[u];
  TRY(fem_petsc_multigrid_apply(multigrid));
#pragma omp parallel for schedule(static) if (rows->size > FEM_VECTOR_LONG)
  for (int u = 0; u < rows->size; u++) z[u] = multigrid->left[rows->place[u]];
  return STATUS_OK;
}

static Status iterate(PetscSolver *solver, const double *b, double *x, int limit, FemCgEnd *end) {
  FemCgProblem problem = {.matrix = solver->current,
                          .precondition = precondition,
                          .self = solver,
                          .name = name_of(solver),
                          .tolerance = solver->aimed,
                          .limit = limit};
  long long before = solver->stats.iterations;
  Status status = fem_cg_solve(&solver->cg, &problem, b, x, &solver->stats.iterations, end);
  if (status) { // what is kept may be of a matrix that is not positive definite
    solver->wear.is_fresh = false;
    solver->wear.is_worn = true;
    return status;
  }
  fem_wear_note(&solver->wear, solver->stats.iterations - before, solver->aimed);
  return STATUS_OK;
}

// With the hierarchy that there is, and where that is of another matrix and does not do, with a new one.
static Status solve_by(PetscSolver *solver, const double *b, double *x) {
  FemCgEnd end = FEM_CG_CONVERGED;
  bool was_fresh = solver->wear.is_fresh;
  Status status = iterate(solver, b, x, was_fresh ? LIMIT : LIMIT_KEPT, &end);
  if (status != STATUS_RETRY || was_fresh) return status;
  double began = clock_wall_s();
  status = build(solver, solver->current);
  count_factorisation(solver, status, began);
  TRY(status);
  return iterate(solver, b, x, LIMIT, &end);
}

static Status solve(void *self, const double *b, double *x) {
  PetscSolver *solver = self;
  if (!solver->current) return status_fail(STATUS_SOLVER, "%s: no matrix to solve with", name_of(solver));
  double began = clock_wall_s(), factorised_s = solver->stats.factorise_s;
  int before = fem_solver_use_threads(solver->threads);
  Status status = solve_by(solver, b, x);
  fem_solver_use_threads(before);
  solver->stats.solves++;
  solver->stats.solve_s += clock_wall_s() - began - (solver->stats.factorise_s - factorised_s);
  if (!status && !fem_vector_is_finite(solver->rows.size, x))
    return status_fail(STATUS_RETRY, "the solution of the condensed system is not finite");
  return status;
}

static const FemSolverStats *stats(const void *self) {
  return &((const PetscSolver *)self)->stats;
}

const FemSolverOps fem_solver_amg = {
    .name = "amg",
    .help = "condensed system, conjugate gradients with algebraic multigrid (BoomerAMG of hypre, by PETSc)",
    .is_condensed = true,
    .tolerance = 1e-4,
    .create = create_amg,
    .analyse = analyse,
    .factorise = factorise,
    .solve = solve,
    .forget = wear,
    .aim = aim,
    .destroy = destroy,
    .stats = stats,
};

const FemSolverOps fem_solver_gamg = {
    .name = "gamg",
    .help = "condensed system, conjugate gradients with smoothed aggregation (GAMG of PETSc); less memory",
    .is_condensed = true,
    .tolerance = 1e-4,
    .create = create_gamg,
    .analyse = analyse,
    .factorise = factorise,
    .solve = solve,
    .forget = wear,
    .aim = aim,
    .destroy = destroy,
    .stats = stats,
};

// SPDX-License-Identifier: GPL-3.0-or-later
// A matrix that ranks share, solved by PETSc. Right sides and solutions are whole on every rank. Conjugate
// gradients multiply by what each rank has added (dist/product.h); rows are made of it for a preconditioner
// alone (dist/entries.h), which is kept for new numbers while iterations stay near what they were when it was
// new (as in fem/sparse/petsc/solver_petsc.c). BoomerAMG takes them as its finest level, so no other copy is
// left.
#include "dist/solver.h"

#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "dist/entries.h"
#include "dist/hypre.h"
#include "dist/petsc.h"
#include "dist/product.h"
#include "dist/rows.h"
#include "fem/sparse/petsc/multigrid.h"
#include "fem/sparse/vector.h"
#include "fem/sparse/wear.h"

typedef enum Kind { BOOMER, GAMG, MUMPS, BLOCKS } Kind;
static const char *const names[] = {"amg", "gamg", "mumps", "block_jacobi"};
static const char *const prefixes[] = {"tetlap_amg_", "tetlap_gamg_", "tetlap_mumps_", "tetlap_blocks_"};

// Iterations before what is kept is made anew at once, and before what is new gives up.
enum { LIMIT_KEPT = 60, LIMIT = 2000 };

typedef struct DistSolver {
  Kind kind;
  double tolerance, aimed; // relative: its own, and that of the next solve
  DistRows rows;
  DistReach reach;
  DistProduct product;
  double *all; // a vector by rows, of all ranks; scratch of products                 (rows.count)
  Vec right, left;
  DistHypre *hypre; // the rows that BoomerAMG has
  KSP ksp;          // NULL: there is no preconditioner
  long long made;   // layout of the rows that it was made of
  bool has_rows;    // the numbering stands
  bool has_matrix;  // numbers are there
  FemWear wear;     // of the preconditioner
  long long layout;
  FemSolverStats stats;
} DistSolver;

static bool is_ready;

// Others wait within PETSc for a rank whose call failed: there is no way back, and the run ends.
static void fail_in(const DistSolver *solver, const char *what, PetscErrorCode code) {
  Status status = code == PETSC_ERR_MEM ? STATUS_MEMORY : STATUS_SOLVER;
  log_error("%s: %s failed with PETSc's error %d%s", names[solver->kind], what, (int)code,
            status == STATUS_MEMORY ? ", out of memory" : "");
  exit(status_exit_code(status));
}

#define PETSC(what, call)                                                                                    \
  do {                                                                                                       \
    PetscErrorCode code_ = (call);                                                                           \
    if (code_) fail_in(solver, what, code_);                                                                 \
  } while (0)

// As of one process (fem/sparse/petsc/multigrid.h), but for the sweeps: across ranks those of Gauss and
// Seidel need not converge, and with l1 they do (Baker, Falgout, Kolev and Yang 2011); one forward down and
// one backward up is symmetric.
static void set_options(void) {
  static const char *const options[][2] = {
      {"-tetlap_amg_pc_type", "hypre"},
      {"-tetlap_amg_pc_hypre_boomeramg_no_CF", NULL},
      {"-tetlap_amg_pc_hypre_boomeramg_relax_type_down", "l1-Gauss-Seidel"},
      {"-tetlap_amg_pc_hypre_boomeramg_relax_type_up", "backward-l1-Gauss-Seidel"},
      {"-tetlap_gamg_pc_type", "gamg"},
      {"-tetlap_mumps_pc_type", "cholesky"},
      {"-tetlap_mumps_pc_factor_mat_solver_type", "mumps"},
      {"-tetlap_mumps_mat_mumps_icntl_13", "1"}, // no root apart, so that its pivots are counted, too
      {"-tetlap_blocks_pc_type", "bjacobi"},
      {"-tetlap_blocks_sub_pc_type", "icc"},
      {"-tetlap_blocks_sub_pc_factor_shift_type", "positive_definite"},
  };
  for (int i = 0; i < FEM_PETSC_BOOMER_OPTIONS; i++)
    PetscOptionsSetValue(NULL, fem_petsc_boomer_options[i][0], fem_petsc_boomer_options[i][1]);
  for (size_t i = 0; i < sizeof options / sizeof *options; i++)
    PetscOptionsSetValue(NULL, options[i][0], options[i][1]);
}

// Signals and messages are ours; files of options would change results unseen.
static Status initialize(void) {
  char *own[] = {(char[]){"tetlap"},
                 (char[]){"-skip_petscrc"},
                 (char[]){"-no_signal_handler"},
                 (char[]){"-options_left"},
                 (char[]){"0"},
                 NULL};
  char **arguments = own;
  int count = 5;
  if (is_ready) return STATUS_OK;
  if (PetscInitialize(&count, &arguments, "", NULL) != 0)
    return status_fail(STATUS_SOLVER, "PETSc could not be initialised");
  PetscPushErrorHandler(PetscIgnoreErrorHandler, NULL);
  set_options();
  is_ready = true;
  return STATUS_OK;
}

void dist_solver_close(void) {
  if (is_ready) PetscFinalize();
  is_ready = false;
}

static Status create(Kind kind, void **self, double tolerance) {
  *self = NULL;
  if (!(tolerance >= 0 && tolerance < 1))
    return status_fail(STATUS_INPUT, "solver %s: the tolerance must lie between 0 and 1, not %g", names[kind],
                       tolerance);
  TRY(ranks()->worst(initialize()));
  DistSolver *solver = memory_zeroed(1, sizeof *solver);
  if (!solver) return status_no_memory("the linear solver");
  *solver = (DistSolver){.kind = kind, .tolerance = tolerance, .aimed = tolerance};
  *self = solver;
  return STATUS_OK;
}

static Status create_amg(void **self, int threads, double tolerance) {
  (void)threads; // OpenMP's, as everywhere
  return create(BOOMER, self, tolerance);
}
static Status create_gamg(void **self, int threads, double tolerance) {
  (void)threads;
  return create(GAMG, self, tolerance);
}
static Status create_mumps(void **self, int threads, double tolerance) {
  (void)threads;
  return create(MUMPS, self, tolerance);
}
static Status create_blocks(void **self, int threads, double tolerance) {
  (void)threads;
  return create(BLOCKS, self, tolerance);
}

static void forget_product(DistSolver *solver) {
  dist_product_destroy(&solver->product);
  dist_reach_destroy(&solver->reach);
  solver->has_matrix = false;
}

static void forget_preconditioner(DistSolver *solver) {
  KSPDestroy(&solver->ksp);
  dist_hypre_destroy(solver->hypre);
  solver->hypre = NULL;
}

static void forget(DistSolver *solver) {
  forget_preconditioner(solver);
  forget_product(solver);
  VecDestroy(&solver->right);
  VecDestroy(&solver->left);
  dist_rows_destroy(&solver->rows);
  memory_free(solver->all);
  solver->all = NULL;
  solver->has_rows = false;
}

static void destroy(void *self) {
  if (!self) return;
  if (is_ready) forget(self);
  memory_free(self);
}

static void wear(void *self) {
  ((DistSolver *)self)->wear.is_worn = true;
}

static void aim(void *self, double tolerance) {
  DistSolver *solver = self;
  solver->aimed = fem_wear_aim(solver->tolerance, tolerance);
}

static Status number_rows(DistSolver *solver, const FemMatrix *pattern) {
  DistRows *rows = &solver->rows;
  TRY(dist_rows_create(rows, pattern));
  solver->all = memory_zeroed((size_t)rows->count, sizeof *solver->all);
  TRY(ranks()->worst(solver->all ? STATUS_OK : status_no_memory("the condensed system")));
  PETSC("a vector", VecCreateMPI(PETSC_COMM_WORLD, rows->end - rows->first, rows->count, &solver->right));
  PETSC("a vector", VecSetBlockSize(solver->right, 3));
  PETSC("a vector", VecDuplicate(solver->right, &solver->left));
  solver->has_rows = true;
  return STATUS_OK;
}

static Status make_product(DistSolver *solver, const FemMatrix *pattern) {
  TRY(ranks()->worst(dist_reach_create(&solver->reach, pattern)));
  PETSC("the matrix",
        dist_product_create(&solver->product, &solver->rows, &solver->reach, solver->right, solver->all));
  return STATUS_OK;
}

// Factors of the same pattern are filled again. Multigrid is not: GAMG, set up a second time for another c,
// was indefinite.
static bool is_refilled(const DistSolver *solver) {
  return solver->kind == MUMPS || solver->kind == BLOCKS;
}

static Status analyse_layout(DistSolver *solver, const FemMatrix *pattern) {
  if (!solver->has_rows || !dist_rows_match(&solver->rows, pattern)) {
    forget(solver);
    TRY(number_rows(solver, pattern));
  }
  forget_product(solver);
  TRY(make_product(solver, pattern));
  // A factor is of one pattern.
  if (is_refilled(solver)) solver->wear.is_worn = true;
  return STATUS_OK;
}

static Status analyse(void *self, const FemMatrix *pattern) {
  DistSolver *solver = self;
  double began = clock_wall_s();
  solver->layout = 0;
  Status status = ranks()->worst(analyse_layout(solver, pattern));
  if (status) {
    forget(solver);
    return status;
  }
  solver->layout = pattern->layout;
  solver->stats.analyses++;
  solver->stats.analyse_s += clock_wall_s() - began;
  return STATUS_OK;
}

// MUMPS goes on over pivots below zero and counts them.
static bool has_negative_pivots(DistSolver *solver, PC pc) {
  Mat factor;
  PetscInt count;
  PETSC("the factor", PCFactorGetMatrix(pc, &factor));
  PETSC("the factor", MatMumpsGetInfog(factor, 12, &count));
  return count > 0;
}

// How many entries the rows have, in columns of this rank and of others                        (row, row)
static Status count_columns(DistSolver *solver, DistEntries *entries, int **own, int **others) {
  const DistRows *rows = &solver->rows;
  size_t count = (size_t)(rows->end - rows->first);
  *own = memory_zeroed(count, sizeof **own);
  *others = memory_zeroed(count, sizeof **others);
  if (!*own || !*others) return status_no_memory("the condensed matrix");
  for (int row = rows->first; row < rows->end; row++) {
    int entry_count = dist_entries_row(entries, row);
    for (int k = 0; k < entry_count; k++)
      (dist_rows_have(rows, entries->columns[k]) ? *own : *others)[row - rows->first]++;
  }
  return STATUS_OK;
}

static Status fill_rows(DistSolver *solver, DistEntries *entries, Mat matrix) {
  for (int row = solver->rows.first; row < solver->rows.end; row++) {
    int count = dist_entries_row(entries, row);
    PETSC("the matrix",
          MatSetValues(matrix, 1, &row, count, entries->columns, entries->values, INSERT_VALUES));
  }
  PETSC("the matrix", MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PETSC("the matrix", MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  return STATUS_OK;
}

static Status make_matrix(DistSolver *solver, DistEntries *entries, const int *own, const int *others,
                          Mat *matrix) {
  int row_count = solver->rows.end - solver->rows.first, all = solver->rows.count;
  PETSC("the matrix", MatCreate(PETSC_COMM_WORLD, matrix));
  PETSC("the matrix", MatSetSizes(*matrix, row_count, row_count, all, all));
  PETSC("the matrix", MatSetType(*matrix, MATMPIAIJ));
  PETSC("the matrix", MatSetBlockSize(*matrix, 3));
  PETSC("the matrix", MatMPIAIJSetPreallocation(*matrix, 0, own, 0, others));
  return fill_rows(solver, entries, *matrix);
}

// BoomerAMG takes a matrix of hypre's as its own.
static Status make_hypre(DistSolver *solver, DistEntries *entries, const int *own, const int *others,
                         Mat *matrix) {
  const DistRows *rows = &solver->rows;
  Status status = dist_hypre_create(&solver->hypre, PETSC_COMM_WORLD, rows->first, rows->end, own, others);
  TRY(ranks()->worst(status));
  for (int row = rows->first; row < rows->end && !status; row++) {
    int count = dist_entries_row(entries, row);
    status = dist_hypre_set_row(solver->hypre, row, count, entries->columns, entries->values);
  }
  TRY(ranks()->worst(status));
  TRY(ranks()->worst(dist_hypre_end(solver->hypre, matrix)));
  PETSC("the matrix", MatSetBlockSize(*matrix, 3));
  return STATUS_OK;
}

static Status make_rows(DistSolver *solver, DistEntries *entries, Mat *matrix) {
  int *own = NULL, *others = NULL;
  Status status = ranks()->worst(count_columns(solver, entries, &own, &others));
  if (!status)
    status = (solver->kind == BOOMER ? make_hypre : make_matrix)(solver, entries, own, others, matrix);
  memory_free(own), memory_free(others);
  TRY(status);
  PETSC("the matrix", MatSetOption(*matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PETSC("the matrix", MatSetOption(*matrix, MAT_SPD, PETSC_TRUE));
  return STATUS_OK;
}

static Status make_ksp(DistSolver *solver, Mat rows) {
  PC pc;
  PETSC("the solver", KSPCreate(PETSC_COMM_WORLD, &solver->ksp));
  PETSC("the solver", KSPSetOptionsPrefix(solver->ksp, prefixes[solver->kind]));
  PETSC("the solver", KSPSetType(solver->ksp, solver->kind == MUMPS ? KSPPREONLY : KSPCG));
  if (solver->kind != MUMPS) PETSC("the solver", KSPSetNormType(solver->ksp, KSP_NORM_NATURAL));
  PETSC("the solver", KSPSetOperators(solver->ksp, solver->product.shell, rows));
  PETSC("the solver", KSPSetFromOptions(solver->ksp));
  PETSC("the solver", KSPGetPC(solver->ksp, &pc));
  if (solver->kind == GAMG)
    PETSC("the multigrid",
          PCSetCoordinates(pc, 3, (solver->rows.end - solver->rows.first) / 3, solver->rows.rest));
  return STATUS_OK;
}

// Rows of the newest numbers in place of those that there are. What cannot be filled again goes before they
// are made.
static Status renew_rows(DistSolver *solver, DistEntries *entries) {
  Mat rows = NULL;
  if (solver->ksp && is_refilled(solver) && solver->made == solver->product.matrix->layout) {
    PETSC("the solver", KSPGetOperators(solver->ksp, NULL, &rows));
    return fill_rows(solver, entries, rows);
  }
  forget_preconditioner(solver);
  Status status = make_rows(solver, entries, &rows);
  if (!status) status = make_ksp(solver, rows);
  MatDestroy(&rows); // the solver has it
  TRY(status);
  solver->made = solver->product.matrix->layout;
  return STATUS_OK;
}

static Status renew(DistSolver *solver) {
  DistEntries entries;
  // Rows that are filled again have all places.
  TRY(dist_entries_create(&entries, &solver->rows, &solver->reach, solver->product.matrix,
                          !is_refilled(solver)));
  Status status = renew_rows(solver, &entries);
  dist_entries_destroy(&entries);
  return status;
}

static Status set_up(DistSolver *solver) {
  bool is_kept = solver->ksp && !solver->wear.is_worn && solver->kind != MUMPS;
  PC pc;
  Mat rows;
  PCFailedReason reason;
  if (!is_kept) TRY(renew(solver));
  PETSC("the solver", KSPSetReusePreconditioner(solver->ksp, is_kept ? PETSC_TRUE : PETSC_FALSE));
  // Told anew of its matrix, KSPSetUp looks at it; else the first application would, and find what is wrong.
  PETSC("the solver", KSPGetOperators(solver->ksp, NULL, &rows));
  PETSC("the solver", KSPSetOperators(solver->ksp, solver->product.shell, rows));
  PETSC("the solver", KSPSetUp(solver->ksp));
  PETSC("the solver", KSPGetPC(solver->ksp, &pc));
  PETSC("the solver", dist_petsc_failure(pc, &reason));
  if (is_kept) return STATUS_OK;
  fem_wear_renew(&solver->wear);
  if (solver->kind == BOOMER || solver->kind == GAMG) solver->stats.hierarchies++;
  if (reason == PC_NOERROR && !(solver->kind == MUMPS && has_negative_pivots(solver, pc))) return STATUS_OK;
  if (reason == PC_FACTOR_OUTMEMORY) return status_no_memory("the factor of the condensed system");
  return status_fail(STATUS_RETRY, "the condensed matrix is not positive definite (found by %s)",
                     names[solver->kind]);
}

static Status look_at(DistSolver *solver, const FemMatrix *matrix) {
  double least;
  bool is_finite = fem_vector_is_finite(matrix->entry_count, matrix->value);
  TRY(ranks()->worst(is_finite ? STATUS_OK
                               : status_fail(STATUS_RETRY, "the condensed matrix is not finite")));
  dist_product_set(&solver->product, matrix);
  PETSC("the matrix", dist_product_diagonal(&solver->product, solver->left));
  PETSC("the matrix", VecMin(solver->left, NULL, &least));
  return least > 0 ? STATUS_OK : status_fail(STATUS_RETRY, "the condensed matrix is not positive definite");
}

static Status factorise(void *self, const FemMatrix *stiffness, const FemMatrix *damping,
                        const double *mass_of_unknown, double c) {
  DistSolver *solver = self;
  (void)damping, (void)mass_of_unknown, (void)c;
  if (!solver->layout || stiffness->layout != solver->layout)
    return status_fail(STATUS_SOLVER, "%s: this layout of the matrix has not been analysed",
                       names[solver->kind]);
  double began = clock_wall_s();
  Status status = look_at(solver, stiffness);
  if (!status) status = set_up(solver);
  status = ranks()->worst(status);
  solver->has_matrix = status == STATUS_OK;
  if (status) solver->wear.is_worn = true;
  *(status ? &solver->stats.failed_factorisations : &solver->stats.factorisations) += 1;
  solver->stats.factorise_s += clock_wall_s() - began;
  return status;
}

static Status take_right(DistSolver *solver, const double *b) {
  const DistRows *rows = &solver->rows;
  double *right;
  PETSC("a vector", VecSet(solver->right, 0));
  PETSC("a vector", VecGetArray(solver->right, &right));
  for (int k = 0; k < rows->own_count; k++) right[rows->row[rows->own[k]] - rows->first] = b[rows->own[k]];
  PETSC("a vector", VecRestoreArray(solver->right, &right));
  return STATUS_OK;
}

static Status give_left(DistSolver *solver, double *x) {
  const DistRows *rows = &solver->rows;
  const double *left;
  PETSC("a vector", VecGetArrayRead(solver->left, &left));
  for (int row = rows->first; row < rows->end; row++) solver->all[row] = left[row - rows->first];
  PETSC("a vector", VecRestoreArrayRead(solver->left, &left));
  ranks()->join(solver->all, sizeof *solver->all, rows->begin);
  for (int u = 0; u < rows->size; u++) x[u] = solver->all[rows->row[u]];
  return STATUS_OK;
}

// *is_limit: it only took too long.
static Status iterate(DistSolver *solver, int limit, bool *is_limit) {
  static const double DIVERGED = 1e30, SMALLEST = 1e-290;
  KSPConvergedReason reason;
  PetscInt taken;
  PETSC("the solver", KSPSetTolerances(solver->ksp, solver->aimed, SMALLEST, DIVERGED, limit));
  PETSC("the solver", KSPSolve(solver->ksp, solver->right, solver->left));
  PETSC("the solver", KSPGetConvergedReason(solver->ksp, &reason));
  PETSC("the solver", KSPGetIterationNumber(solver->ksp, &taken));
  solver->stats.iterations += solver->kind == MUMPS ? 0 : taken;
  *is_limit = reason == KSP_DIVERGED_ITS;
  if (solver->kind != MUMPS) fem_wear_note(&solver->wear, taken, solver->aimed);
  if (reason > 0) return STATUS_OK;
  solver->wear.is_worn = true;
  if (*is_limit)
    return status_fail(
        STATUS_RETRY,
        "%s did not converge in %d iterations: use solver.linear: cholmod (MUMPS over ranks), or "
        "a larger solver.tolerance",
        names[solver->kind], limit);
  return status_fail(STATUS_RETRY, "the condensed matrix is not positive definite (found by %s)",
                     names[solver->kind]);
}

// With the preconditioner that there is, and where that is of another matrix and does not do, with a new one.
static Status solve_by(DistSolver *solver) {
  bool was_fresh = solver->wear.is_fresh, is_limit;
  Status status = iterate(solver, was_fresh ? LIMIT : LIMIT_KEPT, &is_limit);
  if (status != STATUS_RETRY || was_fresh || solver->kind == MUMPS) return status;
  solver->wear.is_worn = true;
  TRY(ranks()->worst(set_up(solver)));
  return iterate(solver, LIMIT, &is_limit);
}

static Status solve(void *self, const double *b, double *x) {
  DistSolver *solver = self;
  if (!solver->has_matrix)
    return status_fail(STATUS_SOLVER, "%s: no matrix to solve with", names[solver->kind]);
  double began = clock_wall_s();
  Status status = take_right(solver, b);
  if (!status) status = solve_by(solver);
  if (!status) status = give_left(solver, x);
  status = ranks()->worst(status);
  solver->stats.solves++;
  solver->stats.solve_s += clock_wall_s() - began;
  if (!status && !fem_vector_is_finite(solver->rows.size, x))
    return status_fail(STATUS_RETRY, "the solution of the condensed system is not finite");
  return status;
}

static const FemSolverStats *stats(const void *self) {
  return &((const DistSolver *)self)->stats;
}

#define DIST_SOLVER(kind, words, create_one, share, aim_one)                                                 \
  {                                                                                                          \
    .name = kind, .help = words, .is_condensed = true, .tolerance = share, .create = create_one,             \
    .analyse = analyse, .factorise = factorise, .solve = solve, .aim = aim_one, .forget = wear,              \
    .destroy = destroy, .stats = stats                                                                       \
  }

static const FemSolverOps amg = DIST_SOLVER("amg", "over ranks: BoomerAMG of hypre", create_amg, 1e-4, aim),
                          gamg = DIST_SOLVER("gamg", "over ranks: GAMG of PETSc", create_gamg, 1e-4, aim),
                          mumps = DIST_SOLVER("mumps", "over ranks: an exact factor", create_mumps, 0, NULL),
                          blocks = DIST_SOLVER("block_jacobi", "over ranks: ICC(0) of each rank's block",
                                               create_blocks, 1e-8, NULL);

static const FemSolverOps *const table[FEM_SOLVER_COUNT] = {[FEM_SOLVER_CHOLMOD] = &mumps,
                                                            [FEM_SOLVER_PCG] = &blocks,
                                                            [FEM_SOLVER_AMG] = &amg,
                                                            [FEM_SOLVER_GAMG] = &gamg};

void dist_solver_provide(void) {
  fem_solver_provide(table);
}

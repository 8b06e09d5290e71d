// SPDX-License-Identifier: GPL-3.0-or-later
// Condensed system by conjugate gradients with algebraic multigrid of PETSc: `amg` is hypre's BoomerAMG, with
// unknowns of a vertex kept apart by their direction (Henson and Yang 2002) and its hierarchy worked through
// by fem/sparse/multigrid/cycle.h, `gamg` PETSc's smoothed aggregation with the rigid motions as near-null
// space (Vaněk, Mandel and Brezina 1996; Adams et al. 2004).
//
// A hierarchy costs as much as some five iterations and still serves after small changes of the matrix: it is
// kept while the number of iterations stays near that of when it was new. Conjugate gradients always use the
// newest matrix, so the solution does not depend on it. Counts decide and no clock, so a run is reproducible.
//
// The multigrid sees three coordinates of every vertex that has an unknown; prescribed ones stand alone, with
// nothing but a diagonal.
#include <limits.h>
#include <math.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "fem/sparse/cg.h"
#include "fem/sparse/petsc/hierarchy.h"
#include "fem/sparse/petsc/petsc_library.h"
#include "fem/sparse/solver.h"
#include "fem/sparse/vector.h"
#include "fem/sparse/wear.h"

// Iterations before a kept hierarchy is made anew at once, and before a new one gives up.
enum { LIMIT_KEPT = 60, LIMIT = 500 };

bool fem_solver_has_multigrid(void) {
  return fem_petsc_library_has_hypre();
}

typedef enum Kind { BOOMER, GAMG } Kind;
static const char *const names[] = {[BOOMER] = "amg", [GAMG] = "gamg"};
static const char *const prefixes[] = {[BOOMER] = "tetlap_amg_", [GAMG] = "tetlap_gamg_"};

// Rows of the whole matrix, both halves, of the coordinates that the multigrid sees.
typedef struct Rows {
  int count;
  int *begin, *column; //      (count + 1), (begin[count])
  double *value;       //      (begin[count])
} Rows;

typedef struct PetscSolver {
  Kind kind;
  const FemPetscLibrary *petsc;
  int threads;
  double tolerance, aimed; // relative: its own, and that of the next solve
  int size;                // unknowns
  int row_count;           // three a vertex that has some
  int *place;              // row of each unknown                             (size)
  double *rest;            // of those vertices [m]; NULL: not known          (row_count)
  double *right, *left;    // what the multigrid is given and gives           (row_count)
  Vec right_vec, left_vec; // views of them
  Rows rows;               // kept by gamg, whose matrix they are
  Mat matrix;              // of gamg
  PC multigrid;            // of gamg; NULL: none yet
  FemCycle cycle;          // of amg; without levels: none yet
  FemWear wear;            // of either
  FemCg cg;
  const FemMatrix *current; // borrowed, of the last factorise; NULL: none
  long long layout;         // that was analysed
  FemSolverStats stats;
} PetscSolver;

static void wear(void *self) {
  ((PetscSolver *)self)->wear.is_worn = true;
}

// Errors that a matrix can be the cause of, so that another one may do. hypre's are all of one kind.
static bool is_of_matrix(PetscErrorCode code) {
  return code == PETSC_ERR_MAT_LU_ZRPVT || code == PETSC_ERR_MAT_CH_ZRPVT || code == PETSC_ERR_FP ||
         code == PETSC_ERR_CONV_FAILED || code == PETSC_ERR_NOT_CONVERGED || code == PETSC_ERR_LIB;
}

static Status fail_in(const PetscSolver *solver, const char *what, PetscErrorCode code) {
  if (code == PETSC_ERR_MEM) return status_no_memory("the multigrid of the condensed system");
  return status_fail(is_of_matrix(code) ? STATUS_RETRY : STATUS_SOLVER,
                     "%s: %s failed with PETSc's error %d; solver.linear: cholmod does without PETSc",
                     names[solver->kind], what, (int)code);
}

#define PETSC_TRY(what, call)                                                                                \
  do {                                                                                                       \
    PetscErrorCode code_ = (call);                                                                           \
    if (code_) return fail_in(solver, what, code_);                                                          \
  } while (0)

static void free_rows(Rows *rows) {
  memory_free(rows->begin), memory_free(rows->column), memory_free(rows->value);
  *rows = (Rows){0};
}

static void forget_multigrid(PetscSolver *solver) {
  if (solver->multigrid) solver->petsc->PCDestroy(&solver->multigrid);
  if (solver->matrix) solver->petsc->MatDestroy(&solver->matrix);
  fem_cycle_destroy(&solver->cycle);
  solver->multigrid = NULL, solver->matrix = NULL;
  free_rows(&solver->rows);
}

static void forget(PetscSolver *solver) {
  forget_multigrid(solver);
  if (solver->right_vec) solver->petsc->VecDestroy(&solver->right_vec);
  if (solver->left_vec) solver->petsc->VecDestroy(&solver->left_vec);
  memory_free(solver->place), memory_free(solver->rest);
  memory_free(solver->right), memory_free(solver->left);
  fem_cg_destroy(&solver->cg);
  solver->place = NULL, solver->rest = solver->right = solver->left = NULL;
  solver->right_vec = solver->left_vec = NULL;
  solver->current = NULL;
  solver->layout = 0;
}

static void destroy(void *self) {
  if (!self) return;
  forget(self);
  memory_free(self);
}

// BoomerAMG as measured on contact, friction, statics and ν = 0.45: one level of aggressive coarsening, which
// halves memory for a third more iterations. gamg with its own smoother.
static Status set_options(const PetscSolver *solver) {
  static const char *const options[][2] = {
      {"-tetlap_amg_pc_hypre_type", "boomeramg"},
      {"-tetlap_amg_pc_hypre_boomeramg_coarsen_type", "HMIS"},
      {"-tetlap_amg_pc_hypre_boomeramg_interp_type", "ext+i"},
      {"-tetlap_amg_pc_hypre_boomeramg_P_max", "4"},
      {"-tetlap_amg_pc_hypre_boomeramg_strong_threshold", "0.5"},
      {"-tetlap_amg_pc_hypre_boomeramg_agg_nl", "1"},
      {"-tetlap_gamg_pc_gamg_reuse_interpolation", "true"},
  };
  for (size_t i = 0; i < sizeof options / sizeof *options; i++)
    PETSC_TRY(options[i][0], solver->petsc->PetscOptionsSetValue(NULL, options[i][0], options[i][1]));
  return STATUS_OK;
}

static Status create(Kind kind, void **self, int threads, double tolerance) {
  *self = NULL;
  const FemPetscLibrary *petsc;
  if (!(tolerance > 0 && tolerance < 1))
    return status_fail(STATUS_INPUT, "solver %s: the tolerance must lie between 0 and 1, not %g", names[kind],
                       tolerance);
  TRY(fem_petsc_library(&petsc));
  if (kind == BOOMER && !fem_petsc_library_has_hypre())
    return status_fail(STATUS_IO,
                       "solver.linear: amg is BoomerAMG of hypre, which this PETSc was built without; "
                       "use gamg or cholmod");
  PetscSolver *solver = memory_zeroed(1, sizeof *solver);
  if (!solver) return status_no_memory("the solver amg");
  *self = solver;
  solver->kind = kind;
  solver->petsc = petsc;
  solver->threads = threads;
  solver->tolerance = solver->aimed = tolerance;
  return set_options(solver);
}

static Status create_amg(void **self, int threads, double tolerance) {
  return create(BOOMER, self, threads, tolerance);
}
static Status create_gamg(void **self, int threads, double tolerance) {
  return create(GAMG, self, threads, tolerance);
}

// Rows of the vertices that have unknowns; whether they are those of the last analysis.
static bool number_rows(PetscSolver *solver, const FemMatrix *pattern, int *place, double *rest) {
  int row = 0, unknown = 0;
  bool is_same = solver->place && solver->size == pattern->size;
  for (int v = 0; v < pattern->vertex_count; v++) {
    int before = unknown;
    for (int c = 0; c < 3; c++) {
      if (pattern->unknown_of_dof[3 * v + c] < 0) continue;
      place[unknown] = row + c;
      is_same = is_same && solver->place[unknown] == row + c;
      unknown++;
    }
    if (unknown == before) continue;
    for (int c = 0; c < 3 && pattern->rest; c++) rest[row + c] = pattern->rest[3 * v + c];
    row += 3;
  }
  is_same = is_same && solver->row_count == row;
  solver->row_count = row;
  return is_same;
}

static Status make_vectors(PetscSolver *solver) {
  const FemPetscLibrary *petsc = solver->petsc;
  size_t rows = (size_t)solver->row_count;
  solver->right = memory_zeroed(rows, sizeof *solver->right);
  solver->left = memory_zeroed(rows, sizeof *solver->left);
  if (!solver->right || !solver->left) return status_no_memory("the solver amg");
  TRY(fem_cg_create(&solver->cg, solver->size));
  PETSC_TRY("a vector", petsc->VecCreateSeqWithArray(petsc->self, 3, solver->row_count, solver->right,
                                                     &solver->right_vec));
  PETSC_TRY("a vector",
            petsc->VecCreateSeqWithArray(petsc->self, 3, solver->row_count, solver->left, &solver->left_vec));
  return STATUS_OK;
}

// Another pattern over the same unknowns leaves the hierarchy be.
static Status analyse_rows(PetscSolver *solver, const FemMatrix *pattern) {
  int *place = memory_zeroed((size_t)pattern->size, sizeof *place);
  double *rest = memory_zeroed(3 * (size_t)pattern->size, sizeof *rest);
  if (!place || !rest) {
    memory_free(place), memory_free(rest);
    return status_no_memory("the solver amg");
  }
  if (number_rows(solver, pattern, place, rest)) {
    memory_free(place), memory_free(rest);
    return STATUS_OK;
  }
  int rows = solver->row_count;
  forget(solver);
  solver->row_count = rows;
  solver->size = pattern->size;
  solver->place = place;
  solver->rest = rest;
  if (!pattern->rest) memory_free(solver->rest), solver->rest = NULL;
  Status status = make_vectors(solver);
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

// How many entries each row has, then where it begins. Rows that no unknown has: one.
static void count_entries(const PetscSolver *solver, const FemMatrix *matrix, int *begin) {
  for (int u = 0; u < matrix->size; u++)
    for (int k = matrix->col_begin[u]; k < matrix->col_begin[u + 1]; k++) {
      begin[solver->place[u] + 1]++;
      if (matrix->row[k] != u) begin[solver->place[matrix->row[k]] + 1]++;
    }
  for (int r = 0; r < solver->row_count; r++) begin[r + 1] = begin[r] + (begin[r + 1] ? begin[r + 1] : 1);
}

// Columns come in ascending order, so a row is filled from left to right: what is below the diagonal of
// earlier columns, then its own. `begin` is pushed on by a row, and moved back at the end.
static void fill_entries(const PetscSolver *solver, const FemMatrix *matrix, Rows *rows) {
  int *next = rows->begin;
  for (int u = 0, row = 0; u <= matrix->size; u++) {
    int own = u < matrix->size ? solver->place[u] : solver->row_count;
    for (; row < own; row++) { // prescribed ones: as stiff as a neighbour
      int of = u > 0 ? u - 1 : u;
      rows->column[next[row]] = row;
      rows->value[next[row]++] = matrix->value[matrix->col_begin[of]];
    }
    if (u == matrix->size) break;
    row++;
    for (int k = matrix->col_begin[u]; k < matrix->col_begin[u + 1]; k++) {
      int other = solver->place[matrix->row[k]];
      rows->column[next[own]] = other;
      rows->value[next[own]++] = matrix->value[k];
      if (other == own) continue;
      rows->column[next[other]] = own;
      rows->value[next[other]++] = matrix->value[k];
    }
  }
  for (int r = rows->count; r > 0; r--) next[r] = next[r - 1];
  next[0] = 0;
}

static Status make_rows(const PetscSolver *solver, const FemMatrix *matrix, Rows *rows) {
  size_t most = 2 * (size_t)matrix->entry_count + (size_t)solver->row_count;
  if (most > INT_MAX)
    return status_fail(STATUS_SOLVER, "%s: the matrix has more entries than can be numbered",
                       names[solver->kind]);
  rows->count = solver->row_count;
  rows->begin = memory_zeroed((size_t)rows->count + 1, sizeof *rows->begin);
  if (!rows->begin) return status_no_memory("the multigrid's matrix");
  count_entries(solver, matrix, rows->begin);
  size_t entries = (size_t)rows->begin[rows->count];
  rows->column = memory_zeroed(entries, sizeof *rows->column);
  rows->value = memory_zeroed(entries, sizeof *rows->value);
  if (!rows->column || !rows->value) return status_no_memory("the multigrid's matrix");
  fill_entries(solver, matrix, rows);
  return STATUS_OK;
}

static Status wrap_rows(PetscSolver *solver, const Rows *rows, Mat *matrix) {
  const FemPetscLibrary *petsc = solver->petsc;
  PETSC_TRY("the matrix", petsc->MatCreateSeqAIJWithArrays(petsc->self, rows->count, rows->count, rows->begin,
                                                           rows->column, rows->value, matrix));
  PETSC_TRY("the matrix", petsc->MatSetBlockSize(*matrix, 3));
  PETSC_TRY("the matrix", petsc->MatSetOption(*matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PETSC_TRY("the matrix", petsc->MatSetOption(*matrix, MAT_SPD, PETSC_TRUE));
  return STATUS_OK;
}

static Status set_up(PetscSolver *solver, Mat matrix) {
  const FemPetscLibrary *petsc = solver->petsc;
  PETSC_TRY("the multigrid", petsc->PCCreate(petsc->self, &solver->multigrid));
  PETSC_TRY("the multigrid", petsc->PCSetOptionsPrefix(solver->multigrid, prefixes[solver->kind]));
  PETSC_TRY("the multigrid", petsc->PCSetType(solver->multigrid, solver->kind == BOOMER ? PCHYPRE : PCGAMG));
  PETSC_TRY("the multigrid", petsc->PCSetOperators(solver->multigrid, matrix, matrix));
  PETSC_TRY("the multigrid", petsc->PCSetFromOptions(solver->multigrid));
  if (solver->kind == GAMG && solver->rest)
    PETSC_TRY("the multigrid",
              petsc->PCSetCoordinates(solver->multigrid, 3, solver->row_count / 3, solver->rest));
  PETSC_TRY("the multigrid", petsc->PCSetUp(solver->multigrid));
  return STATUS_OK;
}

// hypre has a matrix of its own.
static Status convert(PetscSolver *solver, const Rows *rows, Mat *converted) {
  const FemPetscLibrary *petsc = solver->petsc;
  Mat own = NULL;
  Status status = wrap_rows(solver, rows, &own);
  if (!status) {
    PetscErrorCode code = petsc->MatConvert(own, MATHYPRE, MAT_INITIAL_MATRIX, converted);
    if (code) status = fail_in(solver, "the matrix", code);
  }
  if (own) petsc->MatDestroy(&own);
  return status;
}

static Status coarsen(PetscSolver *solver, const Rows *rows) {
  Mat converted = NULL;
  TRY(convert(solver, rows, &converted));
  Status status = STATUS_OK;
  PetscErrorCode code = solver->petsc->MatSetBlockSize(converted, 3);
  if (code) status = fail_in(solver, "the matrix", code);
  if (!status) status = set_up(solver, converted);
  solver->petsc->MatDestroy(&converted); // the multigrid has it
  return status;
}

// The hierarchy is hypre's, the work with it our own, so hypre's copies go.
static Status build_boomer(PetscSolver *solver, const FemMatrix *matrix) {
  Rows rows = {0};
  PetscErrorCode code = 0;
  forget_multigrid(solver);
  Status status = make_rows(solver, matrix, &rows);
  if (!status) status = coarsen(solver, &rows);
  FemRows finest = {rows.count, rows.count, rows.begin, rows.column, rows.value};
  if (!status) status = fem_hierarchy_take(solver->petsc, solver->multigrid, &finest, &solver->cycle, &code);
  if (code) status = fail_in(solver, "the multigrid", code);
  if (solver->multigrid) solver->petsc->PCDestroy(&solver->multigrid);
  solver->multigrid = NULL;
  free_rows(&rows);
  return status;
}

static Status build_gamg(PetscSolver *solver, const FemMatrix *matrix) {
  forget_multigrid(solver);
  TRY(make_rows(solver, matrix, &solver->rows));
  TRY(wrap_rows(solver, &solver->rows, &solver->matrix));
  return set_up(solver, solver->matrix);
}

// A new hierarchy, by one thread of the BLAS in it.
static Status build(PetscSolver *solver, const FemMatrix *matrix) {
  fem_wear_renew(&solver->wear);
  int before = fem_solver_use_threads(1);
  Status status = solver->kind == BOOMER ? build_boomer(solver, matrix) : build_gamg(solver, matrix);
  fem_solver_use_threads(before);
  if (status)
    forget_multigrid(solver);
  else
    solver->stats.hierarchies++;
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
  if ((solver->multigrid || solver->cycle.levels) && !solver->wear.is_worn) return STATUS_OK;
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
    return status_fail(STATUS_SOLVER, "%s: this layout of the matrix has not been analysed",
                       names[solver->kind]);
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

static Status apply_gamg(PetscSolver *solver) {
  double *right; // PETSc is informed that its numbers have changed
  PETSC_TRY("a vector", solver->petsc->VecGetArray(solver->right_vec, &right));
  PETSC_TRY("a vector", solver->petsc->VecRestoreArray(solver->right_vec, &right));
  PETSC_TRY("the multigrid", solver->petsc->PCApply(solver->multigrid, solver->right_vec, solver->left_vec));
  return STATUS_OK;
}

static Status precondition(void *self, const double *r, double *z) {
  PetscSolver *solver = self;
#pragma omp parallel for schedule(static) if (solver->size > FEM_VECTOR_LONG)
  for (int u = 0; u < solver->size; u++) solver->right[solver->place[u]] = r[u];
  if (solver->kind == BOOMER)
    fem_cycle_apply(&solver->cycle, solver->right, solver->left);
  else
    TRY(apply_gamg(solver));
#pragma omp parallel for schedule(static) if (solver->size > FEM_VECTOR_LONG)
  for (int u = 0; u < solver->size; u++) z[u] = solver->left[solver->place[u]];
  return STATUS_OK;
}

static Status iterate(PetscSolver *solver, const double *b, double *x, int limit, FemCgEnd *end) {
  FemCgProblem problem = {.matrix = solver->current,
                          .precondition = precondition,
                          .self = solver,
                          .name = names[solver->kind],
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
  if (!solver->current) return status_fail(STATUS_SOLVER, "%s: no matrix to solve with", names[solver->kind]);
  double began = clock_wall_s(), factorised_s = solver->stats.factorise_s;
  int before = fem_solver_use_threads(solver->threads);
  Status status = solve_by(solver, b, x);
  fem_solver_use_threads(before);
  solver->stats.solves++;
  solver->stats.solve_s += clock_wall_s() - began - (solver->stats.factorise_s - factorised_s);
  if (!status && !fem_vector_is_finite(solver->size, x))
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

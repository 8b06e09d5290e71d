// SPDX-License-Identifier: GPL-3.0-or-later
// Every rank has added its share to a matrix over all unknowns (fem/sparse/share.h). Here the shares meet: a
// rank has the rows of its vertices; what it adds to rows of others, which is what vertices at the border
// share, all ranks get and the rows' owners take. Right sides and solutions are whole on every rank.
//
// Rows are numbered rank by rank, three to a vertex that has unknowns, as multigrid wants them; prescribed
// coordinates among these stand alone. A preconditioner is kept for new numbers while iterations stay near
// what they were when it was new (as in fem/sparse/solver_petsc.c).
#include "dist/solver.h"

#include <limits.h>
#include <petscksp.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/ranks.h"

typedef enum Kind { BOOMER, GAMG, MUMPS, BLOCKS, KIND_COUNT } Kind;
static const char *const names[] = {"amg", "gamg", "mumps", "block_jacobi"};
static const char *const prefixes[] = {"tetlap_amg_", "tetlap_gamg_", "tetlap_mumps_", "tetlap_blocks_"};

// Iterations before what is kept is made anew at once, and before what is new gives up.
enum { LIMIT_KEPT = 60, LIMIT = 2000 };
// Worn: iterations are more than this share beyond those of when it was new, and some.
static const double WORN_SHARE = 1.5;
enum { WORN_MORE = 2 };

typedef struct Place {
  int row, column;
} Place;

// Where a given value is from, and where it goes.
typedef struct Taken {
  int from, slot;
} Taken;

typedef struct DistSolver {
  Kind kind;
  double tolerance;
  int size, row_count;     // unknowns; rows of all ranks
  int *begin;              // of each rank's rows                              (ranks + 1)
  int *row;                // of each unknown                                  (size)
  int *unknowns;           // of each coordinate, as they were numbered here   (3·vertex_count)
  int *own;                // unknowns of this rank                            (own_count)
  int own_count;           //
  int *alone, alone_count; // rows of this rank that no unknown has
  double *rest;            // of its vertices [m]; NULL: not known             (own rows)
  double *all;             // by rows                                          (row_count)
  bool *is_touched;        // vertices to which this rank may add
  Mat matrix;
  Vec right, left;
  KSP ksp;
  int first, end;       // rows of this rank
  int *row_begin;       // of each of them in `values`                       (end − first + 2)
  int *column;          // while they are laid out
  double *values;       // as PETSc is given them
  int *slots;           // in `values`, of own entries for own rows, as they are walked
  int *alone_slots;     // of `alone`                                        (own rows)
  int *given_begin;     // of each rank's entries for rows of others         (ranks + 1)
  Place *given;         // those of all ranks, while they are laid out
  double *given_values; //                                                   (given_begin[ranks])
  Taken *taken;         // those for rows of this rank                       (taken_count)
  int taken_count;
  int given_at, slot_at; // of a walk
  bool has_rows;         // the numbering stands
  bool has_matrix;       // numbers are there
  bool is_worn, is_fresh;
  long long new_count; // iterations of its first solve
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

// As of one process (fem/sparse/solver_petsc.c), but for the sweeps: across ranks those of Gauss and Seidel
// need not converge, and with l1 they do (Baker, Falgout, Kolev and Yang 2011); one forward down and one
// backward up is symmetric.
static void set_options(void) {
  static const char *const options[][2] = {
      {"-tetlap_amg_pc_type", "hypre"},
      {"-tetlap_amg_pc_hypre_type", "boomeramg"},
      {"-tetlap_amg_pc_hypre_boomeramg_coarsen_type", "HMIS"},
      {"-tetlap_amg_pc_hypre_boomeramg_interp_type", "ext+i"},
      {"-tetlap_amg_pc_hypre_boomeramg_P_max", "4"},
      {"-tetlap_amg_pc_hypre_boomeramg_strong_threshold", "0.5"},
      {"-tetlap_amg_pc_hypre_boomeramg_agg_nl", "1"},
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
  *solver = (DistSolver){.kind = kind, .tolerance = tolerance};
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

static void forget_matrix(DistSolver *solver) {
  MatDestroy(&solver->matrix);
  memory_free(solver->row_begin), memory_free(solver->column), memory_free(solver->values);
  memory_free(solver->slots), memory_free(solver->given_begin), memory_free(solver->given);
  memory_free(solver->given_values), memory_free(solver->taken);
  solver->row_begin = solver->column = solver->slots = solver->given_begin = NULL;
  solver->values = solver->given_values = NULL;
  solver->given = NULL;
  solver->taken = NULL;
  solver->has_matrix = false;
}

static void forget(DistSolver *solver) {
  KSPDestroy(&solver->ksp);
  forget_matrix(solver);
  VecDestroy(&solver->right);
  VecDestroy(&solver->left);
  memory_free(solver->begin), memory_free(solver->row), memory_free(solver->own);
  memory_free(solver->alone), memory_free(solver->rest), memory_free(solver->all);
  memory_free(solver->is_touched), memory_free(solver->unknowns), memory_free(solver->alone_slots);
  solver->begin = solver->row = solver->own = solver->alone = NULL;
  solver->rest = solver->all = NULL;
  solver->is_touched = NULL;
  solver->unknowns = solver->alone_slots = NULL;
  solver->has_rows = false;
}

static void destroy(void *self) {
  if (!self) return;
  if (is_ready) forget(self);
  memory_free(self);
}

static void wear(void *self) {
  ((DistSolver *)self)->is_worn = true;
}

static bool has_unknowns(const FemMatrix *pattern, int vertex) {
  const int *unknown = pattern->unknown_of_dof + 3 * (size_t)vertex;
  return unknown[0] >= 0 || unknown[1] >= 0 || unknown[2] >= 0;
}

// The rows of one vertex, which begin at `row`.
static void number_vertex(DistSolver *solver, const FemMatrix *pattern, int vertex, int row) {
  bool is_own = pattern->share->owner[vertex] == pattern->share->rank;
  int first = solver->begin[pattern->share->rank];
  for (int c = 0; c < 3; c++) {
    int unknown = pattern->unknown_of_dof[3 * (size_t)vertex + (size_t)c];
    if (unknown >= 0) solver->row[unknown] = row + c;
    if (!is_own) continue;
    if (pattern->rest) solver->rest[row + c - first] = pattern->rest[3 * (size_t)vertex + (size_t)c];
    if (unknown >= 0)
      solver->own[solver->own_count++] = unknown;
    else
      solver->alone[solver->alone_count++] = row + c;
  }
}

static Status reserve(DistSolver *solver, const FemMatrix *pattern) {
  solver->unknowns =
      memory_copy(pattern->unknown_of_dof, 3 * (size_t)pattern->vertex_count, sizeof *solver->unknowns);
  solver->begin = memory_zeroed((size_t)pattern->share->rank_count + 1, sizeof *solver->begin);
  solver->row = memory_zeroed((size_t)pattern->size, sizeof *solver->row);
  solver->is_touched = memory_zeroed((size_t)pattern->vertex_count, sizeof *solver->is_touched);
  if (!solver->unknowns || !solver->begin || !solver->row || !solver->is_touched)
    return status_no_memory("the condensed system");
  for (int v = 0; v < pattern->vertex_count; v++)
    if (has_unknowns(pattern, v)) solver->begin[pattern->share->owner[v] + 1] += 3;
  size_t own = (size_t)solver->begin[pattern->share->rank + 1];
  for (int r = 0; r < pattern->share->rank_count; r++) solver->begin[r + 1] += solver->begin[r];
  solver->row_count = solver->begin[pattern->share->rank_count];
  solver->first = solver->begin[pattern->share->rank];
  solver->end = solver->begin[pattern->share->rank + 1];
  solver->own = memory_zeroed(own, sizeof *solver->own);
  solver->alone = memory_zeroed(own, sizeof *solver->alone);
  solver->alone_slots = memory_zeroed(own, sizeof *solver->alone_slots);
  solver->rest = memory_zeroed(own, sizeof *solver->rest);
  solver->all = memory_zeroed((size_t)solver->row_count, sizeof *solver->all);
  bool is_ok = solver->own && solver->alone && solver->alone_slots && solver->rest && solver->all;
  return is_ok ? STATUS_OK : status_no_memory("the condensed system");
}

static Status number_rows(DistSolver *solver, const FemMatrix *pattern) {
  solver->size = pattern->size;
  solver->own_count = solver->alone_count = 0;
  TRY(ranks()->worst(reserve(solver, pattern)));
  int *next = memory_copy(solver->begin, (size_t)pattern->share->rank_count, sizeof *next);
  TRY(ranks()->worst(next ? STATUS_OK : status_no_memory("the condensed system")));
  for (int v = 0; v < pattern->vertex_count; v++) {
    if (!has_unknowns(pattern, v)) continue;
    number_vertex(solver, pattern, v, next[pattern->share->owner[v]]);
    next[pattern->share->owner[v]] += 3;
  }
  memory_free(next);
  int rows = solver->begin[pattern->share->rank + 1] - solver->begin[pattern->share->rank];
  PETSC("a vector", VecCreateMPI(PETSC_COMM_WORLD, rows, solver->row_count, &solver->right));
  PETSC("a vector", VecSetBlockSize(solver->right, 3));
  PETSC("a vector", VecDuplicate(solver->right, &solver->left));
  solver->has_rows = true;
  return STATUS_OK;
}

// Whether the unknowns are those of the last analysis.
static bool has_same_rows(const DistSolver *solver, const FemMatrix *pattern) {
  size_t bytes = 3 * (size_t)pattern->vertex_count * sizeof *solver->unknowns;
  return solver->has_rows && solver->size == pattern->size &&
         memcmp(solver->unknowns, pattern->unknown_of_dof, bytes) == 0;
}

// Vertices that are this rank's, or that a clique of its own has: to others it adds nothing.
static void find_touched(DistSolver *solver, const FemMatrix *matrix) {
  const FemShare *share = matrix->share;
  int *vertex_of = (int *)solver->all; // scratch                                             (size)
  for (int v = 0; v < matrix->vertex_count; v++) {
    solver->is_touched[v] = share->owner[v] == share->rank;
    for (int c = 0; c < 3; c++) {
      int unknown = matrix->unknown_of_dof[3 * (size_t)v + (size_t)c];
      if (unknown >= 0) vertex_of[unknown] = v;
    }
  }
  for (int u = 0; u < matrix->size; u++)
    for (int k = matrix->col_begin[u]; k < matrix->col_begin[u + 1]; k++)
      if (vertex_of[matrix->row[k]] != vertex_of[u])
        solver->is_touched[vertex_of[u]] = solver->is_touched[vertex_of[matrix->row[k]]] = true;
}

// What is done with an entry of the whole matrix that this rank adds to.
typedef void Visit(DistSolver *solver, int row, int column, double value);

// Each entry of the lower triangle that this rank may add to, and its mirror image.
static void walk(DistSolver *solver, const FemMatrix *matrix, Visit *visit) {
  solver->given_at = solver->given_begin[ranks()->number];
  solver->slot_at = 0;
  for (int v = 0; v < matrix->vertex_count; v++) {
    if (!solver->is_touched[v]) continue;
    for (int c = 0; c < 3; c++) {
      int u = matrix->unknown_of_dof[3 * (size_t)v + (size_t)c];
      if (u < 0) continue;
      for (int k = matrix->col_begin[u]; k < matrix->col_begin[u + 1]; k++) {
        int row = solver->row[matrix->row[k]], column = solver->row[u];
        visit(solver, row, column, matrix->value[k]);
        if (row != column) visit(solver, column, row, matrix->value[k]);
      }
    }
  }
}

static bool is_own(const DistSolver *solver, int row) {
  return row >= solver->first && row < solver->end;
}

// Counts stand two places behind a row, so that sums of them end one behind, where rows are filled from.
static void count_entry(DistSolver *solver, int row, int column, double value) {
  (void)column, (void)value;
  if (is_own(solver, row))
    solver->row_begin[row - solver->first + 2]++, solver->slot_at++;
  else
    solver->given_at++;
}

static void give_place(DistSolver *solver, int row, int column, double value) {
  (void)value;
  if (!is_own(solver, row)) solver->given[solver->given_at++] = (Place){row, column};
}

static void list_entry(DistSolver *solver, int row, int column, double value) {
  (void)value;
  if (is_own(solver, row)) solver->column[solver->row_begin[row - solver->first + 1]++] = column;
}

static int find_slot(const DistSolver *solver, int row, int column) {
  int low = solver->row_begin[row - solver->first], high = solver->row_begin[row - solver->first + 1] - 1;
  while (low < high) {
    int middle = low + (high - low) / 2;
    if (solver->column[middle] < column)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static void place_entry(DistSolver *solver, int row, int column, double value) {
  (void)value;
  if (is_own(solver, row)) solver->slots[solver->slot_at++] = find_slot(solver, row, column);
}

static void add_entry(DistSolver *solver, int row, int column, double value) {
  (void)column;
  if (is_own(solver, row))
    solver->values[solver->slots[solver->slot_at++]] += value;
  else
    solver->given_values[solver->given_at++] = value;
}

static Status agree(bool is_ok) {
  return ranks()->worst(is_ok ? STATUS_OK : status_no_memory("the condensed matrix"));
}

// How many entries ranks have for rows of others, and where each rank's begin among all of these.
static Status count_entries(DistSolver *solver, const FemMatrix *pattern, int *own_count) {
  int rank_count = pattern->share->rank_count;
  double *counts = memory_zeroed((size_t)rank_count, sizeof *counts);
  solver->given_begin = memory_zeroed((size_t)rank_count + 1, sizeof *solver->given_begin);
  solver->row_begin = memory_zeroed((size_t)(solver->end - solver->first) + 2, sizeof *solver->row_begin);
  Status status = agree(counts && solver->given_begin && solver->row_begin);
  if (!status) {
    walk(solver, pattern, count_entry);
    *own_count = solver->slot_at;
    counts[ranks()->number] = solver->given_at;
    ranks()->sum(counts, (size_t)rank_count);
    for (int r = 0; r < rank_count; r++) solver->given_begin[r + 1] = solver->given_begin[r] + (int)counts[r];
  }
  memory_free(counts);
  return status;
}

// Places of the entries that ranks have for rows of others: all of them on each, for they are few.
static Status exchange_places(DistSolver *solver, const FemMatrix *pattern) {
  size_t all = (size_t)solver->given_begin[pattern->share->rank_count];
  solver->given = memory_zeroed(all, sizeof *solver->given);
  solver->given_values = memory_zeroed(all, sizeof *solver->given_values);
  solver->taken = memory_zeroed(all, sizeof *solver->taken);
  TRY(agree(solver->given && solver->given_values && solver->taken));
  walk(solver, pattern, give_place);
  ranks()->join(solver->given, sizeof *solver->given, solver->given_begin);
  solver->taken_count = 0;
  for (int g = 0; g < (int)all; g++) {
    if (!is_own(solver, solver->given[g].row)) continue;
    solver->taken[solver->taken_count++].from = g;
    solver->row_begin[solver->given[g].row - solver->first + 2]++;
  }
  return STATUS_OK;
}

static int compare_ints(const void *a, const void *b) {
  int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

// Each row ascending, every column once.
static void sort_rows(DistSolver *solver) {
  int to = 0, from = 0, *column = solver->column;
  for (int row = 0; row < solver->end - solver->first; row++) {
    int end = solver->row_begin[row + 1], first = to;
    qsort(column + from, (size_t)(end - from), sizeof *column, compare_ints);
    for (; from < end; from++)
      if (to == first || column[from] != column[to - 1]) column[to++] = column[from];
    solver->row_begin[row + 1] = to;
  }
}

// This rank's rows: of its own entries, of those that it is given, and of coordinates that stand alone.
static Status list_rows(DistSolver *solver, const FemMatrix *pattern, int own_count) {
  size_t most = (size_t)own_count + (size_t)solver->taken_count + (size_t)solver->alone_count;
  if (most > INT_MAX) return agree(false); // more than can be numbered
  int row_count = solver->end - solver->first, *begin = solver->row_begin;
  solver->column = memory_zeroed(most, sizeof *solver->column);
  solver->slots = memory_zeroed((size_t)own_count, sizeof *solver->slots);
  TRY(agree(solver->column && solver->slots));
  for (int k = 0; k < solver->alone_count; k++) begin[solver->alone[k] - solver->first + 2]++;
  for (int row = 0; row < row_count; row++) begin[row + 2] += begin[row + 1];
  walk(solver, pattern, list_entry);
  for (int k = 0; k < solver->taken_count; k++) {
    Place place = solver->given[solver->taken[k].from];
    solver->column[begin[place.row - solver->first + 1]++] = place.column;
  }
  for (int k = 0; k < solver->alone_count; k++)
    solver->column[begin[solver->alone[k] - solver->first + 1]++] = solver->alone[k];
  sort_rows(solver);
  walk(solver, pattern, place_entry);
  for (int k = 0; k < solver->taken_count; k++) {
    Place place = solver->given[solver->taken[k].from];
    solver->taken[k].slot = find_slot(solver, place.row, place.column);
  }
  for (int k = 0; k < solver->alone_count; k++)
    solver->alone_slots[k] = find_slot(solver, solver->alone[k], solver->alone[k]);
  return STATUS_OK;
}

// As stiff as a neighbour.
static double stiffness_alone(const DistSolver *solver, const FemMatrix *matrix) {
  double value = solver->own_count > 0 ? matrix->value[matrix->col_begin[solver->own[0]]] : 1;
  return value > 0 ? value : 1;
}

static Status lay_out(DistSolver *solver, const FemMatrix *pattern) {
  int row_count = solver->end - solver->first, own_count = 0;
  find_touched(solver, pattern);
  TRY(count_entries(solver, pattern, &own_count));
  TRY(exchange_places(solver, pattern));
  TRY(list_rows(solver, pattern, own_count));
  solver->values = memory_zeroed((size_t)solver->row_begin[row_count], sizeof *solver->values);
  TRY(agree(solver->values));
  PETSC("the matrix", MatCreateMPIAIJWithArrays(PETSC_COMM_WORLD, row_count, row_count, solver->row_count,
                                                solver->row_count, solver->row_begin, solver->column,
                                                solver->values, &solver->matrix));
  PETSC("the matrix", MatSetBlockSize(solver->matrix, 3));
  PETSC("the matrix", MatSetOption(solver->matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PETSC("the matrix", MatSetOption(solver->matrix, MAT_SPD, PETSC_TRUE));
  memory_free(solver->column), memory_free(solver->given);
  solver->column = NULL, solver->given = NULL;
  return STATUS_OK;
}

static Status make_ksp(DistSolver *solver) {
  PC pc;
  PETSC("the solver", KSPCreate(PETSC_COMM_WORLD, &solver->ksp));
  PETSC("the solver", KSPSetOptionsPrefix(solver->ksp, prefixes[solver->kind]));
  PETSC("the solver", KSPSetType(solver->ksp, solver->kind == MUMPS ? KSPPREONLY : KSPCG));
  if (solver->kind != MUMPS) PETSC("the solver", KSPSetNormType(solver->ksp, KSP_NORM_NATURAL));
  PETSC("the solver", KSPSetOperators(solver->ksp, solver->matrix, solver->matrix));
  PETSC("the solver", KSPSetFromOptions(solver->ksp));
  PETSC("the solver", KSPGetPC(solver->ksp, &pc));
  int rows = solver->begin[ranks()->number + 1] - solver->begin[ranks()->number];
  if (solver->kind == GAMG) PETSC("the multigrid", PCSetCoordinates(pc, 3, rows / 3, solver->rest));
  solver->is_worn = true;
  return STATUS_OK;
}

static Status analyse_layout(DistSolver *solver, const FemMatrix *pattern) {
  if (!has_same_rows(solver, pattern)) {
    forget(solver);
    TRY(number_rows(solver, pattern));
  }
  forget_matrix(solver);
  TRY(lay_out(solver, pattern));
  if (!solver->ksp) return make_ksp(solver);
  PETSC("the solver", KSPSetOperators(solver->ksp, solver->matrix, solver->matrix));
  // A factor is of one pattern.
  if (solver->kind == MUMPS || solver->kind == BLOCKS) solver->is_worn = true;
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

static Status set_up(DistSolver *solver) {
  bool is_kept = !solver->is_worn && solver->kind != MUMPS;
  PC pc;
  PCFailedReason reason;
  PETSC("the solver", KSPSetReusePreconditioner(solver->ksp, is_kept ? PETSC_TRUE : PETSC_FALSE));
  // Told anew of its matrix, KSPSetUp looks at it; else the first application would, and find what is wrong.
  PETSC("the solver", KSPSetOperators(solver->ksp, solver->matrix, solver->matrix));
  PETSC("the solver", KSPSetUp(solver->ksp));
  PETSC("the solver", KSPGetPC(solver->ksp, &pc));
  PETSC("the solver", PCGetFailedReasonRank(pc, &reason));
  if (is_kept) return STATUS_OK;
  solver->is_worn = false;
  solver->is_fresh = true;
  if (reason == PC_NOERROR && !(solver->kind == MUMPS && has_negative_pivots(solver, pc))) return STATUS_OK;
  if (reason == PC_FACTOR_OUTMEMORY) return status_no_memory("the factor of the condensed system");
  return status_fail(STATUS_RETRY, "the condensed matrix is not positive definite (found by %s)",
                     names[solver->kind]);
}

// Σ of the shares, each in its row's place.
static void add_shares(DistSolver *solver, const FemMatrix *matrix) {
  double alone = stiffness_alone(solver, matrix);
  memset(solver->values, 0, (size_t)solver->row_begin[solver->end - solver->first] * sizeof(double));
  walk(solver, matrix, add_entry);
  ranks()->join(solver->given_values, sizeof *solver->given_values, solver->given_begin);
  for (int k = 0; k < solver->taken_count; k++)
    solver->values[solver->taken[k].slot] += solver->given_values[solver->taken[k].from];
  for (int k = 0; k < solver->alone_count; k++) solver->values[solver->alone_slots[k]] = alone;
}

static Status assemble(DistSolver *solver, const FemMatrix *matrix) {
  double least;
  bool is_finite = fem_solver_is_finite(matrix->value, matrix->entry_count);
  TRY(ranks()->worst(is_finite ? STATUS_OK
                               : status_fail(STATUS_RETRY, "the condensed matrix is not finite")));
  add_shares(solver, matrix);
  PETSC("the matrix", MatUpdateMPIAIJWithArray(solver->matrix, solver->values));
  PETSC("the matrix", MatGetDiagonal(solver->matrix, solver->left));
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
  Status status = assemble(solver, stiffness);
  if (!status) status = set_up(solver);
  status = ranks()->worst(status);
  solver->has_matrix = status == STATUS_OK;
  if (status) solver->is_worn = true;
  *(status ? &solver->stats.failed_factorisations : &solver->stats.factorisations) += 1;
  solver->stats.factorise_s += clock_wall_s() - began;
  return status;
}

static Status take_right(DistSolver *solver, const double *b) {
  double *right;
  int first = solver->begin[ranks()->number];
  PETSC("a vector", VecSet(solver->right, 0));
  PETSC("a vector", VecGetArray(solver->right, &right));
  for (int k = 0; k < solver->own_count; k++) right[solver->row[solver->own[k]] - first] = b[solver->own[k]];
  PETSC("a vector", VecRestoreArray(solver->right, &right));
  return STATUS_OK;
}

static Status give_left(DistSolver *solver, double *x) {
  const double *left;
  int first = solver->begin[ranks()->number], end = solver->begin[ranks()->number + 1];
  PETSC("a vector", VecGetArrayRead(solver->left, &left));
  for (int row = first; row < end; row++) solver->all[row] = left[row - first];
  PETSC("a vector", VecRestoreArrayRead(solver->left, &left));
  ranks()->join(solver->all, sizeof *solver->all, solver->begin);
  for (int u = 0; u < solver->size; u++) x[u] = solver->all[solver->row[u]];
  return STATUS_OK;
}

// *is_limit: it only took too long.
static Status iterate(DistSolver *solver, int limit, bool *is_limit) {
  static const double DIVERGED = 1e30, SMALLEST = 1e-290;
  KSPConvergedReason reason;
  PetscInt taken;
  PETSC("the solver", KSPSetTolerances(solver->ksp, solver->tolerance, SMALLEST, DIVERGED, limit));
  PETSC("the solver", KSPSolve(solver->ksp, solver->right, solver->left));
  PETSC("the solver", KSPGetConvergedReason(solver->ksp, &reason));
  PETSC("the solver", KSPGetIterationNumber(solver->ksp, &taken));
  solver->stats.iterations += solver->kind == MUMPS ? 0 : taken;
  *is_limit = reason == KSP_DIVERGED_ITS;
  if (solver->is_fresh) solver->new_count = taken;
  solver->is_fresh = false;
  solver->is_worn = (double)taken > WORN_SHARE * (double)solver->new_count + WORN_MORE;
  if (reason > 0) return STATUS_OK;
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
  bool was_fresh = solver->is_fresh, is_limit;
  Status status = iterate(solver, was_fresh ? LIMIT : LIMIT_KEPT, &is_limit);
  if (status != STATUS_RETRY || was_fresh || solver->kind == MUMPS) return status;
  solver->is_worn = true;
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
  if (!status && !fem_solver_is_finite(x, solver->size))
    return status_fail(STATUS_RETRY, "the solution of the condensed system is not finite");
  return status;
}

static const FemSolverStats *stats(const void *self) {
  return &((const DistSolver *)self)->stats;
}

#define DIST_SOLVER(kind, words, create_one, share)                                                          \
  {                                                                                                          \
    .name = kind, .help = words, .is_condensed = true, .tolerance = share, .create = create_one,             \
    .analyse = analyse, .factorise = factorise, .solve = solve, .forget = wear, .destroy = destroy,          \
    .stats = stats                                                                                           \
  }

static const FemSolverOps amg = DIST_SOLVER("amg", "over ranks: BoomerAMG of hypre", create_amg, 1e-4),
                          gamg = DIST_SOLVER("gamg", "over ranks: GAMG of PETSc", create_gamg, 1e-4),
                          mumps = DIST_SOLVER("mumps", "over ranks: an exact factor", create_mumps, 0),
                          blocks = DIST_SOLVER("block_jacobi", "over ranks: ICC(0) of each rank's block",
                                               create_blocks, 1e-8);

static const FemSolverOps *const table[FEM_SOLVER_COUNT] = {[FEM_SOLVER_CHOLMOD] = &mumps,
                                                            [FEM_SOLVER_PCG] = &blocks,
                                                            [FEM_SOLVER_AMG] = &amg,
                                                            [FEM_SOLVER_GAMG] = &gamg};

void dist_solver_provide(void) {
  fem_solver_provide(table);
}

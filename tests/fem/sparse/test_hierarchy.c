// SPDX-License-Identifier: GPL-3.0-or-later
// Hierarchies of multigrid: how long one is kept while the matrix moves on, and that no answer shows it.
#include "bar.h"

#include "fem/sparse/petsc/hierarchy.h"

// S = K + c D + c² M, its set-up and a solution.
static void solve_shifted(const FemSolverOps *ops, void *solver, Bar *bar, double c, const double *b,
                          double *x) {
  for (int i = 0; i < bar->S.entry_count; i++) bar->S.value[i] = bar->K.value[i] + c * bar->D.value[i];
  fem_matrix_add_mass(&bar->S, bar->mass, c * c);
  ck_assert_ok(ops->factorise(solver, &bar->S, NULL, NULL, c));
  ck_assert_ok(ops->solve(solver, b, x));
}

// The matrix moves on, ever further: the answer is that of the newest, whenever the hierarchy was made. From
// one to the next c is a tenth larger, so most bear that it is kept; over all it grows by a factor of 1,000,
// and then falls at once, where the one that is kept does not do.
START_TEST(a_hierarchy_that_is_kept_never_touches_the_answer) {
  Bar bar = bar_create(20, 1);
  int n = bar.unknown_count;
  double *b = random_vector(n, 5), *x = memory_zeroed((size_t)n, sizeof *x),
         *Sx = memory_zeroed((size_t)n, sizeof *x);
  const FemSolverOps *const all[] = {&fem_solver_amg, &fem_solver_gamg};
  for (int k = 0; k < 2; k++) {
    void *solver;
    ck_assert_ok(all[k]->create(&solver, 1, 1e-10));
    ck_assert_ok(all[k]->analyse(solver, &bar.S));
    int count = 0;
    for (double c = 0.1; count < 76; c *= c < 100 ? 1.1 : 1e-4, count++) {
      solve_shifted(all[k], solver, &bar, c, b, x);
      fem_matrix_multiply(&bar.S, x, Sx);
      double error = 0, norm = 0;
      for (int i = 0; i < n; i++) error += (Sx[i] - b[i]) * (Sx[i] - b[i]), norm += b[i] * b[i];
      ck_assert_msg(sqrt(error / norm) <= 1e-7, "%s, c = %g: residual %g", all[k]->name, c,
                    sqrt(error / norm));
    }
    const FemSolverStats *stats = all[k]->stats(solver);
    ck_assert_int_ge((int)stats->factorisations, count);
    ck_assert_msg(stats->hierarchies >= 2 && 2 * stats->hierarchies <= count,
                  "%s: %lld hierarchies for %d matrices", all[k]->name, stats->hierarchies, count);
    all[k]->destroy(solver);
  }
  memory_free(b), memory_free(x), memory_free(Sx);
  bar_destroy(&bar);
}
END_TEST

// c as IDA moves it while it is content with its matrix and beyond: factors of 0.6 to 1.67.
START_TEST(a_hierarchy_is_kept_while_c_changes_little) {
  static const double near[] = {10, 9, 11, 7, 12, 16};
  Bar bar = bar_create(40, 1);
  int n = bar.unknown_count;
  double *b = random_vector(n, 6), *x = memory_zeroed((size_t)n, sizeof *x);
  const FemSolverOps *const all[] = {&fem_solver_amg, &fem_solver_gamg};
  for (int k = 0; k < 2; k++) {
    void *solver;
    ck_assert_ok(all[k]->create(&solver, 1, 1e-4));
    ck_assert_ok(all[k]->analyse(solver, &bar.S));
    for (int i = 0; i < 6; i++) solve_shifted(all[k], solver, &bar, near[i], b, x);
    ck_assert_int_eq(all[k]->stats(solver)->factorisations, 6);
    ck_assert_int_eq(all[k]->stats(solver)->hierarchies, 1);
    all[k]->forget(solver); // what a resumed run does not have
    solve_shifted(all[k], solver, &bar, near[5], b, x);
    ck_assert_int_eq(all[k]->stats(solver)->hierarchies, 2);
    all[k]->destroy(solver);
  }
  memory_free(b), memory_free(x);
  bar_destroy(&bar);
}
END_TEST

// Never tighter than its own tolerance, and its own again when nothing is known.
START_TEST(multigrid_leaves_what_it_is_told_it_may) {
  static const double aims[] = {0, 1e-2, 1e-12, 0};
  Bar bar = bar_create(40, 1);
  int n = bar.unknown_count;
  double *b = random_vector(n, 7), *x = memory_zeroed((size_t)n, sizeof *x);
  const FemSolverOps *const all[] = {&fem_solver_amg, &fem_solver_gamg};
  for (int k = 0; k < 2; k++) {
    void *solver;
    long long taken[4], before = 0;
    ck_assert_ok(all[k]->create(&solver, 1, 1e-8));
    ck_assert_ok(all[k]->analyse(solver, &bar.S));
    for (int i = 0; i < 4; i++) {
      all[k]->aim(solver, aims[i]);
      solve_shifted(all[k], solver, &bar, 10, b, x);
      taken[i] = all[k]->stats(solver)->iterations - before;
      before = all[k]->stats(solver)->iterations;
    }
    ck_assert_msg(2 * taken[1] <= taken[0], "%lld iterations for %lld", taken[1], taken[0]);
    ck_assert_int_eq(taken[2], taken[0]);
    ck_assert_int_eq(taken[3], taken[0]);
    ck_assert_int_eq(all[k]->stats(solver)->hierarchies, 1); // a tighter aim is no sign of wear
    all[k]->destroy(solver);
  }
  memory_free(b), memory_free(x);
  bar_destroy(&bar);
}
END_TEST

// ---- A library that stands in for PETSc: three levels of 4, 2 and 1 rows. It counts what is open.

typedef struct Level {
  int count, begin[5], column[4];
  double value[4];
} Level;

static Level coarse = {1, {0, 1}, {0}, {2}}, middle = {2, {0, 1, 2}, {0, 1}, {2, 2}},
             to_middle = {2, {0, 1, 2}, {0, 0}, {1, 1}},
             to_finest = {4, {0, 1, 2, 3, 4}, {0, 0, 1, 1}, {1, 1, 1, 1}},
             finest = {4, {0, 1, 2, 3, 4}, {0, 1, 2, 3}, {2, 2, 2, 2}};

static int calls_left;                                         // before the one that fails
static bool fails_softly;                                      // it is no error, but rows are not given
static int matrix_count, list_count, rows_count, values_count; // open

static PetscErrorCode call(void) {
  return calls_left-- == 0 && !fails_softly ? PETSC_ERR_LIB : 0;
}

static PetscErrorCode give(Level *first, Level *second, PetscInt *count, Mat **matrices) {
  if (call()) return PETSC_ERR_LIB;
  *matrices = memory_zeroed(2, sizeof **matrices);
  (*matrices)[0] = (Mat)first, (*matrices)[1] = (Mat)second;
  matrix_count += 2, list_count++;
  *count = 3;
  return 0;
}

static PetscErrorCode give_interpolations(PC multigrid, PetscInt *count, Mat **matrices) {
  (void)multigrid;
  return give(&to_middle, &to_finest, count, matrices);
}

static PetscErrorCode give_matrices(PC multigrid, PetscInt *count, Mat **matrices) {
  (void)multigrid;
  return give(&coarse, &middle, count, matrices);
}

static PetscErrorCode open_rows(Mat matrix, PetscInt shift, PetscBool is_symmetric, PetscBool is_by_nodes,
                                PetscInt *count, const PetscInt **begin, const PetscInt **column,
                                PetscBool *is_done) {
  (void)shift, (void)is_symmetric, (void)is_by_nodes;
  if (call()) return PETSC_ERR_LIB;
  *is_done = calls_left == -1 && fails_softly ? PETSC_FALSE : PETSC_TRUE;
  if (!*is_done) return 0;
  const Level *level = (const Level *)matrix;
  *count = level->count, *begin = level->begin, *column = level->column;
  rows_count++;
  return 0;
}

static PetscErrorCode close_rows(Mat matrix, PetscInt shift, PetscBool is_symmetric, PetscBool is_by_nodes,
                                 PetscInt *count, const PetscInt **begin, const PetscInt **column,
                                 PetscBool *is_done) {
  (void)shift, (void)is_symmetric, (void)is_by_nodes, (void)count, (void)is_done;
  ck_assert_ptr_eq(*begin, ((Level *)matrix)->begin);
  ck_assert_ptr_eq(*column, ((Level *)matrix)->column);
  rows_count--;
  return 0;
}

static PetscErrorCode open_values(Mat matrix, const PetscScalar **values) {
  if (call()) return PETSC_ERR_LIB;
  *values = ((Level *)matrix)->value;
  values_count++;
  return 0;
}

static PetscErrorCode close_values(Mat matrix, const PetscScalar **values) {
  ck_assert_ptr_eq(*values, ((Level *)matrix)->value);
  values_count--;
  return 0;
}

static PetscErrorCode destroy_matrix(Mat *matrix) {
  *matrix = NULL;
  matrix_count--;
  return 0;
}

static PetscErrorCode release(void *list, int line, const char *function, const char *file) {
  (void)line, (void)function, (void)file;
  memory_free(list);
  list_count--;
  return 0;
}

static const FemPetscLibrary stand_in = {.PCGetInterpolations = give_interpolations,
                                         .PCGetCoarseOperators = give_matrices,
                                         .MatGetRowIJ = open_rows,
                                         .MatRestoreRowIJ = close_rows,
                                         .MatSeqAIJGetArrayRead = open_values,
                                         .MatSeqAIJRestoreArrayRead = close_values,
                                         .MatDestroy = destroy_matrix,
                                         .release = release};

// Whichever call of PETSc fails, all that was opened is closed.
START_TEST(a_hierarchy_that_cannot_be_taken_leaves_nothing_open) {
  const FemRows rows = {4, 4, finest.begin, finest.column, finest.value};
  fails_softly = _i;
  int failures = 0;
  for (int k = 0; k <= 10; k++) {
    FemCycle cycle = {0};
    PetscErrorCode code;
    calls_left = k;
    Status status = fem_hierarchy_take(&stand_in, NULL, &rows, &cycle, &code);
    ck_assert_int_eq(matrix_count, 0);
    ck_assert_int_eq(list_count, 0);
    ck_assert_int_eq(rows_count, 0);
    ck_assert_int_eq(values_count, 0);
    ck_assert_int_eq(status, code ? STATUS_SOLVER : STATUS_OK);
    failures += status != STATUS_OK;
    fem_cycle_destroy(&cycle);
  }
  // Two lists, and of four matrices rows and values; without an error, rows alone.
  ck_assert_int_eq(failures, fails_softly ? 4 : 10);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("hierarchy");
  tcase_add_test(cases, a_hierarchy_that_is_kept_never_touches_the_answer);
  tcase_add_test(cases, a_hierarchy_is_kept_while_c_changes_little);
  tcase_add_loop_test(cases, a_hierarchy_that_cannot_be_taken_leaves_nothing_open, 0, 2);
  tcase_add_test(cases, multigrid_leaves_what_it_is_told_it_may);
  return suite_run("hierarchy", cases, 60);
}

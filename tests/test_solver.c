// SPDX-License-Identifier: GPL-3.0-or-later
// fem/solver: every solver in the table on small systems by hand and on random ones, against each other, and
// on matrices that it must refuse.
#include "suite.h"

#include <omp.h>
#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "fem/sparse/solver.h"

static const FemSolverKind KINDS[] = {FEM_SOLVER_CHOLMOD, FEM_SOLVER_KLU, FEM_SOLVER_PCG};
enum { KIND_COUNT = 3 };

// A bar of cells × 3 × 3 cubes cut into six tetrahedra each; a random positive semi-definite matrix a
// tetrahedron for K and D, random masses. One end is fixed, some coordinates elsewhere too.
typedef struct Bar {
  int vertex_count, unknown_count;
  int *unknown_of_dof;
  double *mass, *mass_of_unknown;
  FemPattern *pattern;
  FemMatrix K, D, S; // S = K + c D + c² M
  double c;
} Bar;

static void add_tet(Bar *bar, Random *random, const int tet[4]) {
  double dense[144] = {0}, w[12];
  for (int k = 0; k < 8; k++) {
    double mean[3] = {0};
    for (int i = 0; i < 12; i++) w[i] = random_normal(random), mean[i % 3] += 0.25 * w[i];
    for (int i = 0; i < 12; i++) w[i] -= mean[i % 3]; // no force from a translation
    for (int i = 0; i < 144; i++) dense[i] += w[i / 12] * w[i % 12];
  }
  fem_matrix_add(&bar->K, 4, tet, dense, 1);
  fem_matrix_add(&bar->D, 4, tet, dense, 0.03);
}

// Calls add_tet, or with `is_layout` only tells the pattern, for each of the six tetrahedra of every cube.
static void visit_tets(Bar *bar, int cells, bool is_layout) {
  static const int paths[6][2] = {{1, 2}, {1, 4}, {2, 1}, {2, 4}, {4, 1}, {4, 2}}; // axis bits of a Kuhn path
  Random random = random_seeded(42, 0);
  for (int cube = 0; cube < 9 * cells; cube++) {
    int corner[8];
    for (int k = 0; k < 8; k++)
      corner[k] = (cube / 9 + (k & 1)) * 16 + (cube / 3 % 3 + (k >> 1 & 1)) * 4 + cube % 3 + (k >> 2);
    for (int p = 0; p < 6; p++) {
      int tet[4] = {corner[0], corner[paths[p][0]], corner[paths[p][0] | paths[p][1]], corner[7]};
      if (is_layout)
        ck_assert_ok(fem_pattern_add_clique(bar->pattern, 4, tet, NULL));
      else
        add_tet(bar, &random, tet);
    }
  }
}

static Bar bar_create(int cells, double c) {
  Bar bar = {.vertex_count = 16 * (cells + 1), .c = c};
  size_t vertices = (size_t)bar.vertex_count;
  Random random = random_seeded(43, 0);
  bar.unknown_of_dof = memory_zeroed(3 * vertices, sizeof *bar.unknown_of_dof);
  bar.mass = memory_zeroed(vertices, sizeof *bar.mass);
  bar.mass_of_unknown = memory_zeroed(3 * vertices, sizeof *bar.mass_of_unknown);
  for (int v = 0; v < bar.vertex_count; v++) bar.mass[v] = random_between(&random, 0.5, 1.5);
  for (int dof = 0; dof < 3 * bar.vertex_count; dof++) {
    bool is_free = dof >= 48 && random_uniform(&random) > 0.05;
    if (is_free) bar.mass_of_unknown[bar.unknown_count] = bar.mass[dof / 3];
    bar.unknown_of_dof[dof] = is_free ? bar.unknown_count++ : -1;
  }
  ck_assert_ok(fem_pattern_create(&bar.pattern, bar.vertex_count));
  visit_tets(&bar, cells, true);
  ck_assert_ok(fem_matrix_create(&bar.K, bar.pattern, bar.unknown_of_dof));
  ck_assert_ok(fem_matrix_copy_layout(&bar.D, &bar.K));
  ck_assert_ok(fem_matrix_copy_layout(&bar.S, &bar.K));
  visit_tets(&bar, cells, false);
  for (int k = 0; k < bar.S.entry_count; k++) bar.S.value[k] = bar.K.value[k] + c * bar.D.value[k];
  fem_matrix_add_mass(&bar.S, bar.mass, c * c);
  return bar;
}

static void bar_destroy(Bar *bar) {
  fem_matrix_destroy(&bar->K), fem_matrix_destroy(&bar->D), fem_matrix_destroy(&bar->S);
  fem_pattern_destroy(bar->pattern);
  memory_free(bar->unknown_of_dof), memory_free(bar->mass), memory_free(bar->mass_of_unknown);
}

// Newton's full system for right-hand sides r1, r2 by any solver: condensed ones as the integrator does it.
static void solve_newton(const Bar *bar, const FemSolverOps *ops, void *solver, const double *r, double *x) {
  int n = bar->unknown_count;
  if (!ops->is_condensed) {
    ck_assert_ok(ops->solve(solver, r, x));
    return;
  }
  double *b = memory_zeroed((size_t)n, sizeof *b);
  fem_matrix_multiply(&bar->D, r, b);
  for (int i = 0; i < n; i++) b[i] += r[n + i] + bar->c * bar->mass_of_unknown[i] * r[i];
  ck_assert_ok(ops->solve(solver, b, x));
  for (int i = 0; i < n; i++) x[n + i] = bar->c * x[i] - r[i];
  memory_free(b);
}

static Status factorise(const Bar *bar, const FemSolverOps *ops, void *solver) {
  if (ops->is_condensed) return ops->factorise(solver, &bar->S, NULL, NULL, bar->c);
  return ops->factorise(solver, &bar->K, &bar->D, bar->mass_of_unknown, bar->c);
}

// ‖b − J x‖₂ / ‖b‖₂ of the full system, by its definition.
static double relative_residual(const Bar *bar, const double *r, const double *x) {
  int n = bar->unknown_count;
  double *Ku = memory_zeroed((size_t)n, sizeof *Ku), *Dv = memory_zeroed((size_t)n, sizeof *Dv);
  fem_matrix_multiply(&bar->K, x, Ku);
  fem_matrix_multiply(&bar->D, x + n, Dv);
  double error = 0, norm = 0;
  for (int i = 0; i < n; i++) {
    double first = r[i] - (bar->c * x[i] - x[n + i]);
    double second = r[n + i] - (Ku[i] + Dv[i] + bar->c * bar->mass_of_unknown[i] * x[n + i]);
    error += first * first + second * second;
    norm += r[i] * r[i] + r[n + i] * r[n + i];
  }
  memory_free(Ku), memory_free(Dv);
  return sqrt(error / norm);
}

static double *random_vector(int count, uint64_t seed) {
  Random random = random_seeded(seed, 0);
  double *values = memory_zeroed((size_t)count, sizeof *values);
  for (int i = 0; i < count; i++) values[i] = random_normal(&random);
  return values;
}

START_TEST(solvers_are_found_by_kind_and_named) {
  ck_assert_str_eq(fem_solver_name(FEM_SOLVER_AUTO), "auto");
  ck_assert_str_eq(fem_solver_name(FEM_SOLVER_CHOLMOD), "cholmod");
  ck_assert_str_eq(fem_solver_name(FEM_SOLVER_KLU), "klu");
  ck_assert_str_eq(fem_solver_name(FEM_SOLVER_PCG), "pcg");
  for (int k = 0; k < KIND_COUNT; k++) ck_assert_int_gt((int)strlen(fem_solver_help(KINDS[k])), 10);
}
END_TEST

// One vertex, y prescribed: K = [4 1; 1 3], M = 2, c = 10. By hand for r = (r1; r2) = (0, 0; 204, 1):
// S = K + 100 · 2 = [204 1; 1 203], S (1, 0) = (204, 1), so du = (1, 0) and dv = (10, 0).
START_TEST(two_unknowns_are_solved_as_by_hand) {
  const int unknown_of_dof[3] = {0, -1, 1};
  const double dense[9] = {4, 7, 1, 7, 9, 8, 1, 8, 3}, mass[1] = {2}, mass_of_unknown[2] = {2, 2};
  FemPattern *pattern;
  FemMatrix K, S;
  ck_assert_ok(fem_pattern_create(&pattern, 1));
  ck_assert_ok(fem_matrix_create(&K, pattern, unknown_of_dof));
  ck_assert_ok(fem_matrix_copy_layout(&S, &K));
  fem_matrix_add(&K, 1, (int[]){0}, dense, 1);
  fem_matrix_add(&S, 1, (int[]){0}, dense, 1);
  fem_matrix_add_mass(&S, mass, 100);
  for (int k = 0; k < KIND_COUNT; k++) {
    const FemSolverOps *ops = fem_solver_ops(KINDS[k]);
    const double r[4] = {0, 0, 204, 1}, expected[4] = {1, 0, 10, 0};
    double x[4];
    void *solver;
    ck_assert_ok(ops->create(&solver, 1, 1e-12));
    ck_assert_ok(ops->analyse(solver, &K));
    if (ops->is_condensed)
      ck_assert_ok(ops->factorise(solver, &S, NULL, NULL, 10));
    else
      ck_assert_ok(ops->factorise(solver, &K, NULL, mass_of_unknown, 10));
    ck_assert_ok(ops->solve(solver, ops->is_condensed ? r + 2 : r, x));
    for (int i = 0; i < (ops->is_condensed ? 2 : 4); i++) ck_assert_near(x[i], expected[i], 1e-12);
    ops->destroy(solver);
  }
  fem_matrix_destroy(&K), fem_matrix_destroy(&S);
  fem_pattern_destroy(pattern);
}
END_TEST

START_TEST(all_solvers_solve_newtons_system) {
  Bar bar = bar_create(20, 8);
  int n = bar.unknown_count;
  ck_assert_int_gt(n, 800);
  for (int k = 0; k < KIND_COUNT; k++) {
    const FemSolverOps *ops = fem_solver_ops(KINDS[k]);
    double *r = random_vector(2 * n, 3), *x = memory_zeroed(2 * (size_t)n, sizeof *x);
    void *solver;
    ck_assert_ok(ops->create(&solver, 1, 1e-13));
    ck_assert_ok(ops->analyse(solver, &bar.K));
    ck_assert_ok(factorise(&bar, ops, solver));
    solve_newton(&bar, ops, solver, r, x);
    double residual = relative_residual(&bar, r, x);
    ck_assert_msg(residual <= 1e-12, "%s: residual %g", ops->name, residual);
    const FemSolverStats *stats = ops->stats(solver);
    ck_assert(stats->analyses == 1 && stats->factorisations == 1 && stats->solves == 1);
    ck_assert((stats->iterations > 1) == (KINDS[k] == FEM_SOLVER_PCG));
    ck_assert((stats->factor_entries > n) == (KINDS[k] != FEM_SOLVER_PCG));
    ops->destroy(solver);
    memory_free(r), memory_free(x);
  }
  bar_destroy(&bar);
}
END_TEST

// Large enough to be ordered by nested dissection and shared among threads.
START_TEST(pcg_keeps_its_tolerance_and_its_bits) {
  Bar bar = bar_create(90, 1);
  int n = bar.unknown_count;
  ck_assert_int_gt(n, 4000);
  const FemSolverOps *ops = &fem_solver_pcg;
  double *b = random_vector(n, 5), *exact = memory_zeroed((size_t)n, sizeof *exact);
  double *x = memory_zeroed((size_t)n, sizeof *x), *again = memory_zeroed((size_t)n, sizeof *again);
  void *solver;
  ck_assert_ok(fem_solver_cholmod.create(&solver, 1, 0));
  ck_assert_ok(fem_solver_cholmod.analyse(solver, &bar.S));
  ck_assert_ok(fem_solver_cholmod.factorise(solver, &bar.S, NULL, NULL, 1));
  ck_assert_ok(fem_solver_cholmod.solve(solver, b, exact));
  fem_solver_cholmod.destroy(solver);
  double error[2], norm = 0;
  for (int i = 0; i < n; i++) norm += exact[i] * exact[i];
  for (int loose = 0; loose < 2; loose++) {
    ck_assert_ok(ops->create(&solver, 1, loose ? 1e-3 : 1e-9));
    ck_assert_ok(ops->analyse(solver, &bar.S));
    ck_assert_ok(ops->factorise(solver, &bar.S, NULL, NULL, 1));
    ck_assert_ok(ops->solve(solver, b, x));
    error[loose] = 0;
    for (int i = 0; i < n; i++) error[loose] += (x[i] - exact[i]) * (x[i] - exact[i]);
    ops->destroy(solver);
    ck_assert_ok(ops->create(&solver, 4, loose ? 1e-3 : 1e-9));
    int before = omp_get_max_threads();
    ck_assert_ok(ops->analyse(solver, &bar.S));
    ck_assert_ok(ops->factorise(solver, &bar.S, NULL, NULL, 1));
    ck_assert_ok(ops->solve(solver, b, again));
    ck_assert_int_eq(omp_get_max_threads(), before);
    ck_assert_mem_eq(x, again, (size_t)n * sizeof *x);
    ops->destroy(solver);
  }
  ck_assert_near(sqrt(error[0] / norm), 0, 1e-7);
  ck_assert_near(sqrt(error[1] / norm), 0, 1e-1);
  ck_assert(error[0] < 1e-6 * error[1]);
  memory_free(b), memory_free(exact), memory_free(x), memory_free(again);
  bar_destroy(&bar);
}
END_TEST

// The same numbers give the same solution, whatever was factorised before.
START_TEST(a_refactorisation_remembers_nothing) {
  Bar bar = bar_create(12, 4), other = bar_create(12, 4000);
  int n = bar.unknown_count;
  double *r = random_vector(2 * n, 6);
  other.S.layout = other.K.layout = other.D.layout = bar.K.layout; // the same cliques: the same rows
  for (int k = 0; k < KIND_COUNT; k++) {
    const FemSolverOps *ops = fem_solver_ops(KINDS[k]);
    double *x = memory_zeroed(2 * (size_t)n, sizeof *x), *again = memory_zeroed(2 * (size_t)n, sizeof *x);
    void *solver;
    ck_assert_ok(ops->create(&solver, 1, 1e-10));
    ck_assert_ok(ops->analyse(solver, &bar.K));
    ck_assert_ok(factorise(&bar, ops, solver));
    solve_newton(&bar, ops, solver, r, x);
    ck_assert_ok(factorise(&other, ops, solver));
    solve_newton(&other, ops, solver, r, again);
    ck_assert(memcmp(x, again, 2 * (size_t)n * sizeof *x) != 0);
    ck_assert_ok(factorise(&bar, ops, solver));
    solve_newton(&bar, ops, solver, r, again);
    if (ops->is_condensed)
      ck_assert_mem_eq(x, again, 2 * (size_t)n * sizeof *x);
    else // klu may keep the pivots of before
      ck_assert_near(relative_residual(&bar, r, again), 0, 1e-12);
    ops->destroy(solver);
    memory_free(x), memory_free(again);
  }
  memory_free(r);
  bar_destroy(&bar), bar_destroy(&other);
}
END_TEST

START_TEST(what_cannot_be_solved_is_a_retry_and_the_next_matrix_is_fine) {
  Bar bar = bar_create(10, 5);
  int n = bar.unknown_count;
  double *r = random_vector(2 * n, 7), *x = memory_zeroed(2 * (size_t)n, sizeof *x);
  for (int k = 0; k < KIND_COUNT; k++) {
    const FemSolverOps *ops = fem_solver_ops(KINDS[k]);
    FemMatrix *matrix = ops->is_condensed ? &bar.S : &bar.K;
    int entry = matrix->col_begin[n / 2];
    double kept = matrix->value[entry];
    void *solver;
    ck_assert_ok(ops->create(&solver, 1, 1e-10));
    ck_assert_ok(ops->analyse(solver, matrix));
    if (ops->is_condensed) {
      matrix->value[entry] = -kept;
      ck_assert_int_eq(factorise(&bar, ops, solver), STATUS_RETRY);
      ck_assert_ptr_nonnull(strstr(status_message(), "positive definite"));
      ck_assert_int_eq(ops->solve(solver, r, x), STATUS_SOLVER);
    }
    matrix->value[entry] = NAN;
    ck_assert_int_eq(factorise(&bar, ops, solver), STATUS_RETRY);
    matrix->value[entry] = INFINITY;
    ck_assert_int_eq(factorise(&bar, ops, solver), STATUS_RETRY);
    matrix->value[entry] = kept;
    ck_assert_ok(factorise(&bar, ops, solver));
    solve_newton(&bar, ops, solver, r, x);
    ck_assert_near(relative_residual(&bar, r, x), 0, 1e-8);
    ck_assert_int_ge(ops->stats(solver)->failed_factorisations, 2);
    ops->destroy(solver);
  }
  memory_free(r), memory_free(x);
  bar_destroy(&bar);
}
END_TEST

// Positive diagonal blocks, indefinite all the same: pcg finds a direction of negative curvature.
START_TEST(pcg_finds_an_indefinite_matrix_while_it_iterates) {
  const int unknown_of_dof[6] = {0, -1, -1, 1, -1, -1};
  const double dense[36] = {[0] = 1, [3] = 3, [18] = 3, [21] = 1}; // [1 3; 3 1]
  FemPattern *pattern;
  FemMatrix A;
  ck_assert_ok(fem_pattern_create(&pattern, 2));
  ck_assert_ok(fem_pattern_add_clique(pattern, 2, (int[]){0, 1}, NULL));
  ck_assert_ok(fem_matrix_create(&A, pattern, unknown_of_dof));
  fem_matrix_add(&A, 2, (int[]){0, 1}, dense, 1);
  void *solver;
  ck_assert_ok(fem_solver_pcg.create(&solver, 1, 1e-10));
  ck_assert_ok(fem_solver_pcg.analyse(solver, &A));
  ck_assert_ok(fem_solver_pcg.factorise(solver, &A, NULL, NULL, 1));
  double x[2];
  ck_assert_int_eq(fem_solver_pcg.solve(solver, (double[]){1, -1}, x), STATUS_RETRY);
  ck_assert_ptr_nonnull(strstr(status_message(), "positive definite"));
  fem_solver_pcg.destroy(solver);
  fem_matrix_destroy(&A);
  fem_pattern_destroy(pattern);
}
END_TEST

START_TEST(a_singular_full_matrix_is_a_retry) {
  const int unknown_of_dof[3] = {0, -1, -1};
  const double no_mass[1] = {0};
  FemPattern *pattern;
  FemMatrix K; // zero: so is S = K + c² M
  ck_assert_ok(fem_pattern_create(&pattern, 1));
  ck_assert_ok(fem_matrix_create(&K, pattern, unknown_of_dof));
  void *solver;
  ck_assert_ok(fem_solver_klu.create(&solver, 1, 0));
  ck_assert_ok(fem_solver_klu.analyse(solver, &K));
  ck_assert_int_eq(fem_solver_klu.factorise(solver, &K, NULL, no_mass, 1), STATUS_RETRY);
  fem_solver_klu.destroy(solver);
  fem_matrix_destroy(&K);
  fem_pattern_destroy(pattern);
}
END_TEST

START_TEST(a_grown_pattern_must_be_analysed_anew) {
  Bar bar = bar_create(6, 2);
  for (int k = 0; k < KIND_COUNT; k++) {
    const FemSolverOps *ops = fem_solver_ops(KINDS[k]);
    double *r = random_vector(2 * bar.unknown_count, 9);
    double *x = memory_zeroed(2 * (size_t)bar.unknown_count, sizeof *x);
    void *solver;
    ck_assert_ok(ops->create(&solver, 1, 1e-12));
    ck_assert_int_eq(factorise(&bar, ops, solver), STATUS_SOLVER);
    ck_assert_ok(ops->analyse(solver, &bar.K));
    ck_assert_ok(factorise(&bar, ops, solver));
    Bar grown = bar_create(6, 2);
    ck_assert_int_eq(factorise(&grown, ops, solver), STATUS_SOLVER);
    ck_assert_ptr_nonnull(strstr(status_message(), "analysed"));
    ck_assert_ok(ops->analyse(solver, &grown.K));
    ck_assert_ok(factorise(&grown, ops, solver));
    solve_newton(&grown, ops, solver, r, x);
    ck_assert_near(relative_residual(&grown, r, x), 0, 1e-10);
    ops->destroy(solver);
    bar_destroy(&grown);
    memory_free(r), memory_free(x);
  }
  bar_destroy(&bar);
}
END_TEST

START_TEST(every_failed_allocation_is_an_error) {
  Bar bar = bar_create(2, 3);
  for (int kind = 0; kind < KIND_COUNT; kind++) {
    const FemSolverOps *ops = fem_solver_ops(KINDS[kind]);
    int failures = 0;
    for (long k = 1;; k++, failures++) {
      void *solver = NULL;
      memory_fail_at(k);
      Status status = ops->create(&solver, 1, 1e-8);
      if (status == STATUS_OK) status = ops->analyse(solver, &bar.K);
      if (status == STATUS_OK) status = factorise(&bar, ops, solver);
      memory_fail_at(0);
      ops->destroy(solver);
      if (status == STATUS_OK) break;
      ck_assert_int_eq(status, STATUS_MEMORY);
    }
    ck_assert_int_gt(failures, 4);
  }
  bar_destroy(&bar);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("solver");
  tcase_add_test(cases, solvers_are_found_by_kind_and_named);
  tcase_add_test(cases, two_unknowns_are_solved_as_by_hand);
  tcase_add_test(cases, all_solvers_solve_newtons_system);
  tcase_add_test(cases, pcg_keeps_its_tolerance_and_its_bits);
  tcase_add_test(cases, a_refactorisation_remembers_nothing);
  tcase_add_test(cases, what_cannot_be_solved_is_a_retry_and_the_next_matrix_is_fine);
  tcase_add_test(cases, pcg_finds_an_indefinite_matrix_while_it_iterates);
  tcase_add_test(cases, a_singular_full_matrix_is_a_retry);
  tcase_add_test(cases, a_grown_pattern_must_be_analysed_anew);
  tcase_add_test(cases, every_failed_allocation_is_an_error);
  return suite_run("solver", cases, 60);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// fem/sparse/solver.h: every solver in the table on small systems by hand and on random ones, against each
// other, and on matrices that it must refuse.
#include "bar.h"

#include <omp.h>
#include <string.h>

#include "base/memory.h"
#include "fem/sparse/solver.h"
#include "reference/element.h"

static const FemSolverKind KINDS[] = {FEM_SOLVER_CHOLMOD, FEM_SOLVER_KLU, FEM_SOLVER_PCG, FEM_SOLVER_AMG,
                                      FEM_SOLVER_GAMG};
enum { KIND_COUNT = 5 };

static bool iterates(FemSolverKind kind) {
  return kind == FEM_SOLVER_PCG || kind == FEM_SOLVER_AMG || kind == FEM_SOLVER_GAMG;
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

START_TEST(solvers_are_found_by_kind_and_named) {
  ck_assert_str_eq(fem_solver_name(FEM_SOLVER_AUTO), "auto");
  ck_assert_str_eq(fem_solver_name(FEM_SOLVER_CHOLMOD), "cholmod");
  ck_assert_str_eq(fem_solver_name(FEM_SOLVER_KLU), "klu");
  ck_assert_str_eq(fem_solver_name(FEM_SOLVER_PCG), "pcg");
  ck_assert_str_eq(fem_solver_name(FEM_SOLVER_AMG), "amg");
  ck_assert_str_eq(fem_solver_name(FEM_SOLVER_GAMG), "gamg");
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
    ck_assert((stats->iterations > 1) == iterates(KINDS[k]));
    ck_assert((stats->factor_entries > n) == !iterates(KINDS[k]));
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
    if (ops->forget) // the hierarchy is one of before: the answer is as good
      ck_assert_near(relative_residual(&bar, r, again), 0, 1e-8);
    else if (ops->is_condensed)
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

// Positive diagonal blocks, indefinite all the same: a direction of negative curvature is found.
START_TEST(an_indefinite_matrix_is_found_while_iterating) {
  const int unknown_of_dof[6] = {0, -1, -1, 1, -1, -1};
  const double dense[36] = {[0] = 1, [3] = 3, [18] = 3, [21] = 1}; // [1 3; 3 1]
  const FemSolverOps *const all[] = {&fem_solver_pcg, &fem_solver_amg, &fem_solver_gamg};
  FemPattern *pattern;
  FemMatrix A;
  ck_assert_ok(fem_pattern_create(&pattern, 2));
  ck_assert_ok(fem_pattern_add_clique(pattern, 2, (int[]){0, 1}, NULL));
  ck_assert_ok(fem_matrix_create(&A, pattern, unknown_of_dof));
  fem_matrix_add(&A, 2, (int[]){0, 1}, dense, 1);
  for (int k = 0; k < 3; k++) {
    void *solver;
    ck_assert_ok(all[k]->create(&solver, 1, 1e-10));
    ck_assert_ok(all[k]->analyse(solver, &A));
    ck_assert_ok(all[k]->factorise(solver, &A, NULL, NULL, 1));
    double x[2];
    ck_assert_int_eq(all[k]->solve(solver, (double[]){1, -1}, x), STATUS_RETRY);
    ck_assert_ptr_nonnull(strstr(status_message(), "positive definite"));
    all[k]->destroy(solver);
  }
  fem_matrix_destroy(&A);
  fem_pattern_destroy(pattern);
}
END_TEST

// A clamped bar of 24 × 8 × 8 cubes of linear elastic tetrahedra (K + shift · M) under a load across. Returns
// the iterations of one solution to 1e-8; *residual is ‖A x − b‖/‖b‖. x_out may be NULL (unknowns).
enum { BAR_X = 24, BAR_YZ = 8 };

static int bar_vertex(int x, int y, int z) {
  return (x * (BAR_YZ + 1) + y) * (BAR_YZ + 1) + z;
}

typedef void BarVisit(void *self, const int tet[4]);

static void visit_bar(BarVisit *visit, void *self) {
  static const int paths[6][2] = {{1, 2}, {1, 4}, {2, 1}, {2, 4}, {4, 1}, {4, 2}};
  for (int x = 0; x < BAR_X; x++)
    for (int y = 0; y < BAR_YZ; y++)
      for (int z = 0; z < BAR_YZ; z++)
        for (int p = 0; p < 6; p++) {
          int tet[4], bits[4] = {0, paths[p][0], paths[p][0] | paths[p][1], 7};
          for (int a = 0; a < 4; a++)
            tet[a] = bar_vertex(x + (bits[a] & 1), y + (bits[a] >> 1 & 1), z + (bits[a] >> 2));
          visit(self, tet);
        }
}

typedef struct Elastic {
  FemPattern *pattern;
  FemMatrix matrix;
  double *rest;
} Elastic;

static void couple_tet(void *self, const int tet[4]) {
  ck_assert_ok(fem_pattern_add_clique(((Elastic *)self)->pattern, 4, tet, NULL));
}

static void stiffen_tet(void *self, const int tet[4]) {
  Elastic *bar = self;
  const FemMaterial material = {.law = FEM_MATERIAL_LINEAR, .young = 1, .poisson = 0.3, .density = 1};
  int order[4] = {tet[0], tet[1], tet[2], tet[3]};
  double rest[12], dense[144];
  FemElement element;
  for (int turn = 0; turn < 2; turn++) { // positively oriented the second time if not the first
    for (int a = 0; a < 4; a++) memcpy(rest + 3 * a, bar->rest + 3 * order[a], 3 * sizeof *rest);
    fem_element_create(&element, rest);
    if (element.volume > 0) break;
    order[2] = tet[3], order[3] = tet[2];
  }
  ck_assert(element.volume > 0);
  reference_element_stiffness(&element, &material, rest, dense);
  fem_matrix_add(&bar->matrix, 4, order, dense, 1);
}

static long long bend_bar(const FemSolverOps *ops, int threads, double *residual, double *x_out,
                          bool knows_rest) {
  enum { VERTICES = (BAR_X + 1) * (BAR_YZ + 1) * (BAR_YZ + 1) };
  Elastic bar = {.rest = memory_zeroed(3 * VERTICES, sizeof(double))};
  int *unknown_of_dof = memory_zeroed(3 * VERTICES, sizeof *unknown_of_dof), n = 0;
  for (int v = 0; v < VERTICES; v++)
    for (int c = 0; c < 3; c++) {
      int at[3] = {v / ((BAR_YZ + 1) * (BAR_YZ + 1)), v / (BAR_YZ + 1) % (BAR_YZ + 1), v % (BAR_YZ + 1)};
      bar.rest[3 * v + c] = at[c];
      bool is_guided = at[0] == BAR_X && c == 1; // a vertex may have one or two unknowns
      unknown_of_dof[3 * v + c] = at[0] == 0 || is_guided ? -1 : n++;
    }
  ck_assert_ok(fem_pattern_create(&bar.pattern, VERTICES));
  visit_bar(couple_tet, &bar);
  ck_assert_ok(fem_matrix_create(&bar.matrix, bar.pattern, unknown_of_dof));
  visit_bar(stiffen_tet, &bar);
  if (knows_rest) bar.matrix.rest = bar.rest;
  double *b = memory_zeroed((size_t)n, sizeof *b), *x = memory_zeroed((size_t)n, sizeof *x);
  for (int dof = 0; dof < 3 * VERTICES; dof++)
    if (unknown_of_dof[dof] >= 0) b[unknown_of_dof[dof]] = dof % 3 == 2 ? 1e-3 : 1e-4;
  void *solver;
  ck_assert_ok(ops->create(&solver, threads, 1e-8));
  ck_assert_ok(ops->analyse(solver, &bar.matrix));
  ck_assert_ok(ops->factorise(solver, &bar.matrix, NULL, NULL, 0));
  ck_assert_ok(ops->solve(solver, b, x));
  long long iterations = ops->stats(solver)->iterations;
  ops->destroy(solver);
  if (x_out) memcpy(x_out, x, (size_t)n * sizeof *x);
  double *Ax = memory_zeroed((size_t)n, sizeof *Ax), error = 0, norm = 0;
  fem_matrix_multiply(&bar.matrix, x, Ax);
  for (int i = 0; i < n; i++) error += (Ax[i] - b[i]) * (Ax[i] - b[i]), norm += b[i] * b[i];
  *residual = sqrt(error / norm);
  fem_matrix_destroy(&bar.matrix);
  fem_pattern_destroy(bar.pattern);
  memory_free(bar.rest), memory_free(unknown_of_dof), memory_free(b), memory_free(x), memory_free(Ax);
  return iterations;
}

START_TEST(multigrid_gives_the_same_bits_twice_and_on_any_number_of_threads) {
  const FemSolverOps *const all[] = {&fem_solver_amg, &fem_solver_gamg};
  for (int k = 0; k < 2; k++) {
    double residual, *x = memory_zeroed(20000, sizeof *x), *again = memory_zeroed(20000, sizeof *x);
    long long iterations = bend_bar(all[k], 1, &residual, x, true);
    ck_assert_msg(iterations >= 3 && iterations <= 60, "%s: %lld iterations", all[k]->name, iterations);
    ck_assert_near(residual, 0, 1e-6);
    ck_assert_int_eq(bend_bar(all[k], 1, &residual, again, true), iterations);
    ck_assert_mem_eq(x, again, 20000 * sizeof *x);
    ck_assert_int_eq(bend_bar(all[k], 4, &residual, again, true), iterations);
    ck_assert_mem_eq(x, again, 20000 * sizeof *x);
    memory_free(x), memory_free(again);
  }
}
END_TEST

START_TEST(a_factor_gives_the_same_bits_on_any_number_of_threads) {
  double residual, *x = memory_zeroed(20000, sizeof *x), *again = memory_zeroed(20000, sizeof *x);
  bend_bar(&fem_solver_cholmod, 1, &residual, x, true);
  ck_assert_near(residual, 0, 1e-10);
  for (int threads = 2; threads <= 4; threads *= 2) {
    omp_set_num_threads(threads);
    bend_bar(&fem_solver_cholmod, threads, &residual, again, true);
    ck_assert_mem_eq(x, again, 20000 * sizeof *x);
  }
  omp_set_num_threads(1);
  memory_free(x), memory_free(again);
}
END_TEST

START_TEST(multigrid_needs_far_fewer_iterations_than_blocks_of_vertices) {
  double residual;
  long long blocks = bend_bar(&fem_solver_pcg, 1, &residual, NULL, true);
  long long boomer = bend_bar(&fem_solver_amg, 1, &residual, NULL, true);
  long long rigid = bend_bar(&fem_solver_gamg, 1, &residual, NULL, true);
  long long blind = bend_bar(&fem_solver_gamg, 1, &residual, NULL, false);
  ck_assert_msg(5 * boomer < blocks && 5 * rigid < blocks, "pcg %lld, amg %lld, gamg %lld", blocks, boomer,
                rigid);
  ck_assert_msg(rigid < blind, "gamg: %lld with rigid motions, %lld without", rigid, blind);
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

static Bar bar_with_ties(int cells, int ties) {
  Bar bar = bar_create(cells, 2);
  for (int k = 0; k < ties; k++) {
    int far[2] = {16 + 3 * k, bar.vertex_count - 1 - 5 * k};
    ck_assert_ok(fem_pattern_add_clique(bar.pattern, 2, far, NULL));
  }
  FemMatrix tied;
  ck_assert_ok(fem_matrix_create(&tied, bar.pattern, bar.unknown_of_dof));
  fem_matrix_destroy(&bar.S);
  bar.S = tied;
  return bar;
}

// Of a new layout with the same couplings it is kept; with vertices tied to far ones it is not.
START_TEST(an_order_of_elimination_is_kept_while_its_fill_is_near) {
  const FemSolverOps *ops = &fem_solver_cholmod;
  Bar bar = bar_create(40, 2), same = bar_create(40, 2), tied = bar_with_ties(40, 60);
  void *solver;
  ck_assert_ok(ops->create(&solver, 1, 0));
  ck_assert_ok(ops->analyse(solver, &bar.S));
  ck_assert_ok(ops->analyse(solver, &same.S));
  ck_assert_int_eq(ops->stats(solver)->analyses, 2);
  ck_assert_int_eq(ops->stats(solver)->orders, 1);
  ck_assert_ok(factorise(&same, ops, solver));
  double *r = random_vector(2 * same.unknown_count, 9);
  double *x = memory_zeroed(2 * (size_t)same.unknown_count, sizeof *x);
  solve_newton(&same, ops, solver, r, x);
  ck_assert_near(relative_residual(&same, r, x), 0, 1e-10);
  ck_assert_ok(ops->analyse(solver, &tied.S));
  ck_assert_int_eq(ops->stats(solver)->orders, 2);
  ops->destroy(solver);
  memory_free(r), memory_free(x);
  bar_destroy(&bar), bar_destroy(&same), bar_destroy(&tied);
}
END_TEST

// Column k of the factor of a full matrix has n − k entries, each of which is multiplied by all of them.
START_TEST(the_work_of_a_factor_is_counted) {
  enum { FULL = 20 };
  int all[FULL];
  double one, two;
  FemPattern *pattern;
  for (int v = 0; v < FULL; v++) all[v] = v;
  ck_assert_ok(fem_pattern_create(&pattern, 2 * FULL));
  ck_assert_ok(fem_solver_factor_work(pattern, &one));
  ck_assert_double_eq(one, 2 * FULL);
  ck_assert_ok(fem_pattern_add_clique(pattern, FULL, all, NULL));
  ck_assert_ok(fem_solver_factor_work(pattern, &one));
  ck_assert_double_eq(one, FULL + FULL * (FULL + 1) * (2 * FULL + 1) / 6);
  for (int v = 0; v < FULL; v++) all[v] = FULL + v;
  ck_assert_ok(fem_pattern_add_clique(pattern, FULL, all, NULL));
  ck_assert_ok(fem_solver_factor_work(pattern, &two));
  ck_assert_double_eq(two, 2 * (one - FULL));
  fem_pattern_destroy(pattern);
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
  tcase_add_test(cases, an_indefinite_matrix_is_found_while_iterating);
  tcase_add_test(cases, multigrid_gives_the_same_bits_twice_and_on_any_number_of_threads);
  tcase_add_test(cases, a_factor_gives_the_same_bits_on_any_number_of_threads);
  tcase_add_test(cases, multigrid_needs_far_fewer_iterations_than_blocks_of_vertices);
  tcase_add_test(cases, a_singular_full_matrix_is_a_retry);
  tcase_add_test(cases, a_grown_pattern_must_be_analysed_anew);
  tcase_add_test(cases, an_order_of_elimination_is_kept_while_its_fill_is_near);
  tcase_add_test(cases, the_work_of_a_factor_is_counted);
  tcase_add_test(cases, every_failed_allocation_is_an_error);
  return suite_run("solver", cases, 60);
}

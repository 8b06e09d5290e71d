// SPDX-License-Identifier: GPL-3.0-or-later
// fem/solver: every solver in the table on small systems by hand and on random ones, against each other, and
// on matrices that it must refuse.
#include "suite.h"

#include <omp.h>
#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "fem/element/element.h"
#include "fem/sparse/solver.h"

static const FemSolverKind KINDS[] = {FEM_SOLVER_CHOLMOD, FEM_SOLVER_KLU, FEM_SOLVER_PCG, FEM_SOLVER_AMG,
                                      FEM_SOLVER_GAMG};
enum { KIND_COUNT = 5 };

static bool iterates(FemSolverKind kind) {
  return kind == FEM_SOLVER_PCG || kind == FEM_SOLVER_AMG || kind == FEM_SOLVER_GAMG;
}

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
  fem_element_stiffness(&element, &material, rest, dense);
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
  tcase_add_test(cases, an_indefinite_matrix_is_found_while_iterating);
  tcase_add_test(cases, multigrid_gives_the_same_bits_twice_and_on_any_number_of_threads);
  tcase_add_test(cases, a_factor_gives_the_same_bits_on_any_number_of_threads);
  tcase_add_test(cases, multigrid_needs_far_fewer_iterations_than_blocks_of_vertices);
  tcase_add_test(cases, a_hierarchy_that_is_kept_never_touches_the_answer);
  tcase_add_test(cases, a_hierarchy_is_kept_while_c_changes_little);
  tcase_add_test(cases, multigrid_leaves_what_it_is_told_it_may);
  tcase_add_test(cases, a_singular_full_matrix_is_a_retry);
  tcase_add_test(cases, a_grown_pattern_must_be_analysed_anew);
  tcase_add_test(cases, every_failed_allocation_is_an_error);
  return suite_run("solver", cases, 60);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// fem/sparse/front: factors and solutions of a grid that is large enough to have domains, fronts above them,
// and fronts that are cut into pieces.
#include <math.h>
#include <omp.h>
#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "fem/sparse/solver.h"
#include "suite.h"

enum { SIDE = 15, NODES = SIDE * SIDE * SIDE };

typedef struct Grid {
  int unknown_of_dof[3 * NODES], unknown_count;
  FemPattern *pattern;
  FemMatrix matrix;
  double *b, *x, *product;
} Grid;

static int node_of(int i, int j, int k) {
  return i + SIDE * (j + SIDE * k);
}

static void list_corners(int i, int j, int k, int corners[8]) {
  for (int c = 0; c < 8; c++) corners[c] = node_of(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
}

// Σ over cells of w wᵀ, and a diagonal, which makes it definite.
static void fill(Grid *grid, double diagonal) {
  Random random = random_seeded(7, 0);
  fem_matrix_zero(&grid->matrix);
  for (int i = 0; i + 1 < SIDE; i++)
    for (int j = 0; j + 1 < SIDE; j++)
      for (int k = 0; k + 1 < SIDE; k++) {
        int corners[8];
        double w[24];
        list_corners(i, j, k, corners);
        for (int c = 0; c < 24; c++) w[c] = random_uniform(&random) - 0.5;
        fem_matrix_add_outer(&grid->matrix, 8, corners, w, 1);
      }
  double mass[NODES];
  for (int v = 0; v < NODES; v++) mass[v] = 1;
  fem_matrix_add_mass(&grid->matrix, mass, diagonal);
}

// One face of the cube is fixed, one coordinate of some others too, and all beyond so many layers.
static void create_layers(Grid *grid, int layers) {
  *grid = (Grid){0};
  for (int dof = 0; dof < 3 * NODES; dof++) {
    bool is_fixed = dof / 3 % SIDE == 0 || dof % 50 == 0 || dof / 3 >= layers * SIDE * SIDE;
    grid->unknown_of_dof[dof] = is_fixed ? -1 : grid->unknown_count++;
  }
  ck_assert_ok(fem_pattern_create(&grid->pattern, NODES));
  for (int i = 0; i + 1 < SIDE; i++)
    for (int j = 0; j + 1 < SIDE; j++)
      for (int k = 0; k + 1 < SIDE; k++) {
        int corners[8];
        list_corners(i, j, k, corners);
        ck_assert_ok(fem_pattern_add_clique(grid->pattern, 8, corners, NULL));
      }
  ck_assert_ok(fem_matrix_create(&grid->matrix, grid->pattern, grid->unknown_of_dof));
  size_t n = (size_t)grid->unknown_count;
  grid->b = memory_zeroed(n, sizeof(double));
  grid->x = memory_zeroed(n, sizeof(double));
  grid->product = memory_zeroed(n, sizeof(double));
  ck_assert(grid->b && grid->x && grid->product);
  for (size_t i = 0; i < n; i++) grid->b[i] = sin((double)i);
}

static void create(Grid *grid) {
  create_layers(grid, SIDE);
}

static void destroy(Grid *grid) {
  fem_matrix_destroy(&grid->matrix);
  fem_pattern_destroy(grid->pattern);
  memory_free(grid->b), memory_free(grid->x), memory_free(grid->product);
}

static double relative_residual(const Grid *grid) {
  double error = 0, norm = 0;
  fem_matrix_multiply(&grid->matrix, grid->x, grid->product);
  for (int i = 0; i < grid->unknown_count; i++) {
    error = fmax(error, fabs(grid->b[i] - grid->product[i]));
    norm = fmax(norm, fabs(grid->b[i]));
  }
  return error / norm;
}

static void solve_grid(Grid *grid, bool is_rough) {
  const FemSolverOps *ops = &fem_solver_cholmod;
  void *solver;
  ck_assert_ok(ops->create(&solver, 0, 0));
  if (is_rough) ops->be_rough(solver);
  ck_assert_ok(ops->analyse(solver, &grid->matrix));
  ck_assert_ok(ops->factorise(solver, &grid->matrix, NULL, NULL, 1));
  ck_assert_ok(ops->solve(solver, grid->b, grid->x));
  ops->destroy(solver);
}

// The condition number is below 1e3.
START_TEST(solutions_are_exact_or_of_single_precision) {
  Grid *grid = memory_zeroed(1, sizeof *grid);
  create(grid);
  fill(grid, 0.1);
  solve_grid(grid, false);
  ck_assert_double_lt(relative_residual(grid), 1e-12);
  solve_grid(grid, true);
  double rough = relative_residual(grid);
  ck_assert_double_lt(rough, 1e-4);
  ck_assert_double_gt(rough, 1e-10); // it was in single precision
  destroy(grid);
  memory_free(grid);
}
END_TEST

// Single precision is not the same for mirror images: what is balanced would fall from it.
START_TEST(a_small_factor_stays_exact) {
  Grid *grid = memory_zeroed(1, sizeof *grid);
  create_layers(grid, 3);
  fill(grid, 0.1);
  solve_grid(grid, true);
  ck_assert_double_lt(relative_residual(grid), 1e-12);
  destroy(grid);
  memory_free(grid);
}
END_TEST

START_TEST(solutions_are_the_same_to_the_last_bit_on_any_number_of_threads) {
  const int counts[4] = {1, 2, 3, 7};
  Grid *grid = memory_zeroed(1, sizeof *grid);
  int had = omp_get_max_threads();
  create(grid);
  fill(grid, 0.1);
  size_t bytes = (size_t)grid->unknown_count * sizeof(double);
  double *first = memory_zeroed((size_t)grid->unknown_count, sizeof *first);
  ck_assert_ptr_nonnull(first);
  for (int is_rough = 0; is_rough < 2; is_rough++)
    for (int k = 0; k < 4; k++) {
      omp_set_num_threads(counts[k]);
      solve_grid(grid, is_rough);
      if (k == 0) memcpy(first, grid->x, bytes);
      ck_assert_mem_eq(first, grid->x, bytes);
    }
  omp_set_num_threads(had);
  memory_free(first);
  destroy(grid);
  memory_free(grid);
}
END_TEST

// Σ w wᵀ has at most a rank of one a cell, less than a third of its rows.
START_TEST(a_matrix_that_is_not_definite_is_refused_and_the_next_one_is_factorised) {
  Grid *grid = memory_zeroed(1, sizeof *grid);
  const FemSolverOps *ops = &fem_solver_cholmod;
  void *solver;
  create(grid);
  ck_assert_ok(ops->create(&solver, 0, 0));
  ck_assert_ok(ops->analyse(solver, &grid->matrix));
  fill(grid, -0.1);
  ck_assert_int_eq(ops->factorise(solver, &grid->matrix, NULL, NULL, 1), STATUS_RETRY);
  fill(grid, 0.1);
  ck_assert_ok(ops->factorise(solver, &grid->matrix, NULL, NULL, 1));
  ck_assert_ok(ops->solve(solver, grid->b, grid->x));
  ck_assert_double_lt(relative_residual(grid), 1e-12);
  ops->destroy(solver);
  destroy(grid);
  memory_free(grid);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("front");
  tcase_add_test(cases, solutions_are_exact_or_of_single_precision);
  tcase_add_test(cases, a_small_factor_stays_exact);
  tcase_add_test(cases, solutions_are_the_same_to_the_last_bit_on_any_number_of_threads);
  tcase_add_test(cases, a_matrix_that_is_not_definite_is_refused_and_the_next_one_is_factorised);
  return suite_run("front", cases, 120);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Hierarchies of multigrid: how long one is kept while the matrix moves on, and that no answer shows it.
#include "bar.h"

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

int main(void) {
  TCase *cases = tcase_create("hierarchy");
  tcase_add_test(cases, a_hierarchy_that_is_kept_never_touches_the_answer);
  tcase_add_test(cases, a_hierarchy_is_kept_while_c_changes_little);
  tcase_add_test(cases, multigrid_leaves_what_it_is_told_it_may);
  return suite_run("hierarchy", cases, 60);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors on many threads.
#include "fem/sparse/vector.h"

#include <omp.h>

#include "suite.h"

// Around the edges of lanes, of pieces, of what is divided, and more than the most pieces have.
static const int lengths[] = {0, 1, 7, 8, 9, 1023, 1024, 1025, FEM_VECTOR_LONG, FEM_VECTOR_LONG + 1, 300001};
enum { LENGTHS = sizeof lengths / sizeof *lengths, LONGEST = 300001 };

static double x[LONGEST], y[LONGEST], z[LONGEST];

static void set_values(void) {
  for (int i = 0; i < LONGEST; i++) x[i] = sin(i), y[i] = cos(3.0 * i) + 1e-3, z[i] = NAN;
}

START_TEST(sums_are_right) {
  int n = lengths[_i];
  long double dot = 0, square = 0;
  set_values();
  for (int i = 0; i < n; i++) dot += (long double)x[i] * y[i];
  for (int i = 0; i < n; i++) square += (long double)(x[i] * y[i]) * (x[i] * y[i]);
  // Rounding of n terms of at most 1 each.
  ck_assert_near(fem_vector_dot(n, x, y), (double)dot, 1e-15 * n);
  ck_assert_near(fem_vector_square(n, x, y), (double)square, 1e-15 * n);
  double largest = 0;
  for (int i = 0; i < n; i++) largest = fmax(largest, fabs(x[i]));
  ck_assert(fem_vector_largest(n, x) == largest);
}
END_TEST

START_TEST(sums_have_the_same_bits_on_any_number_of_threads) {
  const int counts[] = {1, 2, 3, 7};
  int n = lengths[_i];
  double dots[4], squares[4];
  set_values();
  for (int k = 0; k < 4; k++) {
    omp_set_num_threads(counts[k]);
    dots[k] = fem_vector_dot(n, x, y);
    squares[k] = fem_vector_square(n, x, y);
    ck_assert(memcmp(&dots[k], &dots[0], sizeof dots[0]) == 0);
    ck_assert(memcmp(&squares[k], &squares[0], sizeof squares[0]) == 0);
  }
}
END_TEST

START_TEST(each_element_is_written_once_by_any_number_of_threads) {
  int n = lengths[_i], wrong = 0;
  for (int threads = 1; threads <= 3; threads++) {
    omp_set_num_threads(threads);
    set_values();
    fem_vector_sum(n, 2, x, -1, y, z);
    for (int i = 0; i < n; i++) wrong += !(fabs(z[i] - (2 * x[i] - y[i])) <= 1e-15);
    fem_vector_multiply(n, x, y, z);
    for (int i = 0; i < n; i++) wrong += z[i] != x[i] * y[i];
    fem_vector_scale(n, -3, x, z);
    for (int i = 0; i < n; i++) wrong += z[i] != -3 * x[i];
    fem_vector_copy(n, y, z);
    ck_assert(memcmp(z, y, (size_t)n * sizeof *z) == 0);
    fem_vector_fill(n, 5, z);
    for (int i = 0; i < n; i++) wrong += z[i] != 5;
    for (int i = n; i < LONGEST; i++) wrong += !isnan(z[i]);
    ck_assert_int_eq(wrong, 0);
  }
}
END_TEST

// SUNDIALS sums into one of the operands.
START_TEST(a_result_may_be_an_operand) {
  int n = lengths[_i], wrong = 0;
  const double factors[3] = {2, 3, -1}, *operands[3] = {z, x, y};
  set_values();
  fem_vector_copy(n, y, z);
  fem_vector_combine(n, 3, factors, operands, z);
  for (int i = 0; i < n; i++) wrong += !(fabs(z[i] - (2 * y[i] + 3 * x[i] - y[i])) <= 1e-14);
  fem_vector_copy(n, x, z);
  fem_vector_sum(n, 1, z, 4, z, z);
  for (int i = 0; i < n; i++) wrong += !(fabs(z[i] - (5 * x[i])) <= 1e-14);
  fem_vector_scale(n, 2, z, z);
  for (int i = 0; i < n; i++) wrong += !(fabs(z[i] - (10 * x[i])) <= 1e-14);
  ck_assert_int_eq(wrong, 0);
}
END_TEST

START_TEST(one_value_that_is_no_number_is_found) {
  int n = lengths[_i];
  const double wrong[3] = {NAN, INFINITY, -INFINITY};
  set_values();
  ck_assert(fem_vector_is_finite(n, x));
  for (int k = 0; k < 3 && n > 0; k++)
    for (int place = 0; place<n; place += n> 2 ? (n - 1) / 2 : 1) {
      double before = x[place];
      x[place] = wrong[k];
      ck_assert(!fem_vector_is_finite(n, x));
      if (k == 0) ck_assert(isnan(fem_vector_dot(n, x, y)));
      x[place] = before;
    }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("vector");
  tcase_add_loop_test(cases, sums_are_right, 0, LENGTHS);
  tcase_add_loop_test(cases, sums_have_the_same_bits_on_any_number_of_threads, 0, LENGTHS);
  tcase_add_loop_test(cases, each_element_is_written_once_by_any_number_of_threads, 0, LENGTHS);
  tcase_add_loop_test(cases, a_result_may_be_an_operand, 0, LENGTHS);
  tcase_add_loop_test(cases, one_value_that_is_no_number_is_found, 0, LENGTHS);
  return suite_run("vector", cases, 10);
}

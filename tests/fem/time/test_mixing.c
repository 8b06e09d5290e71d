// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of an iteration, mixed with those before.
#include "fem/time/newton/mixing.h"

#include <math.h>

#include "suite.h"

enum { N = 3 };

// x ← x + d(x), d = −S (A x − b) with a step matrix S that is off; how far from the solution it is after so
// many.
static double error_after(int iterations, bool is_mixed, const double rates[N]) {
  const double solution[N] = {1, -2, 0.5}, weights[N] = {1, 10, 0.1};
  double x[N] = {0, 0, 0}, d[N], error = 0;
  FemMixing mixing;
  ck_assert_ok(fem_mixing_create(&mixing, N));
  fem_mixing_forget(&mixing);
  for (int k = 0; k < iterations; k++) {
    for (int i = 0; i < N; i++) d[i] = (1 - rates[i]) * (solution[i] - x[i]);
    if (is_mixed) fem_mixing_mix(&mixing, weights, d);
    for (int i = 0; i < N; i++) x[i] += d[i];
    fem_mixing_take(&mixing, 1, d);
  }
  for (int i = 0; i < N; i++) error = suite_larger(fabs(x[i] - solution[i]), error);
  fem_mixing_destroy(&mixing);
  return error;
}

// Rate −1: by itself it never comes to an end.
START_TEST(what_goes_to_and_fro_settles) {
  const double rates[N] = {-1, -1, -1};
  ck_assert_double_ge(error_after(50, false, rates), 1);
  ck_assert_double_le(error_after(3, true, rates), 1e-12);
}
END_TEST

// Two rates take two pairs: one more step than there are rates, and one to see that.
START_TEST(two_rates_are_gone_after_two_pairs) {
  const double rates[N] = {0.5, -0.9, 0.5};
  ck_assert_double_ge(error_after(4, false, rates), 0.1);
  ck_assert_double_le(error_after(4, true, rates), 1e-10);
}
END_TEST

START_TEST(the_first_step_is_left_alone_and_no_number_is_left_out) {
  const double weights[N] = {1, 1, 1};
  double d[N] = {1, 2, 3};
  FemMixing mixing;
  ck_assert_ok(fem_mixing_create(&mixing, N));
  fem_mixing_mix(&mixing, weights, d);
  for (int i = 0; i < N; i++) ck_assert(d[i] == i + 1);
  fem_mixing_take(&mixing, 0.5, d);
  for (int i = 0; i < N; i++) ck_assert(mixing.taken[i] == 0.5 * (i + 1));
  d[0] = NAN;
  fem_mixing_mix(&mixing, weights, d);
  ck_assert(isnan(d[0]) && d[1] == 2 && d[2] == 3);
  fem_mixing_forget(&mixing);
  double again[N] = {3, 2, 1};
  fem_mixing_mix(&mixing, weights, again);
  for (int i = 0; i < N; i++) ck_assert(again[i] == 3 - i);
  fem_mixing_destroy(&mixing);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("mixing");
  tcase_add_test(cases, what_goes_to_and_fro_settles);
  tcase_add_test(cases, two_rates_are_gone_after_two_pairs);
  tcase_add_test(cases, the_first_step_is_left_alone_and_no_number_is_left_out);
  return suite_run("mixing", cases, 60);
}

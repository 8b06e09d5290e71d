// SPDX-License-Identifier: GPL-3.0-or-later
// What every test program shares: how a suite is run, a comparison and a maximum that NaN does not slip
// through, a Status that must be ok.
#ifndef TETLAP_TESTS_SUITE_H
#define TETLAP_TESTS_SUITE_H

#include <check.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "base/random.h"
#include "base/status.h"

#define ck_assert_ok(call)                                                                                   \
  do {                                                                                                       \
    Status ck_status_ = (call);                                                                              \
    ck_assert_msg(ck_status_ == STATUS_OK, "%s: %d: %s", #call, (int)ck_status_, status_message());          \
  } while (0)

// |a − b| ≤ tolerance; NaN fails.
#define ck_assert_near(a, b, tolerance)                                                                      \
  do {                                                                                                       \
    double ck_a_ = (a), ck_b_ = (b), ck_t_ = (tolerance);                                                    \
    ck_assert_msg(fabs(ck_a_ - ck_b_) <= ck_t_, "%s = %.17g, %s = %.17g, differ by %.3g > %.3g", #a, ck_a_,  \
                  #b, ck_b_, fabs(ck_a_ - ck_b_), ck_t_);                                                    \
  } while (0)

// A test that cannot be made here, or asks nothing of this one, says so.
__attribute__((format(printf, 1, 2))) static inline void suite_skip(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  printf("skipped: ");
  vprintf(format, arguments);
  printf("\n");
  va_end(arguments);
}

// Whether this run leaves out that overlap model, and says so: TETLAP_WITHOUT names one. Under valgrind,
// which has one mode of rounding, CGAL's predicates recur without end.
static inline bool suite_leaves_out(const char *model) {
  const char *without = getenv("TETLAP_WITHOUT");
  if (!without || strcmp(without, model) != 0) return false;
  suite_skip("%s: TETLAP_WITHOUT", model);
  return true;
}

// A random number of mean 0 and variance 1 (Box and Muller 1958).
static inline double suite_normal(Random *random) {
  double u = 1 - random_uniform(random), v = random_uniform(random); // u in (0, 1]
  return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

// The larger one; NaN stays, which fmax would drop.
static inline double suite_larger(double a, double b) {
  return isnan(a) || a >= b ? a : b;
}

// Processor time that a test may take, and each program that it starts [s].
static double suite_limit_s;

static inline void suite_limit_time(void) {
  const char *multiplier = getenv("CK_TIMEOUT_MULTIPLIER");
  double seconds = suite_limit_s * (multiplier ? fmax(1, atof(multiplier)) : 1);
  struct rlimit limit = {.rlim_cur = (rlim_t)ceil(seconds), .rlim_max = RLIM_INFINITY};
  setrlimit(RLIMIT_CPU, &limit);
}

// Runs one test case under its name; to be returned from main. `limit_s` is more than enough processor time
// for each test on a common machine. What is enforced is so much more that neither a machine ten times slower
// nor one that others load fails a test; by the clock it is farther off.
static inline int suite_run(const char *name, TCase *test_case, double limit_s) {
  enum { THREADS = 2, SLOWER = 10, BY_THE_CLOCK = 40 };
  Suite *suite = suite_create(name);
  suite_limit_s = THREADS * SLOWER * limit_s;
  tcase_add_checked_fixture(test_case, suite_limit_time, NULL);
  tcase_set_timeout(test_case, BY_THE_CLOCK * limit_s);
  suite_add_tcase(suite, test_case);
  SRunner *runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

#endif

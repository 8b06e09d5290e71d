// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of static scenes beside central differences of whole runs.
#ifndef TETLAP_TESTS_DIFFERENCES_H
#define TETLAP_TESTS_DIFFERENCES_H

#include "equilibria.h"

static inline void run_with(const Asked *asked, const char *key, double value, double values[MOST]) {
  char override[256];
  Answer answer;
  snprintf(override, sizeof override, "%s=%.17g", key, value);
  Asked alone = *asked;
  alone.by[0] = NULL;
  ck_assert_ok(run(&alone, override, &answer));
  ck_assert(answer.is_done);
  memcpy(values, answer.gradient.values, (size_t)answer.goal_count * sizeof *values);
  destroy(&answer);
}

// p ∂g/∂p of every goal by differences of the fourth order.
static inline void differ(const Asked *asked, const char *key, double middle, double size,
                          double shares[MOST]) {
  static const double STEP = 1e-4, places[] = {-2, -1, 1, 2},
                      weights[] = {1.0 / 12, -2.0 / 3, 2.0 / 3, -1.0 / 12};
  memset(shares, 0, MOST * sizeof *shares);
  for (int k = 0; k < 4; k++) {
    double values[MOST] = {0};
    run_with(asked, key, middle + places[k] * STEP * size, values);
    for (int g = 0; g < MOST; g++) shares[g] += weights[k] / STEP * values[g];
  }
}

// Of every quantity by every parameter, relative to g/p.
static inline void check_against_runs(const Asked *asked) {
  static const double TOLERANCE = 1e-6, OF_ZERO = 1e-2; // [m]
  Answer answer;
  ck_assert_ok(run(asked, NULL, &answer));
  ck_assert(answer.is_done);
  ck_assert_double_le(answer.gradient.unbalanced, 1e-10);
  for (int p = 0; p < answer.parameter_count; p++) {
    double shares[MOST], size = answer.values[p] != 0 ? fabs(answer.values[p]) : OF_ZERO;
    differ(asked, asked->by[p], answer.values[p], size, shares);
    for (int g = 0; g < answer.goal_count; g++) {
      double whole = fabs(answer.gradient.values[g]);
      ck_assert_double_gt(whole, 0); // a contact that did not begin has no force
      double found = answer.gradient.derivatives[g * answer.parameter_count + p] * size;
      ck_assert_double_le(answer.gradient.residuals[g], 1e-10);
      ck_assert_double_le(answer.gradient.mismatches[g], 1e-4);
      ck_assert_msg(fabs(found - shares[g]) <= TOLERANCE * whole,
                    "%s by %s: p dg/dp = %.12g, runs %.12g, g = %.6g", asked->of[g], asked->by[p], found,
                    shares[g], answer.gradient.values[g]);
    }
  }
  destroy(&answer);
}

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep/order.h"

#include <math.h>
#include <stdlib.h>

// NaN: no positive number.
static double number_of(const char *text) {
  char *end;
  double value = strtod(text, &end);
  return end != text && !*end && value > 0 ? value : NAN;
}

double app_sweep_order_observed(const char *const values[3], const double f[3]) {
  static const double SAME_RATIO = 0.01;
  double first = log(number_of(values[1]) / number_of(values[0]));
  double second = log(number_of(values[2]) / number_of(values[1]));
  if (!(fabs(first - second) <= SAME_RATIO * fabs(first)) || first == 0) return NAN;
  double share = (f[0] - f[1]) / (f[1] - f[2]);
  return share > 0 && isfinite(share) ? log(share) / fabs(first) : NAN;
}

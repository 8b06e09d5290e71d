// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/law.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdio.h>

// n (n − 1) … times x to what is left, 0 where a factor is: p″ of a line is 0 at 0, too.
static double falling_power(double factor, double x, double exponent) {
  return factor == 0 ? 0 : factor * pow(x, exponent);
}

// P xⁿ with x = d/D.
static ContactLawValue power_of(double pressure, double x, double depth, double n) {
  return (ContactLawValue){pressure * pow(x, n), falling_power(pressure * n / depth, x, n - 1),
                           falling_power(pressure * n * (n - 1) / (depth * depth), x, n - 2)};
}

// P xⁿ ln x.
static ContactLawValue power_by_exponent(double pressure, double x, double depth, double n) {
  if (!(x > 0)) return (ContactLawValue){0, 0, 0};
  double log_x = log(x);
  return (ContactLawValue){pressure * pow(x, n) * log_x, pressure / depth * pow(x, n - 1) * (1 + n * log_x),
                           pressure / (depth * depth) * pow(x, n - 2) * (2 * n - 1 + n * (n - 1) * log_x)};
}

static ContactLawValue power_at(const ContactLaw *law, double depth) {
  double n = law->exponent, x = depth / law->depth;
  switch (law->by) {
  case CONTACT_LAW_BY_PRESSURE:
    return power_of(1, x, law->depth, n);
  case CONTACT_LAW_BY_DEPTH:
    return power_of(-law->pressure * n / law->depth, x, law->depth, n);
  case CONTACT_LAW_BY_EXPONENT:
    return power_by_exponent(law->pressure, x, law->depth, n);
  default:
    return power_of(law->pressure, x, law->depth, n);
  }
}

static ContactLawValue exponential_at(const ContactLaw *law, double depth) {
  double D = law->depth, x = depth / D, grown = exp(x), pressure = law->pressure;
  if (law->by == CONTACT_LAW_BY_DEPTH)
    return (ContactLawValue){-pressure * x / D * grown, -pressure * (1 + x) / (D * D) * grown,
                             -pressure * (2 + x) / (D * D * D) * grown};
  if (law->by == CONTACT_LAW_BY_PRESSURE) pressure = 1;
  return (ContactLawValue){pressure * expm1(x), pressure * grown / D, pressure * grown / (D * D)};
}

// ---- Tables.

static double secant(const ContactLaw *law, int k) {
  const double *row = law->table + 2 * (size_t)k;
  return (row[3] - row[1]) / (row[2] - row[0]);
}

// The slope at row k: of those to its neighbours the harmonic mean, weighed by their lengths; at the ends
// that of the neighbour.
static double slope_at(const ContactLaw *law, int k) {
  if (k == 0) return secant(law, 0);
  if (k == law->table_count - 1) return secant(law, k - 1);
  const double *row = law->table + 2 * (size_t)k;
  double before = secant(law, k - 1), after = secant(law, k);
  if (!(before > 0 && after > 0)) return 0;
  double share = (1 + (row[2] - row[0]) / (row[2] - row[-2])) / 3;
  return before * after / (share * after + (1 - share) * before);
}

// Derivatives by the pressure in the law's row: of the pressure in row k, of the secant behind it, of the
// slope there.
static double pressure_by_row(const ContactLaw *law, int k) {
  return k == law->row ? 1 : 0;
}

static double secant_by_row(const ContactLaw *law, int k) {
  const double *row = law->table + 2 * (size_t)k;
  return (pressure_by_row(law, k + 1) - pressure_by_row(law, k)) / (row[2] - row[0]);
}

static double slope_by_row(const ContactLaw *law, int k) {
  if (k == 0) return secant_by_row(law, 0);
  if (k == law->table_count - 1) return secant_by_row(law, k - 1);
  const double *row = law->table + 2 * (size_t)k;
  double before = secant(law, k - 1), after = secant(law, k);
  double share = (1 + (row[2] - row[0]) / (row[2] - row[-2])) / 3;
  double sum = share * after + (1 - share) * before;
  return (share * after * after * secant_by_row(law, k - 1) +
          (1 - share) * before * before * secant_by_row(law, k)) /
         (sum * sum);
}

// What a cubic between two rows is made of.
typedef struct Knot {
  double pressure, slope;
} Knot;

static Knot knot_at(const ContactLaw *law, int k) {
  if (law->by == CONTACT_LAW_BY_ROW) return (Knot){pressure_by_row(law, k), slope_by_row(law, k)};
  return (Knot){law->table[2 * (size_t)k + 1], slope_at(law, k)};
}

static ContactLawValue table_at(const ContactLaw *law, double depth) {
  int low = 0, high = law->table_count - 1;
  const double *last = law->table + 2 * (size_t)high;
  if (depth >= last[0]) {
    Knot end = knot_at(law, high);
    return (ContactLawValue){end.pressure + end.slope * (depth - last[0]), end.slope, 0};
  }
  while (high - low > 1) {
    int middle = low + (high - low) / 2;
    if (law->table[2 * (size_t)middle] <= depth)
      low = middle;
    else
      high = middle;
  }
  const double *row = law->table + 2 * (size_t)low;
  double span = row[2] - row[0], t = (depth - row[0]) / span;
  Knot begin = knot_at(law, low), end = knot_at(law, low + 1);
  double mean = (end.pressure - begin.pressure) / span, from = begin.slope, to = end.slope;
  double square = 3 * mean - 2 * from - to,
         cube = from + to - 2 * mean; // Hermite's cubic in t, over the span
  return (ContactLawValue){begin.pressure + span * t * (from + t * (square + t * cube)),
                           from + t * (2 * square + 3 * t * cube), (2 * square + 6 * t * cube) / span};
}

ContactLawValue contact_law_at(const ContactLaw *law, double depth) {
  if (depth < 0) {
    ContactLawValue mirrored = contact_law_at(law, -depth);
    return (ContactLawValue){-mirrored.pressure, mirrored.slope, -mirrored.curve};
  }
  switch (law->kind) {
  case CONTACT_LAW_POWER:
    return power_at(law, depth);
  case CONTACT_LAW_EXPONENTIAL:
    return exponential_at(law, depth);
  case CONTACT_LAW_TABLE:
    return table_at(law, depth);
  case CONTACT_LAW_FORMULA: {
    ExpressionValue value = expression_eval(law->formula, depth);
    return (ContactLawValue){value.value, value.rate, value.curve};
  }
  case CONTACT_LAW_LINEAR:
    break;
  }
  assert(!"a linear law has a stiffness");
  return (ContactLawValue){0, 0, 0};
}

void contact_law_describe(const ContactLaw *law, char *text, size_t size) {
  switch (law->kind) {
  case CONTACT_LAW_LINEAR:
    snprintf(text, size, "linear");
    break;
  case CONTACT_LAW_POWER:
    snprintf(text, size, "p = %g Pa (d/%g m)^%g", law->pressure, law->depth, law->exponent);
    break;
  case CONTACT_LAW_EXPONENTIAL:
    snprintf(text, size, "p = %g Pa (exp(d/%g m) - 1)", law->pressure, law->depth);
    break;
  case CONTACT_LAW_TABLE:
    snprintf(text, size, "table of %d rows up to %g Pa at d = %g m", law->table_count,
             law->table[2 * law->table_count - 1], law->table[2 * law->table_count - 2]);
    break;
  case CONTACT_LAW_FORMULA:
    snprintf(text, size, "p = %s", law->formula->text);
    break;
  }
}

// ---- Checks.

// The rows of a table, which the checks below would step over.
static bool check_table(const ContactLaw *law, char *why, size_t size) {
  const double *rows = law->table;
  if (law->table_count < 2 || rows[0] != 0 || rows[1] != 0) {
    snprintf(why, size, "the table must begin with the row [0, 0], and have another; it begins with [%g, %g]",
             rows[0], rows[1]);
    return false;
  }
  for (int k = 1; k < law->table_count; k++) {
    if (rows[2 * k + 1] > rows[2 * k - 1]) continue;
    snprintf(why, size, "the pressure %g Pa of row %d is not above %g Pa of the row before; it must increase",
             rows[2 * k + 1], k, rows[2 * k - 1]);
    return false;
  }
  return true;
}

// Depths that are looked at, evenly in the logarithm up to the deepest.
enum { LOOK_COUNT = 400 };

bool contact_law_check(const ContactLaw *law, double deepest, double highest, char *why, size_t size) {
  if (law->kind == CONTACT_LAW_TABLE && !check_table(law, why, size)) return false;
  double start = contact_law_at(law, 0).pressure, last = fmin(start, 0);
  for (int k = 0; k < LOOK_COUNT && last < highest; k++) {
    double depth = deepest * pow(DBL_EPSILON, 1 - (double)k / (LOOK_COUNT - 1));
    ContactLawValue value = contact_law_at(law, depth);
    if (!isfinite(value.pressure + value.slope + value.curve))
      snprintf(why, size,
               "at a depth of %.3g m the law gives no finite pressure; it must up to the size of "
               "the bodies, %.3g m, or to a pressure of %.3g Pa",
               depth, deepest, highest);
    else if (value.slope < 0 || value.pressure < last)
      snprintf(why, size, "at a depth of %.3g m the pressure falls, by %.3g Pa/m; it must not fall", depth,
               value.slope);
    else {
      last = value.pressure;
      continue;
    }
    return false;
  }
  if (last > 0 && fabs(start) <= DBL_EPSILON * last) return true;
  if (start != 0)
    snprintf(why, size, "without overlap the pressure is %g Pa; it must be 0", start);
  else
    snprintf(why, size, "the pressure is 0 up to a depth of %.3g m, the size of the bodies", deepest);
  return false;
}

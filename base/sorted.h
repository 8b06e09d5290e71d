// SPDX-License-Identifier: Apache-2.0
// Numbers in ascending order.
#ifndef TETLAP_BASE_SORTED_H
#define TETLAP_BASE_SORTED_H

#include <stddef.h>
#include <stdlib.h>

static inline int sorted_compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

// Sorts them where they are. None may be NaN.
static inline void sorted_values(double *values, size_t count) {
  if (count > 0) qsort(values, count, sizeof *values, sorted_compare);
}

// Of sorted ones, at least one: the middle one, or the mean of the two in the middle.
static inline double sorted_median(const double *values, size_t count) {
  return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/table.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

static const double *row_of(FemTable table, int k) {
  return table.rows + (size_t)table.width * (size_t)k;
}

// The last row at or before `time`; −1: all come later.
static int find_row(FemTable table, double time) {
  int low = -1, high = table.count; // rows[low] ≤ time < rows[high]
  while (high - low > 1) {
    int middle = low + (high - low) / 2;
    if (row_of(table, middle)[0] <= time)
      low = middle;
    else
      high = middle;
  }
  return low;
}

void fem_table_eval(FemTable table, double time, double *values, double *rates) {
  int k = find_row(table, time);
  bool is_between = k >= 0 && k + 1 < table.count;
  const double *from = row_of(table, k < 0 ? 0 : k), *to = is_between ? row_of(table, k + 1) : from;
  double span = is_between ? to[0] - from[0] : 1, share = is_between ? (time - from[0]) / span : 0;
  for (int c = 1; c < table.width; c++) {
    values[c - 1] = from[c] + share * (to[c] - from[c]);
    rates[c - 1] = (to[c] - from[c]) / span;
  }
}

double fem_table_next_row(FemTable table, double time) {
  int k = find_row(table, time) + 1;
  return k < table.count ? row_of(table, k)[0] : INFINITY;
}

static bool is_flat(FemTable table, int k) {
  for (int c = 1; c < table.width; c++)
    if (row_of(table, k + 1)[c] != row_of(table, k)[c]) return false;
  return true;
}

double fem_table_next_change(FemTable table, double time) {
  int last = table.count - 1, k = find_row(table, time);
  if (k >= last) return INFINITY;
  if (k >= 0 && !is_flat(table, k)) return time;
  k = k < 0 ? 0 : k;
  while (k < last && is_flat(table, k)) k++;
  return k < last ? row_of(table, k)[0] : INFINITY;
}

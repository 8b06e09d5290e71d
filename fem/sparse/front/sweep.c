// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/front/sweep.h"

// Columns that are taken together: their rows are read once.
enum { TOGETHER = 4 };

static const double *column_of(const FemSweepPanel *panel, int column) {
  return panel->values + (size_t)column * (size_t)panel->height;
}

static void subtract_one(const double *a, int first, int last, double x, double *y) {
  for (int i = first; i < last; i++) y[i - first] -= a[i] * x;
}

void fem_sweep_subtract(const FemSweepPanel *panel, int begin, int end, int first, int last, const double *x,
                        double *y) {
  int j = begin;
  for (; j + TOGETHER <= end; j += TOGETHER) {
    const double *restrict a = column_of(panel, j) + first, *restrict b = column_of(panel, j + 1) + first,
                           *restrict c = column_of(panel, j + 2) + first,
                           *restrict d = column_of(panel, j + 3) + first;
    double *restrict to = y;
    for (int i = 0; i < last - first; i++)
      to[i] -= a[i] * x[j] + b[i] * x[j + 1] + (c[i] * x[j + 2] + d[i] * x[j + 3]);
  }
  for (; j < end; j++) subtract_one(column_of(panel, j), first, last, x[j], y);
}

void fem_sweep_forward(const FemSweepPanel *panel, int begin, int end, double *x) {
  for (int j = begin; j < end; j += TOGETHER) {
    int last = j + TOGETHER < end ? j + TOGETHER : end;
    for (int k = j; k < last; k++) {
      const double *column = column_of(panel, k);
      x[k] /= column[k];
      for (int i = k + 1; i < last; i++) x[i] -= column[i] * x[k];
    }
    if (last < end) fem_sweep_subtract(panel, j, last, last, end, x, x + last);
  }
}

static double dot(const double *a, const double *y, int count) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int i = 0; i < count; i++) sum += a[i] * y[i];
  return sum;
}

void fem_sweep_project(const FemSweepPanel *panel, int begin, int end, int first, int last, const double *y,
                       double *x) {
  int j = begin, count = last - first;
  for (; j + TOGETHER <= end; j += TOGETHER) {
    const double *a = column_of(panel, j) + first, *b = column_of(panel, j + 1) + first,
                 *c = column_of(panel, j + 2) + first, *d = column_of(panel, j + 3) + first;
    double p = 0, q = 0, r = 0, s = 0;
#pragma omp simd reduction(+ : p, q, r, s)
    for (int i = 0; i < count; i++) p += a[i] * y[i], q += b[i] * y[i], r += c[i] * y[i], s += d[i] * y[i];
    x[j] -= p, x[j + 1] -= q, x[j + 2] -= r, x[j + 3] -= s;
  }
  for (; j < end; j++) x[j] -= dot(column_of(panel, j) + first, y, count);
}

void fem_sweep_backward(const FemSweepPanel *panel, int begin, int end, double *x) {
  for (int j = begin + (end - begin - 1) / TOGETHER * TOGETHER; j >= begin; j -= TOGETHER) {
    int last = j + TOGETHER < end ? j + TOGETHER : end;
    if (last < end) fem_sweep_project(panel, j, last, last, end, x + last, x);
    for (int k = last - 1; k >= j; k--) {
      const double *column = column_of(panel, k);
      for (int i = k + 1; i < last; i++) x[k] -= column[i] * x[i];
      x[k] /= column[k];
    }
  }
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/vector.h"

#include <math.h>

// A sum has pieces of PIECE numbers, or MOST larger ones.
enum { PIECE = 1024, MOST = 256 };

// Short vectors enter no parallel region: one of one thread costs as much as a thousand numbers.
#define EACH(i, n, statement)                                                                                \
  if ((n) > FEM_VECTOR_LONG) {                                                                               \
    _Pragma("omp parallel for simd schedule(static)") for (int i = 0; i < (n); i++) statement;               \
  } else {                                                                                                   \
    for (int i = 0; i < (n); i++) statement;                                                                 \
  }

void fem_vector_fill(int n, double a, double *y) {
  EACH(i, n, y[i] = a)
}

void fem_vector_copy(int n, const double *x, double *y) {
  if (x == y) return;
  EACH(i, n, y[i] = x[i])
}

void fem_vector_scale(int n, double a, const double *x, double *y) {
  EACH(i, n, y[i] = a * x[i])
}

void fem_vector_multiply(int n, const double *x, const double *y, double *z) {
  EACH(i, n, z[i] = x[i] * y[i])
}

void fem_vector_sum(int n, double a, const double *x, double b, const double *y, double *z) {
  EACH(i, n, z[i] = a * x[i] + b * y[i])
}

// A piece at a time, so that it stays in the cache while the vectors are added to it.
static void combine_piece(int begin, int end, int count, const double *a, const double *const *x, double *z) {
  double sum[PIECE];
  for (int i = begin; i < end; i++) sum[i - begin] = a[0] * x[0][i];
  for (int k = 1; k < count; k++)
    for (int i = begin; i < end; i++) sum[i - begin] += a[k] * x[k][i];
  for (int i = begin; i < end; i++) z[i] = sum[i - begin];
}

void fem_vector_combine(int n, int count, const double *a, const double *const *x, double *z) {
  if (n <= FEM_VECTOR_LONG) {
    for (int begin = 0; begin < n; begin += PIECE)
      combine_piece(begin, begin + PIECE < n ? begin + PIECE : n, count, a, x, z);
    return;
  }
#pragma omp parallel for schedule(static)
  for (int begin = 0; begin < n; begin += PIECE)
    combine_piece(begin, begin + PIECE < n ? begin + PIECE : n, count, a, x, z);
}

// Partial sums that a compiler keeps side by side.
enum { LANES = 8 };

static double add_lanes(const double sums[LANES]) {
  double sum = 0;
  for (int k = 0; k < LANES; k++) sum += sums[k];
  return sum;
}

static double dot_piece(int n, const double *x, const double *y) {
  double sums[LANES] = {0}, rest = 0;
  int i = 0;
  for (; i + LANES <= n; i += LANES)
    for (int k = 0; k < LANES; k++) sums[k] += x[i + k] * y[i + k];
  for (; i < n; i++) rest += x[i] * y[i];
  return add_lanes(sums) + rest;
}

static double square_piece(int n, const double *x, const double *w) {
  double sums[LANES] = {0}, rest = 0;
  int i = 0;
  for (; i + LANES <= n; i += LANES)
    for (int k = 0; k < LANES; k++) sums[k] += x[i + k] * w[i + k] * (x[i + k] * w[i + k]);
  for (; i < n; i++) rest += x[i] * w[i] * (x[i] * w[i]);
  return add_lanes(sums) + rest;
}

static double larger(double a, double b) {
  return b > a ? b : a;
}

static double largest_piece(int n, const double *x, const double *unused) {
  double most[LANES] = {0}, largest = 0;
  int i = 0;
  (void)unused;
  for (; i + LANES <= n; i += LANES)
    for (int k = 0; k < LANES; k++) most[k] = larger(most[k], fabs(x[i + k]));
  for (; i < n; i++) largest = larger(largest, fabs(x[i]));
  for (int k = 0; k < LANES; k++) largest = larger(largest, most[k]);
  return largest;
}

typedef double PieceOf(int n, const double *x, const double *y);

// Of each piece; how many there are.
static int find_pieces(int n, PieceOf *piece_of, const double *x, const double *y, double partial[MOST]) {
  int size = n > MOST * PIECE ? (n - 1) / MOST + 1 : PIECE, count = (n + size - 1) / size;
  if (n <= FEM_VECTOR_LONG) {
    for (int p = 0; p < count; p++)
      partial[p] = piece_of(p + 1 < count ? size : n - p * size, x + p * size, y + p * size);
    return count;
  }
#pragma omp parallel for schedule(static)
  for (int p = 0; p < count; p++)
    partial[p] = piece_of(p + 1 < count ? size : n - p * size, x + p * size, y + p * size);
  return count;
}

static double sum_pieces(int n, PieceOf *piece_of, const double *x, const double *y) {
  double partial[MOST], sum = 0;
  int count = find_pieces(n, piece_of, x, y, partial);
  for (int p = 0; p < count; p++) sum += partial[p];
  return sum;
}

double fem_vector_dot(int n, const double *x, const double *y) {
  return sum_pieces(n, dot_piece, x, y);
}

double fem_vector_square(int n, const double *x, const double *w) {
  return sum_pieces(n, square_piece, x, w);
}

double fem_vector_largest(int n, const double *x) {
  double partial[MOST], largest = 0;
  int count = find_pieces(n, largest_piece, x, x, partial);
  for (int p = 0; p < count; p++) largest = larger(largest, partial[p]);
  return largest;
}

// x − x is 0 for a number, NaN otherwise.
bool fem_vector_is_finite(int n, const double *x) {
  int bad = 0;
  if (n <= FEM_VECTOR_LONG) {
    for (int i = 0; i < n; i++) bad |= !(x[i] - x[i] == 0);
    return !bad;
  }
#pragma omp parallel for simd schedule(static) reduction(| : bad)
  for (int i = 0; i < n; i++) bad |= !(x[i] - x[i] == 0);
  return !bad;
}

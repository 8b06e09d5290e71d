// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/shape/definite.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/vec3.h"
#include "contact/limits.h"

enum { N = CONTACT_DEFINITE_SIZE };

static double longest_edge(const double tet[12]) {
  double longest = 0;
  for (int v = 0; v < 4; v++)
    for (int w = 0; w < v; w++)
      longest = fmax(longest, vec3_length(vec3_sub(vec3_at(tet + 3 * v), vec3_at(tet + 3 * w))));
  return longest;
}

void contact_definite_differentiate(ContactDefiniteGradient *gradient, const void *self, const double tet[12],
                                    double matrix[144]) {
  static const double STEP = 1e-5; // not chosen: ε^⅓, where rounding is what a difference omits
  double step = STEP * longest_edge(tet), moved[12], high[12], low[12];
  for (int c = 0; c < N; c++) {
    memcpy(moved, tet, sizeof moved);
    moved[c] = tet[c] + step;
    gradient(self, moved, high);
    moved[c] = tet[c] - step;
    gradient(self, moved, low);
    for (int r = 0; r < N; r++) matrix[N * r + c] = (high[r] - low[r]) / (2 * step);
  }
  for (int r = 0; r < N; r++)
    for (int c = 0; c < r; c++)
      matrix[N * r + c] = matrix[N * c + r] = 0.5 * (matrix[N * r + c] + matrix[N * c + r]);
}

static double largest_diagonal(const double matrix[144]) {
  double largest = 0;
  for (int i = 0; i < N; i++) largest = fmax(largest, fabs(matrix[N * i + i]));
  return largest;
}

// Whether matrix + shift has a Cholesky factor.
static bool is_definite(const double matrix[144], double shift) {
  double factor[144];
  for (int i = 0; i < N; i++)
    for (int j = 0; j <= i; j++) {
      double sum = matrix[N * i + j] + (i == j ? shift : 0);
      for (int k = 0; k < j; k++) sum -= factor[N * i + k] * factor[N * j + k];
      if (i == j && !(sum > 0)) return false;
      factor[N * i + j] = i == j ? sqrt(sum) : sum / factor[N * j + j];
    }
  return true;
}

// matrix ← Jᵀ matrix J, vectors ← vectors J, J the turn of coordinates p and q that makes entry (p, q) 0.
static void turn(double matrix[144], double vectors[144], int p, int q) {
  double entry = matrix[N * p + q];
  if (entry == 0) return;
  double ratio = (matrix[N * q + q] - matrix[N * p + p]) / (2 * entry);
  double tangent = copysign(1, ratio) / (fabs(ratio) + hypot(ratio, 1));
  double c = 1 / hypot(tangent, 1), s = tangent * c;
  for (int k = 0; k < N; k++) {
    double a = matrix[N * k + p], b = matrix[N * k + q], u = vectors[N * k + p], v = vectors[N * k + q];
    matrix[N * k + p] = c * a - s * b, matrix[N * k + q] = s * a + c * b;
    vectors[N * k + p] = c * u - s * v, vectors[N * k + q] = s * u + c * v;
  }
  for (int k = 0; k < N; k++) {
    double a = matrix[N * p + k], b = matrix[N * q + k];
    matrix[N * p + k] = c * a - s * b, matrix[N * q + k] = s * a + c * b;
  }
}

// Jacobi's method: eigenvalues on the diagonal, eigenvectors in columns. It converges quadratically; sweeps
// are counted for what is no number.
static void diagonalise(double matrix[144], double vectors[144]) {
  memset(vectors, 0, 144 * sizeof *vectors);
  for (int i = 0; i < N; i++) vectors[N * i + i] = 1;
  for (int sweep = 0; sweep < N * N; sweep++) {
    double off = 0;
    for (int p = 0; p < N; p++)
      for (int q = p + 1; q < N; q++) off = fmax(off, fabs(matrix[N * p + q]));
    if (!(off > N * DBL_EPSILON * largest_diagonal(matrix))) return;
    for (int p = 0; p < N; p++)
      for (int q = p + 1; q < N; q++) turn(matrix, vectors, p, q);
  }
}

void contact_definite_mend(double matrix[144]) {
  double largest = largest_diagonal(matrix), values[144], vectors[144];
  if (!(largest > 0) || is_definite(matrix, CONTACT_FLAT * largest)) return;
  memcpy(values, matrix, sizeof values);
  diagonalise(values, vectors);
  for (int i = 0; i < N; i++)
    for (int j = 0; j <= i; j++) {
      double sum = 0;
      for (int k = 0; k < N; k++) sum += fmax(values[N * k + k], 0) * vectors[N * i + k] * vectors[N * j + k];
      matrix[N * i + j] = matrix[N * j + i] = sum;
    }
}

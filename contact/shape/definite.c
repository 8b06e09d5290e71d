// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/shape/definite.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { N = CONTACT_DEFINITE_SIZE };

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

void contact_definite_mend(double matrix[144], double tolerance) {
  double largest = largest_diagonal(matrix), values[144], vectors[144];
  if (!(largest > 0) || is_definite(matrix, tolerance * largest)) return;
  memcpy(values, matrix, sizeof values);
  diagonalise(values, vectors);
  for (int i = 0; i < N; i++)
    for (int j = 0; j <= i; j++) {
      double sum = 0;
      for (int k = 0; k < N; k++) sum += fmax(values[N * k + k], 0) * vectors[N * i + k] * vectors[N * j + k];
      matrix[N * i + j] = matrix[N * j + i] = sum;
    }
}

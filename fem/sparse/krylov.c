// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/krylov.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "fem/sparse/vector.h"

Status fem_krylov_create(FemKrylov *krylov, int count) {
  size_t n = (size_t)count;
  krylov->count = count;
  krylov->basis = memory_zeroed((FEM_KRYLOV_MOST + 1) * n, sizeof(double));
  krylov->image = memory_zeroed(n, sizeof(double));
  return krylov->basis && krylov->image ? STATUS_OK : status_no_memory("GMRES");
}

void fem_krylov_destroy(FemKrylov *krylov) {
  memory_free(krylov->basis);
  memory_free(krylov->image);
  *krylov = (FemKrylov){0};
}

// The Hessenberg matrix, turned to a triangle column by column, with the right side.
typedef struct Triangle {
  double h[FEM_KRYLOV_MOST][FEM_KRYLOV_MOST + 1], cosine[FEM_KRYLOV_MOST], sine[FEM_KRYLOV_MOST];
  double right[FEM_KRYLOV_MOST + 1];
} Triangle;

static double *direction(const FemKrylov *krylov, int k) {
  return krylov->basis + (size_t)krylov->count * (size_t)k;
}

static double length_of(const FemKrylov *krylov, const double *x) {
  return sqrt(fem_vector_dot(krylov->count, x, x));
}

static void turn(Triangle *triangle, int k) {
  double *h = triangle->h[k];
  for (int i = 0; i < k; i++) {
    double upper = triangle->cosine[i] * h[i] + triangle->sine[i] * h[i + 1];
    h[i + 1] = triangle->cosine[i] * h[i + 1] - triangle->sine[i] * h[i];
    h[i] = upper;
  }
  double size = hypot(h[k], h[k + 1]);
  triangle->cosine[k] = size > 0 ? h[k] / size : 1;
  triangle->sine[k] = size > 0 ? h[k + 1] / size : 0;
  h[k] = size, h[k + 1] = 0;
  triangle->right[k + 1] = -triangle->sine[k] * triangle->right[k];
  triangle->right[k] *= triangle->cosine[k];
}

// The next direction, made orthogonal twice to those before; its length is the last entry of the column.
static Status extend(FemKrylov *krylov, Triangle *triangle, int k) {
  double *next = direction(krylov, k + 1), *h = triangle->h[k];
  TRY(krylov->precondition(krylov->self, direction(krylov, k), krylov->image));
  TRY(krylov->multiply(krylov->self, krylov->image, next));
  memset(h, 0, sizeof triangle->h[k]);
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i <= k; i++) {
      const double *other = direction(krylov, i);
      double along = fem_vector_dot(krylov->count, next, other);
      h[i] += along;
      for (int j = 0; j < krylov->count; j++) next[j] -= along * other[j];
    }
  h[k + 1] = length_of(krylov, next);
  for (int j = 0; j < krylov->count && h[k + 1] > 0; j++) next[j] /= h[k + 1];
  turn(triangle, k);
  return STATUS_OK;
}

static Status combine(FemKrylov *krylov, Triangle *triangle, int count, double *x) {
  double share[FEM_KRYLOV_MOST], *sum = direction(krylov, count); // no longer needed
  memset(sum, 0, (size_t)krylov->count * sizeof *sum);
  for (int k = count - 1; k >= 0; k--) {
    share[k] = triangle->right[k];
    for (int i = k + 1; i < count; i++) share[k] -= triangle->h[i][k] * share[i];
    share[k] = triangle->h[k][k] > 0 ? share[k] / triangle->h[k][k] : 0;
    for (int j = 0; j < krylov->count; j++) sum[j] += share[k] * direction(krylov, k)[j];
  }
  return krylov->precondition(krylov->self, sum, x);
}

static double remainder_of(const FemKrylov *krylov, const double *b, const double *product) {
  double sum = 0;
  for (int j = 0; j < krylov->count; j++) sum += (b[j] - product[j]) * (b[j] - product[j]);
  return sqrt(sum);
}

Status fem_krylov_solve(FemKrylov *krylov, const double *b, double tolerance, double *x, double *residual) {
  Triangle triangle;
  double whole = length_of(krylov, b), estimate = 1;
  int count = 0;
  if (residual) *residual = 0;
  krylov->directions = 0;
  memset(x, 0, (size_t)krylov->count * sizeof *x);
  if (whole == 0) return STATUS_OK;
  triangle.right[0] = whole;
  for (int j = 0; j < krylov->count; j++) krylov->basis[j] = b[j] / whole;
  while (count < FEM_KRYLOV_MOST && estimate > tolerance) {
    TRY(extend(krylov, &triangle, count));
    estimate = fabs(triangle.right[++count]) / whole;
  }
  krylov->directions = count;
  TRY(combine(krylov, &triangle, count, x));
  if (residual) {
    TRY(krylov->multiply(krylov->self, x, krylov->image));
    *residual = remainder_of(krylov, b, krylov->image) / whole;
  }
  if (isfinite(estimate) && (!residual || isfinite(*residual))) return STATUS_OK;
  return status_fail(STATUS_SOLVER, "GMRES met what is not a number");
}

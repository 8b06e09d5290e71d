// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/front/dense.h"

#include <cblas.h>

void dpotrf_(const char *part, const int *n, double *a, const int *stride, int *info);

bool fem_dense_factorise(int n, FemDense a) {
  int info = 0;
  dpotrf_("L", &n, a.at, &a.stride, &info);
  return info == 0;
}

void fem_dense_divide(int m, int n, FemDense l, FemDense b) {
  cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, m, n, 1, l.at, l.stride, b.at,
              b.stride);
}

void fem_dense_subtract(int m, int n, int k, FemDense a, FemDense b, FemDense c) {
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, m, n, k, -1, a.at, a.stride, b.at, b.stride, 1, c.at,
              c.stride);
}

void fem_dense_subtract_square(int n, int k, FemDense a, FemDense c) {
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, n, k, -1, a.at, a.stride, 1, c.at, c.stride);
}

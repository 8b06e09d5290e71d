// SPDX-License-Identifier: GPL-3.0-or-later
// Dense matrices of a front, a column after the other, by BLAS and LAPACK on the calling thread alone.
#ifndef TETLAP_FEM_SPARSE_FRONT_DENSE_H
#define TETLAP_FEM_SPARSE_FRONT_DENSE_H

#include <stdbool.h>

// A part of a matrix: `stride` numbers from a column to the next.
typedef struct FemDense {
  double *at;
  int stride;
} FemDense;

// The lower triangle of A (n, n) becomes L of A = L Lᵀ. False: not positive definite.
bool fem_dense_factorise(int n, FemDense a);
// B (m, n) becomes B L⁻ᵀ, L (n, n) lower.
void fem_dense_divide(int m, int n, FemDense l, FemDense b);
// C (m, n) −= A (m, k) Bᵀ, B (n, k).
void fem_dense_subtract(int m, int n, int k, FemDense a, FemDense b, FemDense c);
// The lower triangle of C (n, n) −= A Aᵀ, A (n, k).
void fem_dense_subtract_square(int n, int k, FemDense a, FemDense c);

#endif

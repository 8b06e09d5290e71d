// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors of numbers, divided among the threads that OpenMP has where they are long. Sums are made piece by
// piece and the pieces added in their order; which pieces there are depends on the length alone, so all bits
// are the same on any number of threads. The result of an element-wise operation may be one of its operands.
#ifndef TETLAP_FEM_SPARSE_VECTOR_H
#define TETLAP_FEM_SPARSE_VECTOR_H

#include <stdbool.h>

// Shorter ones are done by the calling thread: to wake another takes as long, some 50 µs.
enum { FEM_VECTOR_LONG = 65536 };

void fem_vector_fill(int n, double a, double *y);                             // y = a
void fem_vector_copy(int n, const double *x, double *y);                      // y = x
void fem_vector_scale(int n, double a, const double *x, double *y);           // y = a x
void fem_vector_multiply(int n, const double *x, const double *y, double *z); // z_i = x_i y_i
// z = a x + b y
void fem_vector_sum(int n, double a, const double *x, double b, const double *y, double *z);
// z = Σ_k a_k x_k over `count` vectors, added from the first to the last.
void fem_vector_combine(int n, int count, const double *a, const double *const *x, double *z);

double fem_vector_dot(int n, const double *x, const double *y);    // x · y
double fem_vector_square(int n, const double *x, const double *w); // Σ (x_i w_i)²
double fem_vector_largest(int n, const double *x);                 // max |x_i|; NaN are passed over
bool fem_vector_is_finite(int n, const double *x);                 // no NaN and no infinity among them

#endif

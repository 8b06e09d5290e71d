// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers of a factor L of A = L Lᵀ by fronts, and solutions by it. Domains and large fronts' pieces go
// to the threads that OpenMP has; which piece is added when depends on the tree alone, so all bits are the
// same on any number of threads.
#ifndef TETLAP_FEM_SPARSE_FRONT_FACTOR_H
#define TETLAP_FEM_SPARSE_FRONT_FACTOR_H

#include "fem/sparse/front/tree.h"

// Numbers that there is room for.
typedef struct FemFrontRoom {
  size_t values, rough, updates, kept, stack, x, carried;
} FemFrontRoom;

typedef struct FemFrontFactor {
  const FemFrontTree *tree; // borrowed
  double *values;           // panels                                          (tree->value_count)
  float *rough;             // the same in single precision; NULL: none        (tree->value_count)
  bool is_rough;            // of the solution that goes on
  double **updates;         // what a front leaves to its parent, while both are made (front_count)
  double *kept;             // room of all that outlives a domain; NULL: too much  (tree->left_count)
  double **stacks;          // of each thread: updates within a domain         (stack_count), (tree->stack)
  int stack_count;
  double *x;       // in the order of elimination                              (tree->size)
  double *carried; // of the rows below of each front                          (tree->carried_count)
  FemFrontRoom room;
} FemFrontFactor;

// Of a zeroed factor, or of one of another tree, whose memory is used again where it is large enough: pages
// that are got anew cost as much as a factor. `may_be_rough`: a large one is kept in single precision, too.
Status fem_front_factor_lay_out(FemFrontFactor *factor, const FemFrontTree *tree, bool may_be_rough);
void fem_front_factor_destroy(FemFrontFactor *factor); // also a zeroed one

// From the values of the matrix whose places the tree has. STATUS_RETRY: not positive definite.
Status fem_front_factor_make(FemFrontFactor *factor, const double *values);

// x = A⁻¹ b; they may be the same.
void fem_front_factor_solve(FemFrontFactor *factor, const double *b, double *x);
// The same by the factor in single precision, if there is one, symmetric and positive definite like A⁻¹: a
// preconditioner.
void fem_front_factor_solve_roughly(FemFrontFactor *factor, const double *b, double *x);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Conjugate gradients for a symmetric positive definite matrix, with whatever preconditioner P the caller
// has. Converged when √(rᵀ P r) ≤ tolerance · √(bᵀ P b), or as soon as |r| ≤ tolerance · |b|, which costs one
// application of P less. The result does not depend on the number of threads. Where ranks share the matrix,
// each has all of the vectors.
#ifndef TETLAP_FEM_SPARSE_CG_H
#define TETLAP_FEM_SPARSE_CG_H

#include <stddef.h>

#include "fem/sparse/matrix.h"

typedef struct FemCg {
  int size;
  double *residual, *direction, *image; // r, p, A p                 (size)
  double *preconditioned;               // P r                       (size)
} FemCg;

typedef struct FemCgProblem {
  const FemMatrix *matrix;
  Status (*precondition)(void *self, const double *r, double *z); // z = P r, symmetric positive definite
  void *self;
  const char *name; // of the solver, for messages
  double tolerance;
  bool by_residual; // converged by |r|
  int limit;        // iterations
} FemCgProblem;

// STATUS_RETRY of fem_cg_solve comes from one of these.
typedef enum FemCgEnd { FEM_CG_CONVERGED, FEM_CG_LIMIT, FEM_CG_INDEFINITE } FemCgEnd;

// A zeroed one, and one whose creation failed, can be destroyed.
Status fem_cg_create(FemCg *cg, int size);
void fem_cg_destroy(FemCg *cg);

// x = A⁻¹ b; adds to `*iterations`. STATUS_RETRY: the limit is reached, or A or P is not positive definite;
// `*end` says which, the message does not.
Status fem_cg_solve(FemCg *cg, const FemCgProblem *problem, const double *b, double *x, long long *iterations,
                    FemCgEnd *end);

#endif

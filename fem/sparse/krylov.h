// SPDX-License-Identifier: GPL-3.0-or-later
// A linear system that is not symmetric, solved with the factor of one that is near it: GMRES (Saad and
// Schultz 1986), preconditioned from the right, so that the residual is that of the system itself.
#ifndef TETLAP_FEM_SPARSE_KRYLOV_H
#define TETLAP_FEM_SPARSE_KRYLOV_H

#include "base/status.h"

typedef struct FemKrylov {
  int count;                                                      // n
  void *self;                                                     // handed to both, borrowed
  Status (*multiply)(void *self, const double *x, double *y);     // y = A x
  Status (*precondition)(void *self, const double *x, double *y); // y ≈ A⁻¹ x
  double *basis, *image; // owned                    (FEM_KRYLOV_MOST + 1, n), (n)
  int directions;        // that the last solution took
} FemKrylov;

enum { FEM_KRYLOV_MOST = 80 };

Status fem_krylov_create(FemKrylov *krylov, int count); // STATUS_MEMORY
void fem_krylov_destroy(FemKrylov *krylov);             // also of a zeroed one

// x with |b − A x| ≤ tolerance |b| by GMRES' own estimate, or the best of FEM_KRYLOV_MOST
// directions; where A or the preconditioner is singular, the estimate may be 0 and x wrong. `*residual`:
// |b − A x| / |b| by one more product, for the caller to judge; NULL: not needed. STATUS_SOLVER: it, or the
// estimate, is not a number.
Status fem_krylov_solve(FemKrylov *krylov, const double *b, double tolerance, double *x, double *residual);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The product of the matrix that ranks share with a vector of rows, without a copy of the matrix. Each rank
// multiplies what it has added, and what vertices at the border share is sent to and fro by PETSc.
#ifndef TETLAP_DIST_PRODUCT_H
#define TETLAP_DIST_PRODUCT_H

#include <petscmat.h>

#include "dist/reach.h"

typedef struct DistProduct {
  const DistRows *rows;    // borrowed
  const DistReach *reach;  // borrowed
  const FemMatrix *matrix; // borrowed, of the last dist_product_set
  double alone;            // of rows that no unknown has
  double *x, *y;           // scratch by unknown, borrowed and its own           (size)
  Vec others;              // values at unknowns of other ranks, as in `reach`
  VecScatter scatter;      // from a vector of rows to those
  Mat shell;               // what PETSc multiplies by
} DistProduct;

// `like`: a vector of rows. `x`: scratch, of as many numbers as there are unknowns at least. All that is
// given must stay. By all ranks. A zeroed one can be destroyed; code of PETSc, or PETSC_ERR_MEM.
PetscErrorCode dist_product_create(DistProduct *product, const DistRows *rows, const DistReach *reach,
                                   Vec like, double *x);
void dist_product_destroy(DistProduct *product);

// From now on it is that of this matrix, of the layout of `reach`.
void dist_product_set(DistProduct *product, const FemMatrix *matrix);
PetscErrorCode dist_product_diagonal(DistProduct *product, Vec diagonal);

#endif

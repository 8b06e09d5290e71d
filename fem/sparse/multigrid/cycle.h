// SPDX-License-Identifier: GPL-3.0-or-later
// A V-cycle of multigrid over a hierarchy that a library made: a sweep of Gauss and Seidel on the way down,
// the same backward on the way up, and the coarsest level solved. A symmetric and positive definite map, the
// same bits on any number of threads.
#ifndef TETLAP_FEM_SPARSE_MULTIGRID_CYCLE_H
#define TETLAP_FEM_SPARSE_MULTIGRID_CYCLE_H

#include "fem/sparse/multigrid/level.h"

typedef struct FemCycle {
  int level_count;
  FemLevel *levels; // from fine to coarse                     (level_count)
  double *factor;   // of the coarsest matrix, a column after the other; NULL: swept instead
} FemCycle;

// `matrices` from fine to coarse; interpolations[l] gives a vector of level l from one of level l + 1. All
// are copied. A zeroed cycle can be destroyed. RETRY: a matrix that is not positive definite.
Status fem_cycle_create(FemCycle *cycle, int level_count, const FemRows *matrices,
                        const FemRows *interpolations);
void fem_cycle_destroy(FemCycle *cycle);

// x ≈ A⁻¹ b of the finest level; they must not overlap.
void fem_cycle_apply(FemCycle *cycle, const double *b, double *x);

#endif

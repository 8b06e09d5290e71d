// SPDX-License-Identifier: GPL-3.0-or-later
// A matrix of hypre's over ranks, filled row by row without a second copy, which one through PETSc would
// make.
#ifndef TETLAP_DIST_HYPRE_H
#define TETLAP_DIST_HYPRE_H

#include <petscmat.h>

#include "base/status.h"

typedef struct DistHypre DistHypre; // opaque

// Rows `first` … `end` − 1 of a square matrix, with so many entries in columns of this range and in others
// (row by row, exactly). By all ranks. STATUS_MEMORY, STATUS_SOLVER: *matrix is NULL.
Status dist_hypre_create(DistHypre **matrix, MPI_Comm world, int first, int end, const int *own,
                         const int *others);
void dist_hypre_destroy(DistHypre *matrix);

// All entries of a row, each column once.
Status dist_hypre_set_row(DistHypre *matrix, int row, int count, const int *columns, const double *values);
// Once all rows are set: *view is the matrix for PETSc, which looks at it and does not own it. By all ranks.
Status dist_hypre_end(DistHypre *matrix, Mat *view);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The rows of the matrix that ranks share: rank by rank, three to a vertex that has unknowns, as multigrid
// wants them; prescribed coordinates among these stand alone.
#ifndef TETLAP_DIST_ROWS_H
#define TETLAP_DIST_ROWS_H

#include <stdbool.h>

#include "base/status.h"
#include "fem/sparse/matrix.h"

typedef struct DistRows {
  int size, count;         // unknowns; rows of all ranks
  int first, end;          // rows of this rank
  int *begin;              // of each rank's rows                              (ranks + 1)
  int *row;                // of each unknown                                  (size)
  int *unknowns;           // of each coordinate, as they were numbered here   (3·vertex_count)
  int *own;                // unknowns of this rank                            (own_count)
  int own_count;           //
  int *alone, alone_count; // rows of this rank that no unknown has
  int *dof;                // 3·vertex + component of each row                 (end − first)
  double *rest;            // of its vertices [m]; zero: not known             (end − first)
} DistRows;

// Numbers the rows of a matrix that has a share; by all ranks. A zeroed one, and one whose creation failed,
// can be destroyed.
Status dist_rows_create(DistRows *rows, const FemMatrix *pattern);
void dist_rows_destroy(DistRows *rows);

// Whether the unknowns are those of this numbering.
bool dist_rows_match(const DistRows *rows, const FemMatrix *pattern);

// Whether this rank has a row.
static inline bool dist_rows_have(const DistRows *rows, int row) {
  return row >= rows->first && row < rows->end;
}

#endif

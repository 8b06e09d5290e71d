// SPDX-License-Identifier: GPL-3.0-or-later
// The matrix as a multigrid is given it: both halves, in rows of all three coordinates of every vertex that
// has an unknown. Prescribed coordinates stand alone, with nothing but a diagonal.
#ifndef TETLAP_FEM_SPARSE_PETSC_VERTEX_ROWS_H
#define TETLAP_FEM_SPARSE_PETSC_VERTEX_ROWS_H

#include <stdbool.h>

#include "fem/sparse/matrix.h"

// Which row an unknown has.
typedef struct FemVertexRows {
  int size;     // unknowns
  int count;    // rows, three a vertex that has unknowns
  int *place;   // row of each unknown                                        (size)
  double *rest; // of those vertices [m]; NULL: not known                     (count)
} FemVertexRows;

// Of the unknowns of a pattern. STATUS_MEMORY; there is nothing to destroy then.
Status fem_vertex_rows_create(FemVertexRows *rows, const FemMatrix *pattern);
void fem_vertex_rows_destroy(FemVertexRows *rows); // also of zeroed ones
// Whether both give every unknown the same row.
bool fem_vertex_rows_are_same(const FemVertexRows *a, const FemVertexRows *b);

typedef struct FemVertexMatrix {
  int count;
  int *begin, *column; //                                            (count + 1), (begin[count])
  double *value;       //                                            (begin[count])
} FemVertexMatrix;

// Of a matrix with these rows. STATUS_MEMORY; STATUS_SOLVER: more entries than can be numbered, said in the
// name of the solver `name`. Destroy it also after a failure.
Status fem_vertex_matrix_fill(FemVertexMatrix *to, const FemVertexRows *rows, const FemMatrix *matrix,
                              const char *name);
void fem_vertex_matrix_destroy(FemVertexMatrix *matrix); // also of a zeroed one

#endif

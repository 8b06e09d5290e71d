// SPDX-License-Identifier: GPL-3.0-or-later
// The symmetric matrix over the unknowns: lower triangle in compressed columns, laid out once from vertex
// cliques, filled many times. Coordinates that are prescribed have no row; adding to them does nothing.
//
//   FemPattern: vertex cliques ──► FemMatrix: col_begin, row, value (scalar, lower, sorted rows)
#ifndef TETLAP_FEM_MATRIX_H
#define TETLAP_FEM_MATRIX_H

#include <stddef.h>

#include "base/status.h"

// Sorted neighbour lists of vertices, both directions, the vertex itself included; grows, never shrinks.
typedef struct FemPattern FemPattern;

Status fem_pattern_create(FemPattern **pattern, int vertex_count);
void fem_pattern_destroy(FemPattern *pattern);
// All of these vertices may couple. `*has_grown` (may be NULL) is set to 1 if a coupling is new, else left
// alone.
Status fem_pattern_add_clique(FemPattern *pattern, int count, const int *vertices, int *has_grown);

typedef struct FemMatrix {
  int size;       // unknowns n
  int *col_begin; //                                                          (size + 1)
  int *row;       // ascending, the diagonal first                            (entry_count)
  double *value;  //                                                          (entry_count)
  int entry_count;
  int vertex_count;
  const int *unknown_of_dof;      // borrowed                                              (3·vertex_count)
  struct FemMatrixBlocks *blocks; // vertex-pair lookup
} FemMatrix;

Status fem_matrix_create(FemMatrix *matrix, const FemPattern *pattern, const int *unknown_of_dof);
void fem_matrix_destroy(FemMatrix *matrix);
void fem_matrix_zero(FemMatrix *matrix);

// matrix += scale · dense over the vertices' coordinates; dense (3 count, 3 count) row-major, symmetric.
// Entries that the pattern lacks are a bug (assert). Calls on disjoint vertex sets may run in parallel.
void fem_matrix_add(FemMatrix *matrix, int count, const int *vertices, const double *dense, double scale);
// The same with `slots` looked up once by fem_matrix_slots for a tetrahedron: (12 × 12), −1: no entry (upper
// or prescribed).
void fem_matrix_slots(const FemMatrix *matrix, const int tet[4], int slots[144]);
// matrix += scale · diag(m) over all unknowns, m by vertex (vertex_count).
void fem_matrix_add_mass(FemMatrix *matrix, const double *mass, double scale);

// y = A x over the unknowns, deterministic for any number of threads.
void fem_matrix_multiply(const FemMatrix *matrix, const double *x, double *y);

#endif

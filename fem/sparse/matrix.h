// SPDX-License-Identifier: GPL-3.0-or-later
// The symmetric matrix over the unknowns: lower triangle in compressed columns, laid out once from vertex
// cliques, filled many times. Coordinates that are prescribed have no row; adding to them does nothing.
//
//   FemPattern: vertex cliques ──► FemMatrix: col_begin, row, value (scalar, lower, sorted rows)
//
// The unknowns of a vertex stand side by side. So a column is the vertex's own rows followed by runs of one
// to three rows a neighbour, and an entry is found by searching the neighbour, not the row.
#ifndef TETLAP_FEM_SPARSE_MATRIX_H
#define TETLAP_FEM_SPARSE_MATRIX_H

#include <stdbool.h>

#include "base/status.h"
#include "fem/sparse/pattern.h"

typedef struct FemMatrix {
  int size;       // unknowns n
  int *col_begin; //                                                          (size + 1)
  int *row;       // ascending, the diagonal first                            (entry_count)
  double *value;  //                                                          (entry_count)
  int entry_count;
  int vertex_count;
  // Stamp of the layout, never 0: two matrices with the same stamp have the same rows and slots, so whatever
  // was looked up in one (slots, an analysis) holds for the other.
  long long layout;
  const int *unknown_of_dof;      // borrowed                                 (3·vertex_count)
  const double *rest;             // of the vertices [m], borrowed; NULL: not known   (vertex_count, 3)
  const FemShare *share;          // of the cliques that are added here; borrowed; NULL: all
  struct FemMatrixBlocks *blocks; // where blocks of vertices stand; owns col_begin and row; copies share it
} FemMatrix;

// Lays out all couplings of the pattern, zeroed. Unknowns must be numbered in the order of their dofs.
// STATUS_INPUT: more entries than an int can number. A zeroed matrix can be destroyed.
Status fem_matrix_create(FemMatrix *matrix, const FemPattern *pattern, const int *unknown_of_dof);
// The same layout, shared, with values of its own, zeroed. Not from two threads at once.
Status fem_matrix_copy_layout(FemMatrix *copy, const FemMatrix *from);
void fem_matrix_destroy(FemMatrix *matrix);
// Whether fem_matrix_create would lay it out the same; false of a zeroed one.
bool fem_matrix_fits(const FemMatrix *matrix, const FemPattern *pattern, const int *unknown_of_dof);
void fem_matrix_zero(FemMatrix *matrix);

// matrix += scale · dense over the vertices' coordinates; dense (3 count, 3 count) row-major, symmetric; the
// vertices distinct. Entries that the pattern lacks are a bug (assert). Where ranks share the matrix, what
// another has to add is left out. Calls on disjoint vertex sets may run in parallel.
void fem_matrix_add(FemMatrix *matrix, int count, const int *vertices, const double *dense, double scale);
// matrix += scale · w wᵀ, w (count, 3), without forming the dense matrix; else as fem_matrix_add.
void fem_matrix_add_outer(FemMatrix *matrix, int count, const int *vertices, const double *w, double scale);
// The same with `slots` looked up once for an element of n = 3 count coordinates: value[slots[n i + j]] is
// entry (i, j) of the (n × n) element matrix, −1: no entry (upper or prescribed).
void fem_matrix_slots(const FemMatrix *matrix, int count, const int *vertices, int *slots);
// For four vertices in ascending order that have all their coordinates: where the lower triangle of each
// vertex' own block begins (4), then the blocks of the pairs 01, 02, 03, 12, 13, 23 (6), then how long the
// first column of each vertex is (4). The second column of a block lies by that length less 1 behind the
// first, the third by that less 2 behind the second; of an own block by the length and by the length less 1.
// False: a coordinate is prescribed.
bool fem_matrix_block_slots(const FemMatrix *matrix, const int vertices[4], int slots[14]);
// matrix += scale · diag(m) over all unknowns, m by vertex (vertex_count).
void fem_matrix_add_mass(FemMatrix *matrix, const double *mass, double scale);

// y = A x over the unknowns, deterministic for any number of threads. x and y must not overlap.
void fem_matrix_multiply(const FemMatrix *matrix, const double *x, double *y);

// What follows is for ranks that share a matrix, of which each has entries at some vertices only.

// Whether a vertex couples with any other.
bool fem_matrix_is_coupled(const FemMatrix *matrix, int vertex);
// y += A x over the columns of these vertices and their mirror images, one after another: over all vertices
// that are coupled, or have entries of their own, the whole product.
void fem_matrix_add_product(const FemMatrix *matrix, int count, const int *vertices, const double *x,
                            double *y);
// A row of the whole matrix, both triangles, columns ascending: that of an unknown of `vertex`. Returns how
// many entries it has; `columns` and `values` NULL: only that.
int fem_matrix_row(const FemMatrix *matrix, int vertex, int unknown, int *columns, double *values);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// How a matrix is laid out: where the blocks of two vertices stand, and by which pieces products are formed.
#ifndef TETLAP_FEM_SPARSE_MATRIX_BLOCKS_H
#define TETLAP_FEM_SPARSE_MATRIX_BLOCKS_H

#include <stdbool.h>

#include "base/status.h"
#include "fem/sparse/pattern.h"

// Rows of a vertex that an earlier piece of a product has added to.
typedef struct FemMatrixGift {
  int from, to; // in `kept`, in y
  int count;
} FemMatrixGift;

// Where the block of vertices (v, w), v < w, stands. Column c of v (c = 0 … active[v] − 1, counted over v's
// own unknowns) holds
//
//   col_begin[first[v] + c] ─► own rows c … active[v] − 1 │ rows of w₁ │ rows of w₂ │ …
//                                                         └ row_offset counts from here, the same for all c
//
// Vertices without an unknown have no blocks.
typedef struct FemMatrixBlocks {
  int reference_count;
  int vertex_count, size, entry_count; // as of a FemMatrix, which borrows col_begin and row
  int *col_begin, *row;
  int *first;          // first unknown                                          (vertex_count)
  signed char *active; // number of unknowns, 0 … 3                              (vertex_count)
  int *above_begin;    // of v in above and row_offset                           (vertex_count + 1)
  int *above;          // w > v, ascending                                       (block_count)
  int *row_offset;     // rows of v's columns that stand before w's              (block_count)
  int *below_begin;    // the same blocks by w: of w in below and below_offset   (vertex_count + 1)
  int *below;          // v < w, ascending                                       (block_count)
  int *below_offset;   // row_offset of the block                                (block_count)
  // Products are formed by pieces of consecutive vertices, which the layout alone determines. A piece writes
  // its own rows and keeps what it has for later ones beside, to be added in the order of the pieces.
  int piece_count;
  int *piece_begin; // first vertex                                              (piece_count + 1)
  int *target;      // of each block: where w's rows are in y; ~ in `kept`       (block_count)
  int *gift_begin;  // of each piece in gifts: what earlier ones have for it     (piece_count + 1)
  FemMatrixGift *gifts;
  double *kept;    // (kept_begin[piece_count])
  int *kept_begin; // of each piece                                              (piece_count + 1)
} FemMatrixBlocks;

// Lays out all couplings of the pattern, with one reference. STATUS_INPUT: more entries than an int can
// number; what was made, or NULL, is then to be released, too.
Status fem_matrix_blocks_create(FemMatrixBlocks **blocks, const FemPattern *pattern,
                                const int *unknown_of_dof);
// Whether fem_matrix_blocks_create would find the same.
bool fem_matrix_blocks_fit(const FemMatrixBlocks *blocks, const FemPattern *pattern,
                           const int *unknown_of_dof);
// Gives one reference back, and with the last one the memory; NULL: nothing.
void fem_matrix_blocks_release(FemMatrixBlocks *blocks);

// The rows of a block in column c of v begin here.
static inline int fem_matrix_blocks_rows(const FemMatrixBlocks *blocks, int v, int c, int row_offset) {
  return blocks->col_begin[blocks->first[v] + c] + blocks->active[v] - c + row_offset;
}

#endif

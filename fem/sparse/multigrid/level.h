// SPDX-License-Identifier: GPL-3.0-or-later
// One level of a multigrid: its matrix in single precision, and the way to the next coarser one and back.
//
// Rows are in the order of stages: neighbouring ones are cut into chunks, and chunks of one stage have no
// entry in common (Adams 2001 colours vertices so). A sweep of Gauss and Seidel in this order goes through
// the chunks of a stage on all threads, and its bits do not depend on their number.
#ifndef TETLAP_FEM_SPARSE_MULTIGRID_LEVEL_H
#define TETLAP_FEM_SPARSE_MULTIGRID_LEVEL_H

#include "base/status.h"

// Rows of a matrix, borrowed; columns in any order.
typedef struct FemRows {
  int count, column_count;
  const int *begin, *column; //      (count + 1), (begin[count])
  const double *value;       //      (begin[count])
} FemRows;

// Which of the threads at work this is; rank 0 of 1: alone.
typedef struct FemTeam {
  int rank, size;
} FemTeam;

// A matrix from one level's vectors to another's.
typedef struct FemLevelMap {
  int count;
  int *begin, *column;
  float *value;
} FemLevelMap;

// Rows come by nodes: `width` of them, one or three, whose columns are nodes, too. An entry is a block, a
// column after the other.
typedef struct FemLevel {
  int width, count; // rows of a node; nodes
  int *order;       // given node at each place                                (count)
  int *place;       // of each given node                                      (count)
  int stage_count;
  int *stage;       // its first chunk                                         (stage_count + 1)
  int *chunk;       // its first place                                         (chunks + 1)
  int *begin;       // of the entries beside the diagonal                      (count + 1)
  int *middle;      // those from here on are of later places                  (count)
  int *column;      // places
  float *value;     // blocks                                                  (begin[count], width²)
  double *diagonal; // blocks, rows first; on the diagonal the inverse         (count, width²)
  FemLevelMap to_coarse, from_coarse; // empty: the coarsest
  double *b, *x, *r; // by places                                               (count, width)
} FemLevel;

// `width` 3: an entry's mirror image is an entry, too; or 1. A zeroed level can be destroyed. RETRY: a
// diagonal that is not positive.
Status fem_level_create(FemLevel *level, const FemRows *matrix, int width);
void fem_level_destroy(FemLevel *level);

// The place of a given row.
static inline int fem_level_place(const FemLevel *level, int row) {
  return level->width * level->place[row / level->width] + row % level->width;
}

// `interpolation` gives this level's vector from the coarser one's, whose width is 1.
Status fem_level_connect(FemLevel *level, const FemLevel *coarse, const FemRows *interpolation);

// What follows is called by all threads of a team, and has been done by all when it returns.

// x from nothing, by a sweep over A x = b; r = b − A x.
void fem_level_sweep_down(FemLevel *level, FemTeam team);
// x by a sweep in the other direction.
void fem_level_sweep_up(FemLevel *level, FemTeam team);
// The coarser level's b from r; x += what the coarser level's x gives.
void fem_level_restrict(const FemLevel *level, FemLevel *coarse, FemTeam team);
void fem_level_prolong(FemLevel *level, const FemLevel *coarse, FemTeam team);

#endif

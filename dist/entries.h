// SPDX-License-Identifier: GPL-3.0-or-later
// Every rank has added its share to a matrix over all unknowns (fem/sparse/share.h). Here the shares meet: a
// rank has the rows of its vertices; what it adds to rows of others, which is what vertices at the border
// share, all ranks get and the rows' owners take.
#ifndef TETLAP_DIST_ENTRIES_H
#define TETLAP_DIST_ENTRIES_H

#include "dist/rows.h"

// A place in the whole matrix.
typedef struct DistPlace {
  int row, column;
} DistPlace;

// Where a given value is from, and where it goes.
typedef struct DistTaken {
  int from, slot;
} DistTaken;

typedef struct DistEntries {
  const DistRows *rows; // borrowed
  int *row_begin;       // of each row of this rank in `values`               (rows + 2)
  int *column;          // ascending in a row; freed once it is known elsewhere
  double *values;       // both triangles                                     (row_begin[rows])
  bool *is_touched;     // vertices to which this rank may add                (vertex_count)
  int *slots;           // in `values`, of own entries for own rows, as they are walked
  int *alone_slots;     // of rows that no unknown has
  int *given_begin;     // of each rank's entries for rows of others          (ranks + 1)
  DistPlace *given;     // those of all ranks, while they are laid out
  double *given_values; //                                                    (given_begin[ranks])
  DistTaken *taken;     // those for rows of this rank                        (taken_count)
  int taken_count;
  int given_at, slot_at; // of a walk
} DistEntries;

// Lays out this rank's rows, zeroed; by all ranks. `rows` must stay. A zeroed one, and one whose creation
// failed, can be destroyed.
Status dist_entries_create(DistEntries *entries, const DistRows *rows, const FemMatrix *pattern);
void dist_entries_destroy(DistEntries *entries);
// The columns have been copied by whoever needs them.
void dist_entries_forget_columns(DistEntries *entries);

// values = Σ over ranks of what each has added to its matrix of that layout; rows that no unknown has are as
// stiff as a neighbour. By all ranks.
void dist_entries_sum(DistEntries *entries, const FemMatrix *matrix);

#endif

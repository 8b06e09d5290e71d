// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the whole matrix, one after another, as a preconditioner is given them. Every rank has added its
// share to a matrix over all unknowns (fem/sparse/share.h), and has the rows of its vertices; what it adds to
// rows of others, which is what vertices at the border share, all ranks get and the rows' owners take.
#ifndef TETLAP_DIST_ENTRIES_H
#define TETLAP_DIST_ENTRIES_H

#include "dist/reach.h"

typedef struct DistEntry {
  int row, column;
  double value;
} DistEntry;

typedef struct DistEntries {
  const DistRows *rows;    // borrowed
  const FemMatrix *matrix; // borrowed
  bool skips_zeros;        // entries that are zero are none, but those of the diagonal
  double alone;            // of rows that no unknown has
  int *taken_begin;        // of each own row in `taken`                     (rows + 2)
  DistEntry *taken;        // what others have for it, in the order of ranks
  int *columns;            // of the row that was asked for last: ascending
  double *values;
} DistEntries;

// By all ranks. Without zeros rows are of these numbers only; contact's places are mostly zero, and of others
// all have them. All that is given must stay. A zeroed one, and one whose creation failed, can be destroyed.
Status dist_entries_create(DistEntries *entries, const DistRows *rows, const DistReach *reach,
                           const FemMatrix *matrix, bool skips_zeros);
void dist_entries_destroy(DistEntries *entries);

// Makes `columns` and `values` those of a row of this rank; how many it has.
int dist_entries_row(DistEntries *entries, int row);

// Of rows that no unknown has: as stiff as a neighbour.
double dist_entries_alone(const DistRows *rows, const FemMatrix *matrix);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Where a rank adds to the matrix: at its own vertices, and at those of others that cliques of its own have.
#ifndef TETLAP_DIST_REACH_H
#define TETLAP_DIST_REACH_H

#include "dist/rows.h"

typedef struct DistReach {
  int *vertices, vertex_count; // that have unknowns, ascending
  int *others, other_count;    // unknowns of other ranks among them, ascending
} DistReach;

// By this rank alone. A zeroed one, and one whose creation failed, can be destroyed.
Status dist_reach_create(DistReach *reach, const FemMatrix *pattern);
void dist_reach_destroy(DistReach *reach);

#endif

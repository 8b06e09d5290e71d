// SPDX-License-Identifier: GPL-3.0-or-later
// Which vertices may couple: the graph from which matrices are laid out. It grows, clique by clique, and
// shrinks only by going back to a mark; a vertex always couples with itself.
#ifndef TETLAP_FEM_SPARSE_PATTERN_H
#define TETLAP_FEM_SPARSE_PATTERN_H

#include "base/status.h"
#include "fem/sparse/share.h"

typedef struct FemPattern FemPattern; // opaque

Status fem_pattern_create(FemPattern **pattern, int vertex_count);
void fem_pattern_destroy(FemPattern *pattern);

// From now on cliques that other ranks have are left out; NULL: none are. Borrowed.
void fem_pattern_set_share(FemPattern *pattern, const FemShare *share);

// All of these vertices may couple; order and repetitions do not matter. `*has_grown` (may be NULL) is set to
// 1 if a coupling is new, else left alone. Cheap where nothing is new: a search per pair, no allocation.
Status fem_pattern_add_clique(FemPattern *pattern, int count, const int *vertices, int *has_grown);

// From now on the pattern can be taken back to what it is now.
void fem_pattern_mark(FemPattern *pattern);
// Takes away what has been added since the mark, at a cost of what that was.
void fem_pattern_take_back(FemPattern *pattern);

int fem_pattern_vertex_count(const FemPattern *pattern);
// The vertices with a higher number that `vertex` couples with, ascending; borrowed until the pattern grows.
const int *fem_pattern_above(const FemPattern *pattern, int vertex, int *count);

#endif

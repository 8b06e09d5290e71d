// SPDX-License-Identifier: GPL-3.0-or-later
// Which vertices a rank has, where several share a run (base/ranks.h). A clique of vertices belongs to the
// rank that has its lowest vertex: it alone adds the clique's part. Sums over ranks are then the whole.
#ifndef TETLAP_FEM_SPARSE_SHARE_H
#define TETLAP_FEM_SPARSE_SHARE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct FemShare {
  int rank, rank_count;
  int *owner; // rank of each vertex   (vertex_count)
} FemShare;

// `share` NULL: one process, which has all.
static inline bool fem_share_has(const FemShare *share, int count, const int *vertices) {
  if (!share || count == 0) return true;
  int lowest = vertices[0];
  for (int i = 1; i < count; i++)
    if (vertices[i] < lowest) lowest = vertices[i];
  return share->owner[lowest] == share->rank;
}

#endif

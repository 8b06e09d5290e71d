// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/edges.h"

#include <stdlib.h>

#include "base/memory.h"
#include "fem/element/quadratic.h"

static int compare(const void *left, const void *right) {
  const FemMeshEdge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->tet > b->tet) - (a->tet < b->tet);
}

Status fem_mesh_edges_list(FemMeshEdge **edges, int tet_count, const int (*tets)[4]) {
  size_t count = 6 * (size_t)tet_count;
  FemMeshEdge *list = memory_zeroed(count, sizeof *list);
  if (!list) return status_no_memory("the edges of a mesh");
  for (int t = 0; t < tet_count; t++)
    for (int k = 0; k < 6; k++) {
      int a = tets[t][fem_quadratic_edges[k][0]], b = tets[t][fem_quadratic_edges[k][1]];
      list[6 * (size_t)t + (size_t)k] = (FemMeshEdge){a < b ? a : b, a < b ? b : a, t, k};
    }
  qsort(list, count, sizeof *list, compare);
  *edges = list;
  return STATUS_OK;
}

int fem_mesh_edges_end(const FemMeshEdge *edges, int edge_count, int begin) {
  int end = begin + 1;
  while (end < edge_count && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high)
    end++;
  return end;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The edges of a tetrahedral mesh in a list where those with the same ends stand together. The number of an
// edge is its place among the distinct ones in this order.
#ifndef TETLAP_FEM_MESH_EDGES_H
#define TETLAP_FEM_MESH_EDGES_H

#include "base/status.h"

typedef struct FemMeshEdge {
  int low, high; // vertices, low < high
  int tet;
  int local; // of the tetrahedron, as in fem_quadratic_edges
} FemMeshEdge;

// All 6 · tet_count edges, ordered by ends, then tetrahedron; `*edges` is owned by the caller.
Status fem_mesh_edges_list(FemMeshEdge **edges, int tet_count, const int (*tets)[4]);

// One past the last edge of the list that has the same ends as edges[begin].
int fem_mesh_edges_end(const FemMeshEdge *edges, int edge_count, int begin);

#endif

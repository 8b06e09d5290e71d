// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes on the edges of second-order tetrahedra, as a file gives them: by tetrahedron. A FemMesh has them
// by edge.
#ifndef TETLAP_FEM_MESH_MIDDLES_H
#define TETLAP_FEM_MESH_MIDDLES_H

#include "fem/mesh/source.h"

typedef struct FemMeshMiddles {
  int edge_count;
  double *rest;        // of the node on each edge, edges by number (fem/mesh/edges.h) [m]  (edge_count, 3)
  int *edge_of_vertex; // the edge whose node the vertex is, −1: of none                   (vertex_count)
} FemMeshMiddles;

// Of a source whose corners and middles are in range. STATUS_INPUT: two nodes on an edge, a node on two
// edges, a node that is a corner elsewhere. What is made is zeroed after a failure.
Status fem_mesh_middles_number(FemMeshMiddles *middles, const FemMeshSource *source);

void fem_mesh_middles_destroy(FemMeshMiddles *middles);

#endif

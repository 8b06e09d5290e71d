// SPDX-License-Identifier: GPL-3.0-or-later
// What a mesh is made from, before it has been checked (fem/mesh/validate.h).
#ifndef TETLAP_FEM_MESH_SOURCE_H
#define TETLAP_FEM_MESH_SOURCE_H

#include "fem/mesh/mesh.h"

// A mesh as its file says it. A zeroed one can be destroyed.
typedef struct FemMeshSource {
  int vertex_count;
  int tet_count;
  double *positions;      //                                                       (vertex_count, 3)
  int (*tets)[4];         // indices into positions, not yet checked               (tet_count)
  int (*middles)[6];      // of second-order tetrahedra likewise, the node on each edge
                          // (fem_quadratic_edges); NULL: linear                    (tet_count)
  long long *vertex_tags; // what the file calls them; NULL: their index           (vertex_count)
  long long *tet_tags;    // likewise                                              (tet_count)
  FemMeshGroup *groups;   // of indices, in range, any order, repeats allowed      (group_count)
  int group_count;
} FemMeshSource;

void fem_mesh_source_destroy(FemMeshSource *source);

#endif

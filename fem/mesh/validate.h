// SPDX-License-Identifier: GPL-3.0-or-later
// The one gate through which every mesh passes: raw arrays in, a FemMesh that keeps its promises out, or a
// message that names the source, the element and what to do.
#ifndef TETLAP_FEM_MESH_VALIDATE_H
#define TETLAP_FEM_MESH_VALIDATE_H

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

// Limits that keep every index and every count of unknowns, faces or their corners within an int.
enum { FEM_MESH_MAX_VERTICES = 500 * 1000 * 1000, FEM_MESH_MAX_TETS = 150 * 1000 * 1000 };

// Checks, turns what is inside out, takes middles out of the vertices, drops those that are unused and
// renumbers groups. The arrays of the source move
// into the mesh; on failure the mesh is zeroed. The source is left to be destroyed in both cases.
Status fem_mesh_validate(FemMesh *mesh, FemMeshSource *source, const char *origin, FemMeshRepairs *repairs);

void fem_mesh_source_destroy(FemMeshSource *source);

#endif

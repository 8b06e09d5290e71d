// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles of a tetrahedral mesh in a list where those with the same vertices stand together. A face
// with one entry is on the surface, one with two between neighbours; with more the mesh is not manifold.
#ifndef TETLAP_FEM_MESH_FACES_H
#define TETLAP_FEM_MESH_FACES_H

#include <stdbool.h>

#include "base/status.h"

typedef struct FemMeshFace {
  int vertices[3]; // increasing
  int tet;
  int local;    // the face opposite this vertex (0 … 3) of the tetrahedron (base/tet.h)
  bool is_even; // the outward order is an even permutation of `vertices`: neighbours differ in it
} FemMeshFace;

// All 4 · tet_count faces, ordered by vertices, then tetrahedron; `*faces` is owned by the caller.
Status fem_mesh_faces_list(FemMeshFace **faces, int vertex_count, int tet_count, const int (*tets)[4]);

// One past the last face of the list that has the same vertices as faces[begin].
int fem_mesh_faces_end(const FemMeshFace *faces, int face_count, int begin);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Every mesh is checked here. Raw arrays become a FemMesh as fem/mesh/mesh.h describes it, or there is a
// message that names the source, the element and what to do.
#ifndef TETLAP_FEM_MESH_VALIDATE_H
#define TETLAP_FEM_MESH_VALIDATE_H

#include "fem/mesh/source.h"

// Limits that keep every index and every count of unknowns, faces or their corners within an int.
enum { FEM_MESH_MAX_VERTICES = 500 * 1000 * 1000, FEM_MESH_MAX_TETS = 150 * 1000 * 1000 };

// Checks, turns what is inside out, takes middles out of the vertices, drops those that are unused and
// renumbers groups. The arrays of the source move into the mesh; on failure the mesh is zeroed. The source is
// left to be destroyed in both cases.
Status fem_mesh_validate(FemMesh *mesh, FemMeshSource *source, const char *origin, FemMeshRepairs *repairs);

#endif

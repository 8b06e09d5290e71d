// SPDX-License-Identifier: GPL-3.0-or-later
// The mesh that gmsh has in memory: its vertices, tetrahedra and groups as arrays of ours.
#ifndef TETLAP_FEM_MESH_READER_GMSH_MODEL_H
#define TETLAP_FEM_MESH_READER_GMSH_MODEL_H

#include <stdbool.h>
#include <stddef.h>

#include "fem/mesh/reader/gmsh_library.h"
#include "fem/mesh/validate.h"

// Into the zeroed `source`, which the caller destroys, also after a failure. STATUS_INPUT: there are no
// tetrahedra, tetrahedra of two orders, other volume elements, or more of anything than can be numbered.
Status fem_mesh_gmsh_model_take(const FemMeshGmshLibrary *gmsh, FemMeshSource *source, bool has_groups);

// Checks that the triangles in memory enclose a volume, before gmsh is asked to fill it, and counts them.
// STATUS_INPUT: they do not (fem/mesh/reader/shell.h), or there are more than can be numbered.
Status fem_mesh_gmsh_model_check_shell(const FemMeshGmshLibrary *gmsh, size_t *triangle_count);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The mesh that gmsh has in memory: its vertices, tetrahedra and groups as arrays of ours.
#ifndef TETLAP_FEM_MESH_READER_GMSH_MODEL_H
#define TETLAP_FEM_MESH_READER_GMSH_MODEL_H

#include <stdbool.h>
#include <stddef.h>

#include "fem/mesh/reader/gmsh_library.h"
#include "fem/mesh/validate.h"

// Into the zeroed `source`, which is the caller's to destroy, after a failure, too. STATUS_INPUT: it has none
// but tetrahedra of one order, or more of anything than can be numbered.
Status fem_mesh_gmsh_model_take(const FemMeshGmshLibrary *gmsh, FemMeshSource *source, bool has_groups);

// A surface must enclose a volume before gmsh is asked to fill it; how many triangles it has.
Status fem_mesh_gmsh_model_check_shell(const FemMeshGmshLibrary *gmsh, size_t *triangle_count);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Which vertices a selection of the scene means.
#ifndef TETLAP_FEM_SCENE_SELECT_H
#define TETLAP_FEM_SCENE_SELECT_H

#include "fem/scene/scene.h"

// The vertices of `mesh` (placed, at rest) that the selection holds, ascending; owned by the caller
// (memory_free). STATUS_INPUT: it holds none, or the mesh has no such group; the message says what there is.
Status fem_select_vertices(const FemSelectDef *select, const FemMesh *mesh, int **vertices,
                           int *vertex_count);

// The tetrahedra by number, quadratic ones of a mesh that was made quadratic: those that the file puts into a
// group, or those whose middle (of the corners) the selection holds. As above.
Status fem_select_elements(const FemSelectDef *select, const FemMesh *mesh, int **elements,
                           int *element_count);

#endif

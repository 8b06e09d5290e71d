// SPDX-License-Identifier: GPL-3.0-or-later
// Points along a straight line through a body or on its surface at rest; elements carry them.
#ifndef TETLAP_FEM_SCENE_PROBE_LINE_H
#define TETLAP_FEM_SCENE_PROBE_LINE_H

#include <stdbool.h>

#include "fem/mesh/mesh.h"
#include "fem/scene/scene.h"

typedef struct FemLinePoint {
  double way; // from the line's begin, at rest [m]
  int tet;    // of the model
  double shares[4];
  bool is_surface; // as far as rounding tells
} FemLinePoint;

typedef struct FemLine {
  const FemLineDef *def; // borrowed from the scene
  int count;
  FemLinePoint *points; // along the line                        (count)
} FemLine;

// Finds the points in `mesh`, that of a body whose first tetrahedron has the number `tet_begin` in the model.
// A point outside is carried by the nearest point of the surface where that may be a facet below a round one:
// within a fifth of the element's longest edge. Others are left out. STATUS_INPUT: so are all; or the line
// has no length.
Status fem_line_create(FemLine *line, const FemLineDef *def, const FemMesh *mesh, int tet_begin);
void fem_line_destroy(FemLine *line); // also of a zeroed one

#endif

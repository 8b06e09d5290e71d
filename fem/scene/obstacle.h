// SPDX-License-Identifier: GPL-3.0-or-later
// An obstacle without a mesh, as contact sees it.
#ifndef TETLAP_FEM_SCENE_OBSTACLE_H
#define TETLAP_FEM_SCENE_OBSTACLE_H

#include "contact/def.h"
#include "contact/shape/convex.h"
#include "fem/scene/scene.h"

// The shape of a definition that is no mesh; it borrows the definition and `solid`, which is filled for a
// box.
void fem_obstacle_shape(const FemObstacleDef *def, ContactShape *shape, ContactConvex *solid);

// Whether rounding leaves it a surface for elements whose edges have that mean length [m]. STATUS_INPUT: it
// is too large.
Status fem_obstacle_check(const FemObstacleDef *def, double edge);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The meshes of a scene, read or generated, and placed.
#ifndef TETLAP_FEM_SCENE_MESHES_H
#define TETLAP_FEM_SCENE_MESHES_H

#include "fem/mesh/mesh.h"
#include "fem/scene/scene.h"

// Those of all bodies, then of the obstacles that have one: `meshes` has room for all; on error, too, the
// caller destroys them. A file that several use is read once. Errors name the body or the obstacle.
Status fem_scene_meshes_load(const FemSceneDef *scene, FemMesh *meshes);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Builds a model from a scene definition.
#ifndef TETLAP_FEM_MODEL_BUILD_H
#define TETLAP_FEM_MODEL_BUILD_H

#include "fem/model/model.h"

// Reads the meshes (relative to the scene file), places, checks and numbers. STATUS_INPUT names the body and
// what is wrong: a selection that is empty, a vertex fixed and driven in the same component, an unknown
// group.
Status fem_model_create(FemModel *model, const FemSceneDef *scene);
void fem_model_destroy(FemModel *model);

// Adds the masses of a body's elements, by their volumes, to those of its vertices.
void fem_model_lump(FemModel *model, const FemModelBody *body);

#endif

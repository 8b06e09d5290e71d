// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene as a whole must hold beyond the rules of its keys (app/scene/keys/keys.h): names are
// different, and what stands in one section agrees with another.
#ifndef TETLAP_APP_SCENE_CHECK_H
#define TETLAP_APP_SCENE_CHECK_H

#include "app/scene/tree.h"
#include "fem/scene/scene.h"

// `scene` has been read from `root`. STATUS_INPUT: file:line:column, what contradicts what, and the remedy.
Status app_scene_check(const SceneNode *root, const FemSceneDef *scene);

#endif

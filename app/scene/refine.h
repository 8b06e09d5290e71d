// SPDX-License-Identifier: GPL-3.0-or-later
// The same scene on another mesh.
#ifndef TETLAP_APP_SCENE_REFINE_H
#define TETLAP_APP_SCENE_REFINE_H

#include "fem/scene/scene.h"

// Divides the edges of all bodies by `level`, before the model is built: a box gets so many times its cells
// (rounded, one at least), a mesh that is made when it is read so much smaller edges. Obstacles stay as they
// are. STATUS_INPUT where the level is not 1 and a body's mesh comes as it is from a file; names the body.
Status app_scene_refine(FemSceneDef *scene, double level);

#endif

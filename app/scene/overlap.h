// SPDX-License-Identifier: GPL-3.0-or-later
// A scene with another overlap model than its own, as command lines name them: by a name, or by a weights
// file.
#ifndef TETLAP_APP_SCENE_OVERLAP_H
#define TETLAP_APP_SCENE_OVERLAP_H

#include "base/status.h"
#include "fem/scene/scene.h"

// app_scene_read with `overlap` in the place of the scene's model and weights; NULL: the scene's own.
// `hybrid` keeps the scene's weights, which are of its network. A weights file (….safetensors) is named from
// where the program was called, not from where the scene is.
Status app_scene_overlap_read(const char *path, const char *const *overrides, int override_count,
                              const char *overlap, FemSceneDef *scene);

#endif

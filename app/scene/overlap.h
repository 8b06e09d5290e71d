// SPDX-License-Identifier: GPL-3.0-or-later
// A scene with another overlap model than its own, as command lines name them: by a name, or by a weights
// file.
#ifndef TETLAP_APP_SCENE_OVERLAP_H
#define TETLAP_APP_SCENE_OVERLAP_H

#include "app/cli/model_names.h"
#include "base/status.h"
#include "fem/scene/scene.h"

// app_scene_read with `overlap` in the place of the scene's model and weights; NULL: the scene's own. A
// weights file is read as `contact.net.weights`, but from where the program was called, a name as
// `contact.overlap`; `hybrid` keeps the scene's weights, which are of its network, `hybrid=NETWORK` has both.
Status app_scene_overlap_read(const char *path, const char *const *overrides, int override_count,
                              const char *overlap, FemSceneDef *scene);

// What a command line would say for the scene's model: a name, the absolute path of its weights file,
// `hybrid=` and one of both. False: the scene has no contact.
bool app_scene_overlap_source(const FemSceneDef *scene, char source[PATH_MAX]);

#endif

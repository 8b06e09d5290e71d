// SPDX-License-Identifier: GPL-3.0-or-later
// A scene with another overlap model than its own, as command lines name them (overlap/source.h).
#ifndef TETLAP_APP_SCENE_OVERLAP_H
#define TETLAP_APP_SCENE_OVERLAP_H

#include "app/cli/model_names.h"
#include "base/status.h"
#include "fem/scene/scene.h"

// app_scene_read with `overlap` as `contact.overlap`, its file as seen from where the program was called;
// NULL: the scene's own.
Status app_scene_overlap_read(const char *path, const char *const *overrides, int override_count,
                              const char *overlap, FemSceneDef *scene);

// What a command line would say for the scene's model, its file by its absolute path. False: the scene has no
// contact.
bool app_scene_overlap_source(const FemSceneDef *scene, char source[PATH_MAX]);

#endif

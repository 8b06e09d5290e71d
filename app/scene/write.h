// SPDX-License-Identifier: GPL-3.0-or-later
// A scene's definition back in the form of its file, by the same table.
#ifndef TETLAP_APP_SCENE_WRITE_H
#define TETLAP_APP_SCENE_WRITE_H

#include "app/scene/keys/keys.h"
#include "base/files/record.h"
#include "fem/scene/scene.h"

// Puts the scene with all its defaults under `name` into `parent`. What it writes is a scene again, with the
// same definition; mesh paths stay as they were written, relative to scene->path.
Status app_scene_write_resolved(const FemSceneDef *scene, Record *parent);

// Writes the value of one key other than a section, as it stands in the struct that the key's section
// describes, under `name`.
Status app_scene_write_value(const SceneKey *key, const void *self, Record *record, const char *name);

#endif

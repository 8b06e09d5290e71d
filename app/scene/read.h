// SPDX-License-Identifier: GPL-3.0-or-later
// From a scene file to the definition of a scene: the tree of tree.h is read by the table of
// keys/keys.h.
#ifndef TETLAP_APP_SCENE_READ_H
#define TETLAP_APP_SCENE_READ_H

#include "app/scene/keys/keys.h"
#include "app/scene/tree.h"
#include "fem/scene/scene.h"

// Reads a scene, YAML or JSON, after putting `overrides` ("contact.stiffness=1e6", "bodies.lower.place=…",
// see override.h) into it. On failure `scene` is zeroed. STATUS_INPUT: file:line:column, the key, what
// was expected and found, and the nearest valid name; STATUS_USAGE: the same of an override; STATUS_IO.
Status app_scene_read(const char *path, const char *const *overrides, int override_count, FemSceneDef *scene);

// The same of a tree that a file was read into; it is taken over, also on failure. Mesh paths count from the
// directory of `path`.
Status app_scene_read_tree(const char *path, SceneNode *root, const char *const *overrides,
                           int override_count, FemSceneDef *scene);

// Reads a file by a table of its own: the struct that `section` describes, zeroed before, is filled with the
// defaults and then with what the file and the overrides say. What it owns after a failure is the caller's.
Status app_scene_read_section(const char *path, const char *const *overrides, int override_count,
                              const SceneSection *section, void *self);

// A struct filled so, for those who compare with the defaults or print them; owned by the caller.
Status app_scene_read_create_defaults(const SceneSection *section, void **defaults);
void app_scene_read_destroy_defaults(const SceneSection *section, void *defaults);

#endif

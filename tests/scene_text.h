// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that a test writes as text.
#ifndef TETLAP_TESTS_SCENE_TEXT_H
#define TETLAP_TESTS_SCENE_TEXT_H

#include "app/scene/read.h"

// The scene, as if the file at `path` held these `size` letters. On failure `scene` is zeroed.
static inline Status scene_text_read(const char *path, const char *text, size_t size, FemSceneDef *scene) {
  *scene = (FemSceneDef){0};
  SceneNode *root;
  TRY(app_scene_tree_parse(path, text, size, &root));
  return app_scene_read_tree(path, root, NULL, 0, scene);
}

#endif

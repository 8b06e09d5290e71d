// SPDX-License-Identifier: GPL-3.0-or-later
// One value of a scene file, by the type of its key (app/scene/keys/keys.h): a number, a text, a choice, rows
// …
#ifndef TETLAP_APP_SCENE_VALUE_H
#define TETLAP_APP_SCENE_VALUE_H

#include "app/scene/keys/keys.h"
#include "app/scene/tree.h"

// Puts the value into the struct `self` of the key's section; of every type but sections and lists of them,
// which are left alone. STATUS_INPUT: file:line:column, the key, what was expected and found.
Status app_scene_value_read(const SceneKey *key, const SceneNode *node, void *self);

// STATUS_INPUT with what the key expects against what the node is, and a hint.
Status app_scene_value_fail(const SceneKey *key, const SceneNode *node, const char *hint);

// Puts an enum or a flag, by its size, into the field.
void app_scene_value_store(void *field, size_t size, int value);

#endif

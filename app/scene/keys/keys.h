// SPDX-License-Identifier: GPL-3.0-or-later
// The table of every key of a scene file: its type, unit, range, default, help, and where its value goes in
// FemSceneDef. Reading (scene_read), writing (scene_write), the JSON Schema and the manual's reference page
// (scene_schema) are made from it. So a new key is one line in the file of its section in app/scene/keys/.
#ifndef TETLAP_APP_SCENE_KEYS_KEYS_H
#define TETLAP_APP_SCENE_KEYS_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#include "app/scene/keys/section.h"
#include "base/text.h"

// What a value is a function of.
static inline const char *app_scene_keys_argument(const SceneKey *key) {
  return key->argument ? key->argument : "t";
}

// How many numbers a row of ROWS or PROFILE has.
int app_scene_keys_row_width(const SceneKey *key);

// The numbers between two ends, each of which may be excluded.
typedef struct SceneRange {
  double min, max;
  bool is_min_open, is_max_open;
} SceneRange;

// The section that is the whole file.
extern const SceneSection app_scene_keys_root;

// The keys of a section one by one, `more` included; NULL beyond the last.
const SceneKey *app_scene_keys_at(const SceneSection *section, int index);
const SceneKey *app_scene_keys_find(const SceneSection *section, const char *name);
// Where in the whole table a key of that name stands, as "contact.stiffness"; false: nowhere.
bool app_scene_keys_locate(const SceneSection *section, const char *name, char *path, size_t size);

SceneRange app_scene_keys_range(const SceneKey *key);
bool app_scene_keys_allows(const SceneKey *key, double number); // false for NaN
// "a number in (0, inf) [Pa]", "one of nodal, element, …": what is expected of a value.
void app_scene_keys_expect(const SceneKey *key, char *text, size_t size);
// The number of a name among the key's choices; −1: none of them.
int app_scene_keys_choice(const SceneKey *key, const char *name);

#endif

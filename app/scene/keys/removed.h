// SPDX-License-Identifier: GPL-3.0-or-later
// What scene files of earlier versions may hold and this one does not read, and what to write instead.
#ifndef TETLAP_APP_SCENE_KEYS_REMOVED_H
#define TETLAP_APP_SCENE_KEYS_REMOVED_H

// What to do about the key at that path, as "contact.friction.law"; NULL: there never was one.
const char *app_scene_keys_removed(const char *path);

// What to do about a value of the key at that path; NULL: it never had it.
const char *app_scene_keys_removed_value(const char *path, const char *value);

#endif

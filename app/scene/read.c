// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/read.h"

#include <stdio.h>
#include <string.h>

#include "app/scene/check.h"
#include "app/scene/keys/removed.h"
#include "app/scene/override.h"
#include "app/scene/value.h"
#include "base/memory.h"

enum { MESSAGE_SIZE = 512, MAX_ITEMS = 10000 };

static void *field_of(void *self, size_t offset) {
  return (char *)self + offset;
}

// Sections.

static Status read_section(const SceneSection *section, const SceneNode *node, void *self);
static Status read_defaults(const SceneSection *section, void *self);

static Status read_list(const SceneKey *key, const SceneNode *node, void *self) {
  if (node->kind != SCENE_NODE_LIST) return app_scene_value_fail(key, node, "");
  if (node->count == 0)
    return key->required ? app_scene_value_fail(key, node, "; give at least one") : STATUS_OK;
  if (node->count > MAX_ITEMS) return app_scene_value_fail(key, node, "; that is too long");
  char *items = memory_zeroed((size_t)node->count, key->section->size);
  if (!items) return status_no_memory("the scene");
  *(void **)field_of(self, key->offset) = items;
  *(int *)field_of(self, key->count_offset) = node->count;
  for (const SceneNode *item = node->first; item; item = item->next, items += key->section->size) {
    if (item->kind != SCENE_NODE_MAP) {
      SceneKey expected = {.type = SCENE_SECTION};
      return app_scene_value_fail(&expected, item, "");
    }
    TRY(read_defaults(key->section, items));
    TRY(read_section(key->section, item, items));
  }
  return STATUS_OK;
}

static Status read_value(const SceneKey *key, const SceneNode *node, void *self);

static void keep_place(const SceneSection *section, const SceneNode *node, void *self) {
  if (section->has_place)
    *(FemScenePlace *)field_of(self, section->place_offset) = (FemScenePlace){node->line, node->column};
}

static Status read_entry(const SceneKey *key, const SceneNode *node, void *self);

// A section in its place, which a scalar may stand for.
static Status read_subsection(const SceneKey *key, const SceneNode *node, void *field) {
  const SceneSection *section = key->section;
  if (node->kind == SCENE_NODE_MAP) return read_section(section, node, field);
  const SceneKey *meant = section->shorthand ? app_scene_keys_find(section, section->shorthand) : NULL;
  bool is_number = meant && (meant->type == SCENE_NUMBER || meant->type == SCENE_INTEGER);
  bool is_meant = meant && node->kind == (is_number ? SCENE_NODE_NUMBER : SCENE_NODE_TEXT);
  if (!is_meant) {
    char path[MESSAGE_SIZE], hint[MESSAGE_SIZE];
    app_scene_tree_path(node, path, sizeof path);
    const char *advice =
        node->kind == SCENE_NODE_TEXT ? app_scene_keys_removed_value(path, node->text) : NULL;
    snprintf(hint, sizeof hint, "%s%s", advice ? "; " : "", advice ? advice : "");
    return app_scene_value_fail(key, node, hint);
  }
  keep_place(section, node, field);
  return read_entry(meant, node, field);
}

static Status read_value(const SceneKey *key, const SceneNode *node, void *self) {
  void *field = field_of(self, key->offset);
  switch (key->type) {
  case SCENE_SECTION:
    return read_subsection(key, node, field);
  case SCENE_LIST:
    return read_list(key, node, self);
  default:
    return app_scene_value_read(key, node, self);
  }
}

// Nothing in a key's place is as if the key were not there; but where its mere presence says something, one
// cannot know what was meant.
static Status read_entry(const SceneKey *key, const SceneNode *node, void *self) {
  if (node->kind == SCENE_NODE_NULL) {
    if (key->mark.size == 0 || node->line == 0) return STATUS_OK;
    return app_scene_tree_fail_key(node, "there is no value after '%s:'; %s, or remove the key", key->name,
                                   key->type == SCENE_SECTION ? "write '{}' for the defaults"
                                                              : "write a value");
  }
  if (key->mark.size > 0)
    app_scene_value_store(field_of(self, key->mark.offset), key->mark.size, key->mark.value);
  return read_value(key, node, self);
}

// Rules about which keys stand together.

static bool is_given(const SceneNode *map, const char *name) {
  const SceneNode *entry = app_scene_tree_find(map, name);
  return entry && entry->kind != SCENE_NODE_NULL;
}

static Status fail_unknown(const SceneSection *section, const SceneNode *entry) {
  char path[MESSAGE_SIZE], other[MESSAGE_SIZE], names[MESSAGE_SIZE];
  app_scene_tree_path(entry, path, sizeof path);
  const char *advice = app_scene_keys_removed(path);
  if (advice) return app_scene_tree_fail_key(entry, "%s: there is no such key any more; %s", path, advice);
  app_scene_tree_path(entry->parent, path, sizeof path);
  TextGuess guess = text_guess_of(entry->key);
  size_t used = 0;
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    text_guess_offer(&guess, key->name);
    text_append(names, sizeof names, &used, "%s%s", i ? ", " : "", key->name);
  }
  if (guess.best)
    return app_scene_tree_fail_key(entry, "unknown key '%.60s' in %s; did you mean '%s'?", entry->key, path,
                                   guess.best);
  // One of the scene's own keys is unknown only where the file is no scene.
  if (app_scene_keys_locate(&app_scene_keys_root, entry->key, other, sizeof other) &&
      strcmp(other, entry->key) != 0)
    return app_scene_tree_fail_key(entry, "unknown key '%.60s' in %s; did you mean %s? The keys here are %s",
                                   entry->key, path, other, names);
  return app_scene_tree_fail_key(entry, "unknown key '%.60s' in %s; the keys here are %s", entry->key, path,
                                 names);
}

static Status check_key_rules(const SceneKey *key, const SceneNode *map) {
  char path[MESSAGE_SIZE], word[TEXT_MAX_WORD];
  app_scene_tree_path(map, path, sizeof path);
  if (!is_given(map, key->name)) {
    if (!key->required) return STATUS_OK;
    return app_scene_tree_fail(map, "%s needs '%s', for example %s: %s", path, key->name, key->name,
                               key->required);
  }
  const SceneNode *entry = app_scene_tree_find(map, key->name);
  for (const char *rest = text_next(key->needs, word); rest; rest = text_next(rest, word))
    if (!is_given(map, word))
      return app_scene_tree_fail_key(entry, "'%s' in %s also needs '%s'", key->name, path, word);
  for (const char *rest = text_next(key->excludes, word); rest; rest = text_next(rest, word))
    if (is_given(map, word))
      return app_scene_tree_fail_key(entry, "'%s' in %s contradicts '%s'; keep one of them", key->name, path,
                                     word);
  return STATUS_OK;
}

// Exactly one of `one_of`, at least one of `some_of`.
static Status check_alternatives(const SceneSection *section, const SceneNode *map) {
  char path[MESSAGE_SIZE], word[TEXT_MAX_WORD];
  app_scene_tree_path(map, path, sizeof path);
  const SceneNode *chosen = NULL;
  for (const SceneNode *entry = map->first; entry; entry = entry->next) {
    if (entry->kind == SCENE_NODE_NULL || !text_lists(section->one_of, entry->key)) continue;
    if (chosen)
      return app_scene_tree_fail_key(entry, "'%s' and '%s' in %s contradict each other; keep one of them",
                                     chosen->key, entry->key, path);
    chosen = entry;
  }
  if (section->one_of && !chosen)
    return app_scene_tree_fail(map, "%s needs one of these keys: %s", path, section->one_of);
  bool is_met = !section->some_of;
  for (const char *rest = text_next(section->some_of, word); rest; rest = text_next(rest, word))
    is_met = is_met || is_given(map, word);
  return is_met ? STATUS_OK
                : app_scene_tree_fail(map, "%s needs at least one of these keys: %s", path, section->some_of);
}

static Status finish_section(const SceneSection *section, const SceneNode *map, void *self) {
  const char *blamed = "";
  const char *wrong = section->finish ? section->finish(self, &blamed) : NULL;
  if (!wrong) return STATUS_OK;
  const SceneNode *entry = app_scene_tree_find(map, blamed);
  char path[MESSAGE_SIZE];
  app_scene_tree_path(map, path, sizeof path);
  return app_scene_tree_fail(entry ? entry : map, "%s: %s", path, wrong);
}

static Status read_section(const SceneSection *section, const SceneNode *map, void *self) {
  for (const SceneNode *entry = map->first; entry; entry = entry->next) {
    const SceneKey *key = app_scene_keys_find(section, entry->key);
    if (!key) return fail_unknown(section, entry);
    TRY(read_entry(key, entry, self));
  }
  const SceneKey *key;
  TRY(check_alternatives(section, map));
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) TRY(check_key_rules(key, map));
  keep_place(section, map, self);
  return finish_section(section, map, self);
}

// Defaults are written in the table as in a file, and read the same way.
static Status read_default(const SceneKey *key, void *self) {
  SceneNode *node;
  Status status = app_scene_tree_parse(key->name, key->fallback, strlen(key->fallback), &node);
  if (!status) status = read_value(key, node, self);
  app_scene_tree_destroy(node);
  return status;
}

// Fills the struct that a section describes, zeroed before, with the defaults of its keys.
static Status read_defaults(const SceneSection *section, void *self) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    if (key->type == SCENE_SECTION)
      TRY(read_defaults(key->section, field_of(self, key->offset)));
    else if (key->fallback)
      TRY(read_default(key, self));
    else if (key->type == SCENE_NUMBER)
      *(double *)field_of(self, key->offset) = key->absent;
    else if (key->type == SCENE_INTEGER)
      *(int *)field_of(self, key->offset) = (int)key->absent;
  }
  return STATUS_OK;
}

// Defaults own no more than texts.
static void free_texts(const SceneSection *section, void *self) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    void *field = field_of(self, key->offset);
    if (key->type == SCENE_SECTION) free_texts(key->section, field);
    if (key->type == SCENE_TEXT || key->type == SCENE_LABEL || key->type == SCENE_NAME)
      memory_free(*(char **)field);
  }
}

void app_scene_read_destroy_defaults(const SceneSection *section, void *defaults) {
  if (defaults) free_texts(section, defaults);
  memory_free(defaults);
}

Status app_scene_read_create_defaults(const SceneSection *section, void **defaults) {
  *defaults = memory_zeroed(1, section->size);
  if (!*defaults) return status_no_memory("the defaults of a scene");
  Status status = read_defaults(section, *defaults);
  if (!status) return STATUS_OK;
  app_scene_read_destroy_defaults(section, *defaults);
  *defaults = NULL;
  return status;
}

// Of the model's word; the section's where it has none.
static FemScenePlace overlap_place(const SceneNode *root) {
  const SceneNode *contact = app_scene_tree_find(root, "contact");
  if (!contact) return (FemScenePlace){0};
  const SceneNode *word = contact->kind == SCENE_NODE_MAP ? app_scene_tree_find(contact, "overlap") : NULL;
  if (!word) word = contact;
  return (FemScenePlace){word->line, word->column};
}

static Status read_tree(const char *path, const SceneNode *root, FemSceneDef *scene) {
  if (root->kind == SCENE_NODE_NULL)
    return app_scene_tree_fail(root, "the scene is empty; it needs at least 'time' and 'bodies'");
  if (root->kind != SCENE_NODE_MAP) {
    SceneKey expected = {.type = SCENE_SECTION};
    return app_scene_value_fail(&expected, root, "");
  }
  scene->path = memory_copy(path, strlen(path) + 1, 1);
  if (!scene->path) return status_no_memory("the scene");
  TRY(read_defaults(&app_scene_keys_root, scene));
  TRY(read_section(&app_scene_keys_root, root, scene));
  scene->contact.overlap_place = overlap_place(root);
  return app_scene_check(root, scene);
}

Status app_scene_read_tree(const char *path, SceneNode *root, const char *const *overrides,
                           int override_count, FemSceneDef *scene) {
  *scene = (FemSceneDef){0};
  Status status = STATUS_OK;
  for (int i = 0; i < override_count && !status; i++) status = app_scene_override_apply(root, overrides[i]);
  if (!status) status = read_tree(path, root, scene);
  app_scene_tree_destroy(root);
  if (status) fem_scene_destroy(scene);
  return status;
}

Status app_scene_read(const char *path, const char *const *overrides, int override_count,
                      FemSceneDef *scene) {
  *scene = (FemSceneDef){0};
  SceneNode *root;
  TRY(app_scene_tree_read(path, &root));
  return app_scene_read_tree(path, root, overrides, override_count, scene);
}

static Status read_root(const SceneNode *root, const SceneSection *section, void *self) {
  if (root->kind != SCENE_NODE_MAP) {
    SceneKey expected = {.type = SCENE_SECTION};
    return app_scene_value_fail(&expected, root, "");
  }
  TRY(read_defaults(section, self));
  return read_section(section, root, self);
}

Status app_scene_read_section(const char *path, const char *const *overrides, int override_count,
                              const SceneSection *section, void *self) {
  static const char title[] = "the configuration";
  SceneNode *root;
  TRY(app_scene_tree_read(path, &root));
  root->key = memory_copy(title, sizeof title, 1);
  Status status = root->key ? STATUS_OK : status_no_memory(title);
  for (int i = 0; i < override_count && !status; i++) status = app_scene_override_apply(root, overrides[i]);
  if (!status) status = read_root(root, section, self);
  app_scene_tree_destroy(root);
  return status;
}

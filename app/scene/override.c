// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/override.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

enum { WORD_SIZE = 128, MESSAGE_SIZE = 512 };

static Status fail(const char *override, const char *reason) {
  return status_fail(STATUS_USAGE, "--set %s: %s; expected a path and a value, as contact.stiffness=1e6",
                     override, reason);
}

// Takes the next step of a path, "word" or "[3]", with the dot that follows it. False: no step stands there.
static bool take_step(const char **path, char word[WORD_SIZE], bool *is_number) {
  *is_number = (*path)[0] == '[';
  const char *begin = *path + *is_number;
  size_t length = strcspn(begin, *is_number ? "]" : ".[");
  const char *end = begin + length;
  if (*is_number && (end[0] != ']' || strspn(begin, "0123456789") != length)) return false;
  if (length == 0 || length >= WORD_SIZE) return false;
  memcpy(word, begin, length);
  word[length] = 0;
  end += *is_number;
  if (end[0] == '.' && end[1] == 0) return false;
  *path = end + (end[0] == '.');
  return true;
}

static bool is_named(const SceneNode *item, const char *name) {
  const SceneNode *entry = app_scene_tree_find(item, "name");
  return entry && entry->kind == SCENE_NODE_TEXT && strcmp(entry->text, name) == 0;
}

static Status step_into_list(const char *override, SceneNode *list, const char *word, bool is_number,
                             SceneNode **child) {
  if (is_number) {
    *child = app_scene_tree_at(list, strlen(word) > 6 ? list->count : atoi(word));
    if (*child) return STATUS_OK;
  } else {
    for (*child = list->first; *child; *child = (*child)->next)
      if (is_named(*child, word)) return STATUS_OK;
  }
  char path[MESSAGE_SIZE], names[MESSAGE_SIZE] = "";
  size_t used = 0;
  app_scene_tree_path(list, path, sizeof path);
  if (!is_number && strspn(word, "0123456789") == strlen(word))
    return status_fail(STATUS_USAGE, "--set %s: an item's number stands in brackets, from 0: %s[%s]",
                       override, path, word);
  for (const SceneNode *item = list->first; item; item = item->next) {
    const SceneNode *name = app_scene_tree_find(item, "name");
    if (name && name->text) text_append(names, sizeof names, &used, "%s%s", used ? ", " : ": ", name->text);
  }
  return status_fail(STATUS_USAGE, "--set %s: %s has no item '%s'; there are %d%s", override, path, word,
                     list->count, names);
}

// The entry of a map, made if there is none.
static Status step_into_map(const char *override, SceneNode *map, const char *word, SceneNode **child) {
  *child = app_scene_tree_find(map, word);
  if (*child) return STATUS_OK;
  *child = app_scene_tree_add(map, word);
  if (!*child) return status_no_memory("the scene");
  (*child)->origin = override;
  (*child)->line = (*child)->key_line = 0;
  return STATUS_OK;
}

static Status step_into(const char *override, SceneNode *node, const char *word, bool is_number,
                        SceneNode **child) {
  if (node->kind == SCENE_NODE_NULL && !is_number) {
    node->kind = SCENE_NODE_MAP;
    node->origin = override;
    node->line = 0;
  }
  if (node->kind == SCENE_NODE_LIST) return step_into_list(override, node, word, is_number, child);
  if (node->kind == SCENE_NODE_MAP && !is_number) return step_into_map(override, node, word, child);
  char path[MESSAGE_SIZE], found[MESSAGE_SIZE];
  app_scene_tree_path(node, path, sizeof path);
  app_scene_tree_describe(node, found, sizeof found);
  return status_fail(STATUS_USAGE, "--set %s: %s is %s, so it has no '%s'; set all of %s", override, path,
                     found, word, path);
}

// The parser's message without its place, which counts from the value: "override:line:column: …".
static Status fail_value(const char *override) {
  char message[MESSAGE_SIZE];
  const char *reason = strstr(status_message() + strlen(override), ": ");
  snprintf(message, sizeof message, "%s", reason ? reason + 2 : status_message());
  return status_fail(STATUS_USAGE, "--set %s: %s", override, message);
}

Status app_scene_override_apply(SceneNode *root, const char *override) {
  const char *equals = strchr(override, '=');
  if (!equals) return fail(override, "no '='");
  char keys[MESSAGE_SIZE], word[WORD_SIZE];
  size_t length = (size_t)(equals - override);
  if (length == 0 || length >= sizeof keys) return fail(override, "no path before the '='");
  memcpy(keys, override, length);
  keys[length] = 0;
  SceneNode *node = root, *value;
  for (const char *rest = keys; rest[0];) {
    bool is_number;
    if (!take_step(&rest, word, &is_number)) return fail(override, "the path cannot be understood");
    TRY(step_into(override, node, word, is_number, &node));
  }
  Status status = app_scene_tree_parse(override, equals + 1, strlen(equals + 1), &value);
  if (status == STATUS_INPUT) return fail_value(override);
  TRY(status);
  app_scene_tree_mark_override(value);
  app_scene_tree_replace(node, value);
  return STATUS_OK;
}

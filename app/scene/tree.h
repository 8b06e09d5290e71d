// SPDX-License-Identifier: GPL-3.0-or-later
// A YAML or JSON text as a tree of nodes, each of which knows where it stands. Nothing here knows what a
// scene is.
//
// YAML is read as its core schema (1.2): null, true and false, numbers, text; `1e6` is a number, `yes` is
// text, what stands in quotes is text. Refused, by name and place: anchors and aliases, tags, keys that are
// not text, duplicate keys, a second document, nesting beyond SCENE_TREE_MAX_DEPTH, more nodes or bytes than
// the limits below, what is not UTF-8.
#ifndef TETLAP_APP_SCENE_TREE_H
#define TETLAP_APP_SCENE_TREE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

enum {
  SCENE_TREE_MAX_DEPTH = 32,
  SCENE_TREE_MAX_NODES = 1000000,
  SCENE_TREE_MAX_KEYS = 1000, // of one map
  SCENE_TREE_MAX_BYTES = 16 << 20,
};

typedef enum SceneNodeKind {
  SCENE_NODE_NULL,
  SCENE_NODE_SWITCH, // true or false
  SCENE_NODE_NUMBER,
  SCENE_NODE_TEXT,
  SCENE_NODE_LIST,
  SCENE_NODE_MAP,
} SceneNodeKind;

typedef struct SceneNode SceneNode;
struct SceneNode {
  SceneNodeKind kind;
  const char *origin;       // the file's path, or the override "key=value"; borrowed
  int line, column;         // of the value, from 1; line 0: an override
  int key_line, key_column; // of the key
  char *key;                // of an entry of a map, owned; NULL: an item of a list, the root
  char *text;               // a scalar as it was written, owned
  double number;            // may be NaN or infinite: `.nan`, `.inf`
  bool is_true;
  int count;               // children
  SceneNode *parent;       // NULL: the root
  SceneNode *first, *last; // children, owned
  SceneNode *next;         // the next child of the parent
};

// Parses a text; `origin` is kept, not copied. STATUS_INPUT with origin:line:column and what to do.
// `*root` is owned by the caller.
Status app_scene_tree_parse(const char *origin, const char *text, size_t size, SceneNode **root);
// The same of a file. STATUS_IO: it cannot be read.
Status app_scene_tree_read(const char *path, SceneNode **root);
void app_scene_tree_destroy(SceneNode *root);

// The entry of a map, NULL if there is none; `node` may be of any kind.
SceneNode *app_scene_tree_find(const SceneNode *node, const char *key);
// The item of a list or a map by number.
SceneNode *app_scene_tree_at(const SceneNode *node, int index);

// A new empty node of that kind, as the last child of `parent` under a copy of `key` (NULL in a list), at the
// parent's place. NULL: no memory.
SceneNode *app_scene_tree_add(SceneNode *parent, const char *key);
// Puts the value of `source` (a root) in the place of the value of `node`; `source` is used up.
void app_scene_tree_replace(SceneNode *node, SceneNode *source);
// Every node of the tree is from the command line: line 0.
void app_scene_tree_mark_override(SceneNode *root);

// "bodies[0].material.young"; for the root its key, "the scene" without one.
void app_scene_tree_path(const SceneNode *node, char *path, size_t size);
// "the number 3", "the text 'soft'", "a list of 2", …
void app_scene_tree_describe(const SceneNode *node, char *text, size_t size);

// Fails with origin:line:column of the value (or of its key) before the message. STATUS_INPUT; of an override
// STATUS_USAGE.
Status app_scene_tree_fail(const SceneNode *node, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
Status app_scene_tree_fail_key(const SceneNode *node, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/read.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/scene/override.h"
#include "base/expression.h"
#include "base/memory.h"
#include "fem/effect/effect.h"

enum { MESSAGE_SIZE = 512, MAX_ITEMS = 10000 };

static void *field_of(void *self, size_t offset) {
  return (char *)self + offset;
}

// Fails with what the key expects against what the node is.
static Status fail_expected(const SceneKey *key, const SceneNode *node, const char *hint) {
  char path[MESSAGE_SIZE], expected[MESSAGE_SIZE], found[MESSAGE_SIZE];
  app_scene_tree_path(node, path, sizeof path);
  app_scene_keys_expect(key, expected, sizeof expected);
  app_scene_tree_describe(node, found, sizeof found);
  return app_scene_tree_fail(node, "%s: expected %s, found %s%s", path, expected, found, hint);
}

// Values of one type each. `field` is where the value goes.

static bool is_whole(double number) {
  return number == floor(number) && fabs(number) <= INT_MAX;
}

static Status read_number(const SceneKey *key, const SceneNode *node, double *field) {
  if (node->kind != SCENE_NODE_NUMBER || !app_scene_keys_allows(key, node->number))
    return fail_expected(key, node, "");
  *field = node->number;
  return STATUS_OK;
}

static Status read_integer(const SceneKey *key, const SceneNode *node, int *field) {
  bool is_good = node->kind == SCENE_NODE_NUMBER && is_whole(node->number);
  if (!is_good || !app_scene_keys_allows(key, node->number)) return fail_expected(key, node, "");
  *field = (int)node->number;
  return STATUS_OK;
}

static Status read_switch(const SceneKey *key, const SceneNode *node, bool *field) {
  if (node->kind != SCENE_NODE_SWITCH) return fail_expected(key, node, "");
  *field = node->is_true;
  return STATUS_OK;
}

static Status read_true(const SceneKey *key, const SceneNode *node) {
  bool is_good = node->kind == SCENE_NODE_SWITCH && node->is_true;
  return is_good ? STATUS_OK : fail_expected(key, node, "; leave the key out to say no");
}

static Status read_text(const SceneKey *key, const SceneNode *node, char **field) {
  if (node->kind == SCENE_NODE_NUMBER || node->kind == SCENE_NODE_SWITCH)
    return fail_expected(key, node, "; put it in quotes");
  if (node->kind != SCENE_NODE_TEXT || node->text[0] == 0) return fail_expected(key, node, "");
  char *copy = memory_copy(node->text, strlen(node->text) + 1, 1);
  if (!copy) return status_no_memory("the scene");
  memory_free(*field);
  *field = copy;
  return STATUS_OK;
}

// Names become parts of file names, columns of tables and paths of overrides.
static Status read_label(const SceneKey *key, const SceneNode *node, char **field) {
  static const char *const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
  bool is_good = node->kind != SCENE_NODE_TEXT || node->text[strspn(node->text, letters)] == 0;
  return is_good ? read_text(key, node, field) : fail_expected(key, node, "");
}

// The number of the chosen name.
static Status find_choice(const SceneKey *key, const SceneNode *node, int *choice) {
  if (node->kind != SCENE_NODE_TEXT) return fail_expected(key, node, "");
  *choice = app_scene_keys_choice(key, node->text);
  if (*choice >= 0) return STATUS_OK;
  TextGuess guess = text_guess_of(node->text);
  const char *name;
  for (int i = 0; (name = key->choices->name(i)); i++) text_guess_offer(&guess, name);
  char hint[128] = "";
  if (guess.best) snprintf(hint, sizeof hint, "; did you mean '%s'?", guess.best);
  return fail_expected(key, node, hint);
}

static Status read_name(const SceneKey *key, const SceneNode *node, char **field) {
  int choice;
  TRY(find_choice(key, node, &choice));
  return read_text(key, node, field);
}

static Status read_two(const SceneKey *key, const SceneNode *node, char *field[2]) {
  if (node->kind != SCENE_NODE_LIST || node->count != 2) return fail_expected(key, node, "");
  for (const SceneNode *item = node->first; item; item = item->next) TRY(read_text(key, item, field++));
  return STATUS_OK;
}

// An enum or a flag, by its size.
static void store_choice(void *field, size_t size, int value) {
  if (size == sizeof(bool))
    *(bool *)field = value != 0;
  else
    memcpy(field, &value, sizeof value);
}

static Status read_choice(const SceneKey *key, const SceneNode *node, void *field) {
  int choice = node->is_true;
  bool is_switch = key->choices->takes_switch && node->kind == SCENE_NODE_SWITCH;
  if (!is_switch) TRY(find_choice(key, node, &choice));
  store_choice(field, key->size, choice);
  return STATUS_OK;
}

// A list of `count` numbers, each of which obeys the key's range.
static Status read_numbers(const SceneKey *key, const SceneNode *node, int count, double *field) {
  if (node->kind != SCENE_NODE_LIST || node->count != count) return fail_expected(key, node, "");
  SceneKey component = *key;
  component.type = SCENE_NUMBER;
  for (const SceneNode *item = node->first; item; item = item->next)
    TRY(read_number(&component, item, field++));
  return STATUS_OK;
}

static Status read_direction(const SceneKey *key, const SceneNode *node, double field[3]) {
  TRY(read_numbers(key, node, 3, field));
  bool is_zero = field[0] == 0 && field[1] == 0 && field[2] == 0;
  return is_zero ? fail_expected(key, node, " that are all zero") : STATUS_OK;
}

static Status read_factors(const SceneKey *key, const SceneNode *node, double field[3]) {
  if (node->kind == SCENE_NODE_NUMBER) {
    TRY(read_number(key, node, field));
    field[1] = field[2] = field[0];
  } else {
    TRY(read_numbers(key, node, 3, field));
  }
  for (int c = 0; c < 3; c++)
    if (field[c] == 0) return fail_expected(key, node, " with a zero");
  return STATUS_OK;
}

static Status read_counts(const SceneKey *key, const SceneNode *node, int field[3]) {
  if (node->kind == SCENE_NODE_NUMBER) {
    TRY(read_integer(key, node, field));
    field[1] = field[2] = field[0];
    return STATUS_OK;
  }
  if (node->kind != SCENE_NODE_LIST || node->count != 3) return fail_expected(key, node, "");
  SceneKey component = *key;
  component.type = SCENE_INTEGER;
  for (const SceneNode *item = node->first; item; item = item->next)
    TRY(read_integer(&component, item, field++));
  return STATUS_OK;
}

static int axis_of(const SceneNode *node) {
  static const char *const names[] = {"x", "y", "z"};
  for (int c = 0; c < 3; c++)
    if (node->kind == SCENE_NODE_TEXT && strcmp(node->text, names[c]) == 0) return c;
  return -1;
}

static Status read_axes(const SceneKey *key, const SceneNode *node, bool field[3]) {
  if (node->kind != SCENE_NODE_LIST || node->count == 0) return fail_expected(key, node, "");
  field[0] = field[1] = field[2] = false;
  for (const SceneNode *item = node->first; item; item = item->next) {
    int axis = axis_of(item);
    if (axis < 0) return fail_expected(key, item, "");
    if (field[axis]) return fail_expected(key, item, " a second time");
    field[axis] = true;
  }
  return STATUS_OK;
}

// Rows one after another; the rows may also stand in one flat list, as the resolved scene is written.
static Status read_rows(const SceneKey *key, const SceneNode *node, void *self) {
  int width = app_scene_keys_row_width(key);
  bool is_flat = node->kind == SCENE_NODE_LIST && node->count > 0 && node->first->kind == SCENE_NODE_NUMBER;
  int count = is_flat ? node->count / width : node->count;
  if (node->kind != SCENE_NODE_LIST || count == 0 || (is_flat && node->count % width != 0))
    return fail_expected(key, node, "");
  double *rows = memory_zeroed((size_t)count, (size_t)width * sizeof *rows);
  if (!rows) return status_no_memory("the scene");
  memory_free(*(double **)field_of(self, key->offset));
  *(double **)field_of(self, key->offset) = rows;
  *(int *)field_of(self, key->count_offset) = count;
  if (is_flat) return read_numbers(key, node, width * count, rows);
  for (const SceneNode *row = node->first; row; row = row->next, rows += width)
    TRY(read_numbers(key, row, width, rows));
  return STATUS_OK;
}

static Status read_increasing_rows(const SceneKey *key, const SceneNode *node, void *self) {
  TRY(read_rows(key, node, self));
  const double *rows = *(double **)field_of(self, key->offset);
  int count = *(int *)field_of(self, key->count_offset), width = app_scene_keys_row_width(key);
  for (int i = 1; i < count; i++) {
    if (rows[width * i] > rows[width * (i - 1)]) continue;
    char path[MESSAGE_SIZE];
    app_scene_tree_path(node, path, sizeof path);
    bool is_flat = node->first->kind == SCENE_NODE_NUMBER;
    const SceneNode *row = app_scene_tree_at(node, is_flat ? width * i : i);
    return app_scene_tree_fail(row, "%s: the time %g of row %d does not follow %g; times must increase", path,
                               rows[width * i], i, rows[width * (i - 1)]);
  }
  return STATUS_OK;
}

static Status read_formula(const SceneKey *key, const SceneNode *node, Expression **field) {
  if (node->kind != SCENE_NODE_NUMBER && node->kind != SCENE_NODE_TEXT) return fail_expected(key, node, "");
  Expression *expression = memory_zeroed(1, sizeof *expression);
  if (!expression) return status_no_memory("the scene");
  memory_free(*field);
  *field = expression;
  bool is_parsed = expression_parse(expression, node->text) == STATUS_OK;
  expression->line = node->line;
  expression->column = node->column;
  if (is_parsed) return STATUS_OK;
  char path[MESSAGE_SIZE], wrong[MESSAGE_SIZE];
  app_scene_tree_path(node, path, sizeof path);
  snprintf(wrong, sizeof wrong, "%s", status_message());
  return app_scene_tree_fail(node, "%s: %s", path, wrong);
}

// Sections.

static Status read_section(const SceneSection *section, const SceneNode *node, void *self);

static Status read_list(const SceneKey *key, const SceneNode *node, void *self) {
  if (node->kind != SCENE_NODE_LIST) return fail_expected(key, node, "");
  if (node->count == 0) return key->required ? fail_expected(key, node, ", one at least") : STATUS_OK;
  if (node->count > MAX_ITEMS) return fail_expected(key, node, "; that is too long");
  char *items = memory_zeroed((size_t)node->count, key->section->size);
  if (!items) return status_no_memory("the scene");
  *(void **)field_of(self, key->offset) = items;
  *(int *)field_of(self, key->count_offset) = node->count;
  for (const SceneNode *item = node->first; item; item = item->next, items += key->section->size) {
    if (item->kind != SCENE_NODE_MAP) {
      SceneKey expected = {.type = SCENE_SECTION};
      return fail_expected(&expected, item, "");
    }
    TRY(app_scene_read_defaults(key->section, items));
    TRY(read_section(key->section, item, items));
  }
  return STATUS_OK;
}

static Status read_value(const SceneKey *key, const SceneNode *node, void *self);

static void keep_place(const SceneSection *section, const SceneNode *node, void *self) {
  if (section->has_place)
    *(FemScenePlace *)field_of(self, section->place_offset) = (FemScenePlace){node->line, node->column};
}

// A section in its place, which a scalar may stand for.
static Status read_subsection(const SceneKey *key, const SceneNode *node, void *field) {
  const SceneSection *section = key->section;
  if (node->kind == SCENE_NODE_MAP) return read_section(section, node, field);
  const SceneKey *meant = section->shorthand ? app_scene_keys_find(section, section->shorthand) : NULL;
  bool is_number = meant && (meant->type == SCENE_NUMBER || meant->type == SCENE_INTEGER);
  bool is_meant = meant && node->kind == (is_number ? SCENE_NODE_NUMBER : SCENE_NODE_TEXT);
  if (!is_meant) return fail_expected(key, node, "");
  keep_place(section, node, field);
  return read_value(meant, node, field);
}

static Status read_value(const SceneKey *key, const SceneNode *node, void *self) {
  void *field = field_of(self, key->offset);
  switch (key->type) {
  case SCENE_NUMBER:
    return read_number(key, node, field);
  case SCENE_INTEGER:
    return read_integer(key, node, field);
  case SCENE_SWITCH:
    return read_switch(key, node, field);
  case SCENE_TRUE:
    return read_true(key, node);
  case SCENE_TEXT:
    return read_text(key, node, field);
  case SCENE_LABEL:
    return read_label(key, node, field);
  case SCENE_NAME:
    return read_name(key, node, field);
  case SCENE_CHOICE:
    return read_choice(key, node, field);
  case SCENE_TWO:
    return read_two(key, node, field);
  case SCENE_VECTOR:
    return read_numbers(key, node, 3, field);
  case SCENE_DIRECTION:
    return read_direction(key, node, field);
  case SCENE_FACTORS:
    return read_factors(key, node, field);
  case SCENE_COUNTS:
    return read_counts(key, node, field);
  case SCENE_AXES:
    return read_axes(key, node, field);
  case SCENE_ROWS:
  case SCENE_PROFILE:
    return read_increasing_rows(key, node, self);
  case SCENE_FORMULA:
    return read_formula(key, node, field);
  case SCENE_SECTION:
    return read_subsection(key, node, field);
  case SCENE_LIST:
    return read_list(key, node, self);
  }
  return STATUS_OK;
}

// Nothing in a key's place is as if the key were not there; but where its mere presence says something, one
// cannot know what was meant.
static Status read_entry(const SceneKey *key, const SceneNode *node, void *self) {
  if (node->kind == SCENE_NODE_NULL) {
    if (key->mark.size == 0 || node->line == 0) return STATUS_OK;
    return app_scene_tree_fail_key(node, "nothing stands after '%s:'; %s, or take the key away", key->name,
                                   key->type == SCENE_SECTION ? "write '{}' for the defaults"
                                                              : "write a value");
  }
  if (key->mark.size > 0) store_choice(field_of(self, key->mark.offset), key->mark.size, key->mark.value);
  return read_value(key, node, self);
}

// Rules about which keys stand together.

static bool is_given(const SceneNode *map, const char *name) {
  const SceneNode *entry = app_scene_tree_find(map, name);
  return entry && entry->kind != SCENE_NODE_NULL;
}

static Status fail_unknown(const SceneSection *section, const SceneNode *entry) {
  char path[MESSAGE_SIZE], other[MESSAGE_SIZE], names[MESSAGE_SIZE];
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
  if (app_scene_keys_locate(&app_scene_keys_root, entry->key, other, sizeof other))
    return app_scene_tree_fail_key(entry, "unknown key '%.60s' in %s; there is %s, and here %s", entry->key,
                                   path, other, names);
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
      return app_scene_tree_fail_key(entry, "'%s' in %s needs '%s' beside it", key->name, path, word);
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

Status app_scene_read_defaults(const SceneSection *section, void *self) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    if (key->type == SCENE_SECTION)
      TRY(app_scene_read_defaults(key->section, field_of(self, key->offset)));
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
  Status status = app_scene_read_defaults(section, *defaults);
  if (!status) return STATUS_OK;
  app_scene_read_destroy_defaults(section, *defaults);
  *defaults = NULL;
  return status;
}

// Bodies and obstacles share one set of names.
static Status check_names(const SceneNode *root) {
  static const char *const lists[] = {"bodies", "obstacles"};
  for (int l = 0; l < 2; l++) {
    const SceneNode *list = app_scene_tree_find(root, lists[l]);
    for (const SceneNode *item = list ? list->first : NULL; item; item = item->next) {
      const SceneNode *name = app_scene_tree_find(item, "name");
      for (int m = 0; m <= l; m++) {
        const SceneNode *earlier = app_scene_tree_find(root, lists[m]);
        for (const SceneNode *other = earlier ? earlier->first : NULL; other && other != item;
             other = other->next)
          if (strcmp(app_scene_tree_find(other, "name")->text, name->text) == 0)
            return app_scene_tree_fail(name, "the name '%.60s' is taken by another of the %s; choose another",
                                       name->text, lists[m]);
      }
    }
  }
  return STATUS_OK;
}

// Self-contact is a part of contact.
static Status check_self_contact(const SceneNode *root, const FemSceneDef *scene) {
  const SceneNode *bodies = app_scene_tree_find(root, "bodies"), *body = bodies->first;
  for (int b = 0; b < scene->body_count; b++, body = body->next)
    if (scene->bodies[b].self_contact && !scene->contact.is_on)
      return app_scene_tree_fail_key(app_scene_tree_find(body, "self_contact"),
                                     "'self_contact' needs contact; write 'contact: {}' for its defaults");
  return STATUS_OK;
}

// Whether a number, or any of a list of them, is not zero.
static bool is_nonzero(const SceneNode *node) {
  for (const SceneNode *item = node ? node->first : NULL; item; item = item->next)
    if (is_nonzero(item)) return true;
  return node && node->kind == SCENE_NODE_NUMBER && node->number != 0;
}

// The value at "section.key".
static const SceneNode *find_path(const SceneNode *root, const char *path) {
  const char *point = strchr(path, '.');
  char section[64];
  snprintf(section, sizeof section, "%.*s", (int)(point - path), path);
  return app_scene_tree_find(app_scene_tree_find(root, section), point + 1);
}

static Status check_static_effects(const SceneNode *root, const FemSceneDef *scene) {
  int count;
  const FemEffectOps *const *effects = fem_effect_list(&count);
  for (int i = 0; i < count; i++)
    if (effects[i]->static_refusal && effects[i]->is_wanted(scene))
      return app_scene_tree_fail_key(find_path(root, effects[i]->static_key), "%s",
                                     effects[i]->static_refusal);
  return STATUS_OK;
}

// What only a motion can have.
static Status check_static(const SceneNode *root, const FemSceneDef *scene) {
  static const char *const initial[] = {"velocity", "spin"}, *const lists[] = {"fixed", "driven"};
  if (!scene->is_static) return STATUS_OK;
  TRY(check_static_effects(root, scene));
  const SceneNode *bodies = app_scene_tree_find(root, "bodies");
  for (const SceneNode *body = bodies->first; body; body = body->next)
    for (int k = 0; k < 2; k++) {
      const SceneNode *motion = app_scene_tree_find(body, initial[k]);
      const SceneNode *list = app_scene_tree_find(body, lists[k]);
      if (is_nonzero(motion))
        return app_scene_tree_fail_key(
            motion, "a static scene has no initial '%s'; take it or time.static away", initial[k]);
      for (const SceneNode *item = list ? list->first : NULL; item; item = item->next)
        if (app_scene_tree_find(item, "release"))
          return app_scene_tree_fail_key(app_scene_tree_find(item, "release"),
                                         "a static scene cannot release vertices; take 'release' or "
                                         "time.static away");
    }
  if (scene->solver == FEM_SOLVER_KLU)
    return app_scene_tree_fail(app_scene_tree_find(app_scene_tree_find(root, "solver"), "linear"),
                               "klu solves motions only; write cholmod, amg or pcg for a static scene");
  return STATUS_OK;
}

static Status read_tree(const char *path, const SceneNode *root, FemSceneDef *scene) {
  if (root->kind == SCENE_NODE_NULL)
    return app_scene_tree_fail(root, "the scene is empty; it needs at least 'time' and 'bodies'");
  if (root->kind != SCENE_NODE_MAP) {
    SceneKey expected = {.type = SCENE_SECTION};
    return fail_expected(&expected, root, "");
  }
  scene->path = memory_copy(path, strlen(path) + 1, 1);
  if (!scene->path) return status_no_memory("the scene");
  TRY(app_scene_read_defaults(&app_scene_keys_root, scene));
  TRY(read_section(&app_scene_keys_root, root, scene));
  TRY(check_names(root));
  TRY(check_self_contact(root, scene));
  return check_static(root, scene);
}

// Takes the tree over.
static Status read_and_destroy(const char *path, SceneNode *root, const char *const *overrides,
                               int override_count, FemSceneDef *scene) {
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
  return read_and_destroy(path, root, overrides, override_count, scene);
}

static Status read_root(const SceneNode *root, const SceneSection *section, void *self) {
  if (root->kind != SCENE_NODE_MAP) {
    SceneKey expected = {.type = SCENE_SECTION};
    return fail_expected(&expected, root, "");
  }
  TRY(app_scene_read_defaults(section, self));
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

Status app_scene_read_text(const char *path, const char *text, size_t size, FemSceneDef *scene) {
  *scene = (FemSceneDef){0};
  SceneNode *root;
  TRY(app_scene_tree_parse(path, text, size, &root));
  return read_and_destroy(path, root, NULL, 0, scene);
}

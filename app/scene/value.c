// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/value.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/scene/keys/removed.h"
#include "base/expression.h"
#include "base/memory.h"
#include "base/text.h"

enum { MESSAGE_SIZE = 512 };

static void *field_of(void *self, size_t offset) {
  return (char *)self + offset;
}

Status app_scene_value_fail(const SceneKey *key, const SceneNode *node, const char *hint) {
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
    return app_scene_value_fail(key, node, "");
  *field = node->number;
  return STATUS_OK;
}

static Status read_integer(const SceneKey *key, const SceneNode *node, int *field) {
  bool is_good = node->kind == SCENE_NODE_NUMBER && is_whole(node->number);
  if (!is_good || !app_scene_keys_allows(key, node->number)) return app_scene_value_fail(key, node, "");
  *field = (int)node->number;
  return STATUS_OK;
}

static Status read_switch(const SceneKey *key, const SceneNode *node, bool *field) {
  if (node->kind != SCENE_NODE_SWITCH) return app_scene_value_fail(key, node, "");
  *field = node->is_true;
  return STATUS_OK;
}

static Status read_true(const SceneKey *key, const SceneNode *node) {
  bool is_good = node->kind == SCENE_NODE_SWITCH && node->is_true;
  return is_good ? STATUS_OK : app_scene_value_fail(key, node, "; leave the key out to say no");
}

static Status read_text(const SceneKey *key, const SceneNode *node, char **field) {
  if (node->kind == SCENE_NODE_NUMBER || node->kind == SCENE_NODE_SWITCH)
    return app_scene_value_fail(key, node, "; put it in quotes");
  if (node->kind != SCENE_NODE_TEXT || node->text[0] == 0) return app_scene_value_fail(key, node, "");
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
  return is_good ? read_text(key, node, field) : app_scene_value_fail(key, node, "");
}

// The number of the chosen name.
static Status find_choice(const SceneKey *key, const SceneNode *node, int *choice) {
  if (node->kind != SCENE_NODE_TEXT) return app_scene_value_fail(key, node, "");
  *choice = app_scene_keys_choice(key, node->text);
  if (*choice >= 0) return STATUS_OK;
  TextGuess guess = text_guess_of(node->text);
  const char *name;
  for (int i = 0; (name = app_scene_section_name(key->choices, i)); i++) text_guess_offer(&guess, name);
  char hint[MESSAGE_SIZE] = "", path[MESSAGE_SIZE];
  app_scene_tree_path(node, path, sizeof path);
  const char *advice = app_scene_keys_removed_value(path, node->text);
  if (advice)
    snprintf(hint, sizeof hint, ", which there is no longer; %s", advice);
  else if (guess.best)
    snprintf(hint, sizeof hint, "; did you mean '%s'?", guess.best);
  return app_scene_value_fail(key, node, hint);
}

static Status read_name(const SceneKey *key, const SceneNode *node, char **field) {
  int choice;
  bool is_other = node->kind == SCENE_NODE_TEXT && key->choices->accepts && key->choices->accepts(node->text);
  if (!is_other) TRY(find_choice(key, node, &choice));
  return read_text(key, node, field);
}

static Status read_two(const SceneKey *key, const SceneNode *node, char *field[2]) {
  if (node->kind != SCENE_NODE_LIST || node->count != 2) return app_scene_value_fail(key, node, "");
  for (const SceneNode *item = node->first; item; item = item->next) TRY(read_text(key, item, field++));
  return STATUS_OK;
}

void app_scene_value_store(void *field, size_t size, int value) {
  if (size == sizeof(bool))
    *(bool *)field = value != 0;
  else
    memcpy(field, &value, sizeof value);
}

static Status read_choice(const SceneKey *key, const SceneNode *node, void *field) {
  int choice = node->is_true;
  bool is_switch = key->choices->takes_switch && node->kind == SCENE_NODE_SWITCH;
  if (!is_switch) TRY(find_choice(key, node, &choice));
  app_scene_value_store(field, key->size, choice);
  return STATUS_OK;
}

// A list of `count` numbers, each of which obeys the key's range.
static Status read_numbers(const SceneKey *key, const SceneNode *node, int count, double *field) {
  if (node->kind != SCENE_NODE_LIST || node->count != count) return app_scene_value_fail(key, node, "");
  SceneKey component = *key;
  component.type = SCENE_NUMBER;
  for (const SceneNode *item = node->first; item; item = item->next)
    TRY(read_number(&component, item, field++));
  return STATUS_OK;
}

static Status read_direction(const SceneKey *key, const SceneNode *node, double field[3]) {
  TRY(read_numbers(key, node, 3, field));
  bool is_zero = field[0] == 0 && field[1] == 0 && field[2] == 0;
  return is_zero ? app_scene_value_fail(key, node, " that are all zero") : STATUS_OK;
}

static Status read_factors(const SceneKey *key, const SceneNode *node, double field[3]) {
  if (node->kind == SCENE_NODE_NUMBER) {
    TRY(read_number(key, node, field));
    field[1] = field[2] = field[0];
  } else {
    TRY(read_numbers(key, node, 3, field));
  }
  for (int c = 0; c < 3; c++)
    if (field[c] == 0) return app_scene_value_fail(key, node, " with a zero");
  return STATUS_OK;
}

static Status read_counts(const SceneKey *key, const SceneNode *node, int field[3]) {
  if (node->kind == SCENE_NODE_NUMBER) {
    TRY(read_integer(key, node, field));
    field[1] = field[2] = field[0];
    return STATUS_OK;
  }
  if (node->kind != SCENE_NODE_LIST || node->count != 3) return app_scene_value_fail(key, node, "");
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
  if (node->kind != SCENE_NODE_LIST || node->count == 0) return app_scene_value_fail(key, node, "");
  field[0] = field[1] = field[2] = false;
  for (const SceneNode *item = node->first; item; item = item->next) {
    int axis = axis_of(item);
    if (axis < 0) return app_scene_value_fail(key, item, "");
    if (field[axis]) return app_scene_value_fail(key, item, " a second time");
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
    return app_scene_value_fail(key, node, "");
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
    const char *word = key->argument ? "depth" : "time";
    return app_scene_tree_fail(row, "%s: the %s %g of row %d does not follow %g; %ss must increase", path,
                               word, rows[width * i], i, rows[width * (i - 1)], word);
  }
  return STATUS_OK;
}

static Status read_formula(const SceneKey *key, const SceneNode *node, Expression **field) {
  if (node->kind != SCENE_NODE_NUMBER && node->kind != SCENE_NODE_TEXT)
    return app_scene_value_fail(key, node, "");
  Expression *expression = memory_zeroed(1, sizeof *expression);
  if (!expression) return status_no_memory("the scene");
  memory_free(*field);
  *field = expression;
  bool is_parsed = expression_parse(expression, app_scene_keys_argument(key), node->text) == STATUS_OK;
  expression->line = node->line;
  expression->column = node->column;
  if (is_parsed) return STATUS_OK;
  char path[MESSAGE_SIZE], wrong[MESSAGE_SIZE];
  app_scene_tree_path(node, path, sizeof path);
  snprintf(wrong, sizeof wrong, "%s", status_message());
  return app_scene_tree_fail(node, "%s: %s", path, wrong);
}

Status app_scene_value_read(const SceneKey *key, const SceneNode *node, void *self) {
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
  case SCENE_LIST:
    break; // made of values (app/scene/read.c)
  }
  return STATUS_OK;
}

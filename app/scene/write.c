// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/write.h"

#include <string.h>

#include "app/scene/read.h"
#include "base/expression.h"
#include "base/memory.h"

static const void *field_of(const void *self, size_t offset) {
  return (const char *)self + offset;
}

static const char *text_of(const SceneKey *key, const void *self) {
  return *(char *const *)field_of(self, key->offset);
}

static int count_of(const SceneKey *key, const void *self) {
  return *(const int *)field_of(self, key->count_offset);
}

static int choice_at(const void *field, size_t size) {
  int value;
  if (size == sizeof(bool)) return *(const bool *)field;
  memcpy(&value, field, sizeof value);
  return value;
}

// Which keys are written.

// Whether a key says anything that its absence would not.
static bool is_given(const SceneKey *key, const void *self, const void *defaults) {
  const void *field = field_of(self, key->offset), *standard = field_of(defaults, key->offset);
  const SceneKey *below;
  if (key->mark.size > 0)
    return choice_at(field_of(self, key->mark.offset), key->mark.size) == key->mark.value;
  switch (key->type) {
  case SCENE_TEXT:
  case SCENE_LABEL:
  case SCENE_NAME:
    return text_of(key, self) != NULL;
  case SCENE_TWO:
    return *(char *const *)field != NULL;
  case SCENE_FORMULA:
    return *(Expression *const *)field != NULL;
  case SCENE_ROWS:
  case SCENE_PROFILE:
  case SCENE_LIST:
    return count_of(key, self) > 0;
  case SCENE_SECTION:
    for (int i = 0; (below = app_scene_keys_at(key->section, i)); i++)
      if (is_given(below, field, standard)) return true;
    return false;
  default:
    return memcmp(field, standard, key->size) != 0;
  }
}

// Whether all (any) of the listed keys of a section are given.
static bool are_all_given(const SceneSection *section, const char *list, const void *self,
                          const void *defaults) {
  char word[TEXT_MAX_WORD];
  for (const char *rest = text_next(list, word); rest; rest = text_next(rest, word))
    if (!is_given(app_scene_keys_find(section, word), self, defaults)) return false;
  return true;
}

static bool is_any_given(const SceneSection *section, const char *list, const void *self,
                         const void *defaults) {
  char word[TEXT_MAX_WORD];
  for (const char *rest = text_next(list, word); rest; rest = text_next(rest, word))
    if (is_given(app_scene_keys_find(section, word), self, defaults)) return true;
  return false;
}

static bool is_empty_allowed(const SceneSection *section) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++)
    if (key->required) return false;
  return !section->one_of && !section->some_of;
}

// A key is written if it says something, else with its default, where reading would accept it: the keys that
// it needs are given, those that it excludes are not. (Keys that share a field exclude each other.)
static bool is_written(const SceneSection *section, const SceneKey *key, const void *self,
                       const void *defaults) {
  if (is_any_given(section, key->excludes, self, defaults)) return false;
  if (key->required || is_given(key, self, defaults)) return true;
  if (key->mark.size > 0) return false;
  bool has_default = key->type == SCENE_SECTION ? is_empty_allowed(key->section) : key->fallback != NULL;
  return has_default && are_all_given(section, key->needs, self, defaults);
}

// Values.

static void write_counts(const int counts[3], Record *record, const char *name) {
  RecordList *list = record_list(record, name);
  for (int c = 0; c < 3; c++) record_append_number(list, counts[c]);
}

static void write_two(char *const names[2], Record *record, const char *name) {
  RecordList *list = record_list(record, name);
  for (int k = 0; k < 2; k++) record_append_text(list, names[k]);
}

static void write_axes(const bool axes[3], Record *record, const char *name) {
  static const char *const names[] = {"x", "y", "z"};
  RecordList *list = record_list(record, name);
  for (int c = 0; c < 3; c++)
    if (axes[c]) record_append_text(list, names[c]);
}

static Status write_keys(const SceneSection *section, const void *self, const void *defaults,
                         Record *record) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    if (!is_written(section, key, self, defaults)) continue;
    if (key->type == SCENE_SECTION)
      TRY(write_keys(key->section, field_of(self, key->offset), field_of(defaults, key->offset),
                     record_child(record, key->name)));
    else
      TRY(app_scene_write_value(key, self, record, key->name));
  }
  return STATUS_OK;
}

static Status write_list(const SceneKey *key, const void *self, Record *record, const char *name) {
  const SceneSection *section = key->section;
  const char *items = *(char *const *)field_of(self, key->offset);
  RecordList *list = record_list(record, name);
  void *defaults;
  TRY(app_scene_read_create_defaults(section, &defaults));
  Status status = STATUS_OK;
  for (int i = 0; i < count_of(key, self) && !status; i++)
    status = write_keys(section, items + (size_t)i * section->size, defaults, record_append(list));
  app_scene_read_destroy_defaults(section, defaults);
  return status;
}

Status app_scene_write_value(const SceneKey *key, const void *self, Record *record, const char *name) {
  const void *field = field_of(self, key->offset);
  switch (key->type) {
  case SCENE_NUMBER:
    record_number(record, name, *(const double *)field);
    break;
  case SCENE_INTEGER:
    record_integer(record, name, *(const int *)field);
    break;
  case SCENE_SWITCH:
    record_bool(record, name, *(const bool *)field);
    break;
  case SCENE_TRUE:
    record_bool(record, name, true);
    break;
  case SCENE_TEXT:
  case SCENE_LABEL:
  case SCENE_NAME:
    record_text(record, name, text_of(key, self));
    break;
  case SCENE_CHOICE:
    record_text(record, name, app_scene_section_name(key->choices, choice_at(field, key->size)));
    break;
  case SCENE_VECTOR:
  case SCENE_DIRECTION:
  case SCENE_FACTORS:
    record_numbers(record, name, field, 3);
    break;
  case SCENE_COUNTS:
    write_counts(field, record, name);
    break;
  case SCENE_TWO:
    write_two(field, record, name);
    break;
  case SCENE_AXES:
    write_axes(field, record, name);
    break;
  case SCENE_ROWS:
  case SCENE_PROFILE:
    record_numbers(record, name, *(double *const *)field,
                   app_scene_keys_row_width(key) * count_of(key, self));
    break;
  case SCENE_FORMULA:
    record_text(record, name, (*(Expression *const *)field)->text);
    break;
  case SCENE_SECTION:
    return write_keys(key->section, field, field, record_child(record, name));
  case SCENE_LIST:
    return write_list(key, self, record, name);
  }
  return STATUS_OK;
}

Status app_scene_write_resolved(const FemSceneDef *scene, Record *parent) {
  void *defaults;
  TRY(app_scene_read_create_defaults(&app_scene_keys_root, &defaults));
  Status status = write_keys(&app_scene_keys_root, scene, defaults, record_child(parent, "scene"));
  app_scene_read_destroy_defaults(&app_scene_keys_root, defaults);
  return status;
}

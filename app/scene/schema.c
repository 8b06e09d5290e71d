// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/schema.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/scene/keys/keys.h"
#include "app/scene/read.h"
#include "app/scene/write.h"
#include "base/memory.h"

enum { TEXT_SIZE = 4096 };

// The help, with what else a person would ask: unit, choices, what holds without the key.
static void describe(const SceneKey *key, Record *record) {
  char text[TEXT_SIZE];
  size_t used = 0;
  text_append(text, sizeof text, &used, "%s", key->help);
  if (key->unit) text_append(text, sizeof text, &used, " [%s]", key->unit);
  const char *name;
  for (int i = 0; key->choices && (name = app_scene_section_name(key->choices, i)); i++)
    text_append(text, sizeof text, &used, "%s%s: %s", i ? "; " : ". ", name,
                app_scene_section_help(key->choices, i));
  if (key->absent_help) text_append(text, sizeof text, &used, ". Without it: %s", key->absent_help);
  record_text(record, "description", text);
}

static void put_type(Record *record, const char *type, bool is_nullable) {
  if (!is_nullable) {
    record_text(record, "type", type);
    return;
  }
  RecordList *types = record_list(record, "type");
  record_append_text(types, type);
  record_append_text(types, "null");
}

static void put_range(const SceneKey *key, Record *record) {
  SceneRange range = app_scene_keys_range(key);
  if (isfinite(range.min))
    record_number(record, range.is_min_open ? "exclusiveMinimum" : "minimum", range.min);
  if (isfinite(range.max))
    record_number(record, range.is_max_open ? "exclusiveMaximum" : "maximum", range.max);
}

static void put_number(const SceneKey *key, const char *type, bool is_nullable, Record *record) {
  put_type(record, type, is_nullable);
  put_range(key, record);
}

static void put_array(const SceneKey *key, const char *type, int count, bool is_nullable, Record *record) {
  put_type(record, "array", is_nullable);
  put_number(key, type, false, record_child(record, "items"));
  record_integer(record, "minItems", count);
  record_integer(record, "maxItems", count);
}

// A number or three of them.
static void put_broadcast(const SceneKey *key, const char *type, bool is_nullable, Record *record) {
  RecordList *any = record_list(record, "anyOf");
  put_number(key, type, is_nullable, record_append(any));
  put_array(key, type, 3, false, record_append(any));
}

static void put_names(RecordList *list, const SceneChoices *choices) {
  const char *name;
  for (int i = 0; (name = app_scene_section_name(choices, i)); i++) record_append_text(list, name);
}

static void put_choices(const SceneChoices *choices, Record *record) {
  if (!choices->takes_switch && !choices->accepts) {
    put_names(record_list(record, "enum"), choices);
    return;
  }
  RecordList *any = record_list(record, "anyOf");
  put_names(record_list(record_append(any), "enum"), choices);
  put_type(record_append(any), choices->accepts ? "string" : "boolean", false);
}

static void put_two(bool is_nullable, Record *record) {
  put_type(record, "array", is_nullable);
  put_type(record_child(record, "items"), "string", false);
  record_integer(record, "minItems", 2);
  record_integer(record, "maxItems", 2);
}

static void put_axes(bool is_nullable, Record *record) {
  put_type(record, "array", is_nullable);
  RecordList *axes = record_list(record_child(record, "items"), "enum");
  for (const char *axis = "xyz"; *axis; axis++) record_append_text(axes, (char[2]){*axis, 0});
  record_integer(record, "minItems", 1);
  record_bool(record, "uniqueItems", true);
}

// A formula, or a number.
static void put_formula(bool is_nullable, Record *record) {
  RecordList *any = record_list(record, "anyOf");
  put_type(record_append(any), "string", is_nullable);
  put_type(record_append(any), "number", false);
}

static void put_rows(const SceneKey *key, bool is_nullable, Record *record) {
  RecordList *any = record_list(record, "anyOf");
  Record *rows = record_append(any), *flat = record_append(any);
  put_type(rows, "array", is_nullable);
  int width = app_scene_keys_row_width(key);
  put_array(key, "number", width, false, record_child(rows, "items"));
  record_integer(rows, "minItems", 1);
  put_type(flat, "array", false);
  put_type(record_child(flat, "items"), "number", false);
  record_integer(flat, "minItems", width);
}

// Sections.

static Status put_section(const SceneSection *section, const void *defaults, bool is_nullable,
                          Record *record);

// {"required": [word, …]} of up to two words.
static void put_required(Record *record, const char *first, const char *second) {
  RecordList *list = record_list(record, "required");
  record_append_text(list, first);
  if (second) record_append_text(list, second);
}

static void put_alternatives(const char *name, const char *words, Record *record) {
  if (!words) return;
  RecordList *list = record_list(record, name);
  char word[TEXT_MAX_WORD];
  for (const char *rest = text_next(words, word); rest; rest = text_next(rest, word))
    put_required(record_append(list), word, NULL);
}

static void put_rules(const SceneSection *section, Record *record) {
  char word[TEXT_MAX_WORD];
  const SceneKey *key;
  RecordList *required = record_list(record, "required"), *all = record_list(record, "allOf");
  Record *needs = record_child(record, "dependencies");
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    if (key->required) record_append_text(required, key->name);
    RecordList *needed = key->needs ? record_list(needs, key->name) : NULL;
    for (const char *rest = text_next(key->needs, word); rest; rest = text_next(rest, word))
      record_append_text(needed, word);
    for (const char *rest = text_next(key->excludes, word); rest; rest = text_next(rest, word))
      put_required(record_child(record_append(all), "not"), key->name, word);
  }
  put_alternatives("oneOf", section->one_of, record);
  put_alternatives("anyOf", section->some_of, record);
  // Draft 7 wants allOf to have an item; one that always holds does no harm.
  record_append(all);
}

static Status put_subsection(const SceneKey *key, const void *defaults, bool is_nullable, Record *record) {
  const void *below = (const char *)defaults + key->offset;
  if (!key->section->shorthand) return put_section(key->section, below, is_nullable, record);
  const SceneKey *meant = app_scene_keys_find(key->section, key->section->shorthand);
  RecordList *any = record_list(record, "anyOf");
  if (meant->type == SCENE_NUMBER)
    put_number(meant, "number", is_nullable, record_append(any));
  else
    put_type(record_append(any), "string", is_nullable);
  return put_section(key->section, below, false, record_append(any));
}

static Status put_list(const SceneKey *key, bool is_nullable, Record *record) {
  put_type(record, "array", is_nullable);
  if (key->required) record_integer(record, "minItems", 1);
  void *defaults;
  TRY(app_scene_read_create_defaults(key->section, &defaults));
  Status status = put_section(key->section, defaults, false, record_child(record, "items"));
  app_scene_read_destroy_defaults(key->section, defaults);
  return status;
}

// `defaults` is the struct of the key's section, filled with defaults.
static Status put_key(const SceneKey *key, const void *defaults, Record *record) {
  bool is_nullable = !key->required && key->mark.size == 0;
  describe(key, record);
  if (key->fallback) TRY(app_scene_write_value(key, defaults, record, "default"));
  switch (key->type) {
  case SCENE_NUMBER:
    put_number(key, "number", is_nullable, record);
    break;
  case SCENE_INTEGER:
    put_number(key, "integer", is_nullable, record);
    break;
  case SCENE_SWITCH:
    put_type(record, "boolean", is_nullable);
    break;
  case SCENE_TRUE:
    record_bool(record, "const", true);
    break;
  case SCENE_TEXT:
    put_type(record, "string", is_nullable);
    break;
  case SCENE_LABEL:
    put_type(record, "string", is_nullable);
    record_text(record, "pattern", "^[A-Za-z0-9_-]+$");
    break;
  case SCENE_NAME:
  case SCENE_CHOICE:
    put_choices(key->choices, record);
    break;
  case SCENE_VECTOR:
  case SCENE_DIRECTION:
    put_array(key, "number", 3, is_nullable, record);
    break;
  case SCENE_FACTORS:
    put_broadcast(key, "number", is_nullable, record);
    break;
  case SCENE_COUNTS:
    put_broadcast(key, "integer", is_nullable, record);
    break;
  case SCENE_TWO:
    put_two(is_nullable, record);
    break;
  case SCENE_AXES:
    put_axes(is_nullable, record);
    break;
  case SCENE_ROWS:
  case SCENE_PROFILE:
    put_rows(key, is_nullable, record);
    break;
  case SCENE_FORMULA:
    put_formula(is_nullable, record);
    break;
  case SCENE_SECTION:
    return put_subsection(key, defaults, is_nullable, record);
  case SCENE_LIST:
    return put_list(key, is_nullable, record);
  }
  return STATUS_OK;
}

static Status put_section(const SceneSection *section, const void *defaults, bool is_nullable,
                          Record *record) {
  put_type(record, "object", is_nullable);
  record_bool(record, "additionalProperties", false);
  Record *properties = record_child(record, "properties");
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++)
    TRY(put_key(key, defaults, record_child(properties, key->name)));
  put_rules(section, record);
  return STATUS_OK;
}

Status app_scene_schema_record(Record *schema) {
  record_text(schema, "$schema", "http://json-schema.org/draft-07/schema#");
  record_text(schema, "title", "A scene of tetlap");
  void *defaults;
  TRY(app_scene_read_create_defaults(&app_scene_keys_root, &defaults));
  Status status = put_section(&app_scene_keys_root, defaults, false, schema);
  app_scene_read_destroy_defaults(&app_scene_keys_root, defaults);
  return status;
}

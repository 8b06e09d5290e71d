// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/record.h"

#include <jansson.h>
#include <math.h>

#include "base/file.h"
#include "base/memory.h"

// jansson owns the tree; our handles are its nodes under another name.
static json_t *node_of(Record *record) {
  return (json_t *)record;
}

// jansson refuses NaN and infinity by returning NULL; null stands for them.
static json_t *number_or_null(double value) {
  return isfinite(value) ? json_real(value) : json_null();
}

Record *record_new(void) {
  return (Record *)json_object();
}

void record_destroy(Record *root) {
  json_decref(node_of(root));
}

void record_number(Record *record, const char *key, double value) {
  json_object_set_new(node_of(record), key, number_or_null(value));
}

void record_integer(Record *record, const char *key, long long value) {
  json_object_set_new(node_of(record), key, json_integer(value));
}

void record_text(Record *record, const char *key, const char *value) {
  json_object_set_new(node_of(record), key, value ? json_string(value) : json_null());
}

void record_bool(Record *record, const char *key, bool value) {
  json_object_set_new(node_of(record), key, json_boolean(value));
}

void record_numbers(Record *record, const char *key, const double *values, int count) {
  RecordList *list = record_list(record, key);
  for (int i = 0; i < count; i++) record_append_number(list, values[i]);
}

void record_merge(Record *record, const Record *other) {
  json_object_update(node_of(record), (json_t *)other);
}

Record *record_child(Record *record, const char *key) {
  json_t *child = json_object();
  return json_object_set_new(node_of(record), key, child) == 0 ? (Record *)child : NULL;
}

RecordList *record_list(Record *record, const char *key) {
  json_t *child = json_array();
  return json_object_set_new(node_of(record), key, child) == 0 ? (RecordList *)child : NULL;
}

Record *record_append(RecordList *list) {
  json_t *child = json_object();
  return json_array_append_new((json_t *)list, child) == 0 ? (Record *)child : NULL;
}

void record_append_number(RecordList *list, double value) {
  json_array_append_new((json_t *)list, number_or_null(value));
}

void record_append_text(RecordList *list, const char *value) {
  json_array_append_new((json_t *)list, json_string(value));
}

RecordList *record_list_new(void) {
  return (RecordList *)json_array();
}

void record_list_destroy(RecordList *root) {
  json_decref((json_t *)root);
}

static Status print_tree(const json_t *root, FILE *stream) {
  if (json_dumpf(root, stream, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) != 0 || fputc('\n', stream) == EOF)
    return status_fail(STATUS_IO, "writing JSON failed");
  return STATUS_OK;
}

static Status write_tree(const json_t *root, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  Status status = print_tree(root, writer.stream);
  if (status) {
    file_abandon(&writer);
    return status_prefix(status, "%s", path);
  }
  return file_commit(&writer);
}

static Status print(const Record *root, FILE *stream, size_t flags) {
  if (json_dumpf((const json_t *)root, stream, flags | JSON_REAL_PRECISION(17)) != 0)
    return status_fail(STATUS_IO, "writing JSON failed");
  return fputc('\n', stream) == EOF ? status_fail(STATUS_IO, "writing JSON failed") : STATUS_OK;
}

Status record_print(const Record *root, FILE *stream) {
  return print(root, stream, JSON_INDENT(2));
}

Status record_print_line(const Record *root, FILE *stream) {
  return print(root, stream, JSON_COMPACT);
}

Status record_write(const Record *root, const char *path) {
  return write_tree((const json_t *)root, path);
}

Status record_list_print(const RecordList *root, FILE *stream) {
  return print_tree((const json_t *)root, stream);
}

Status record_list_write(const RecordList *root, const char *path) {
  return write_tree((const json_t *)root, path);
}

Status record_read(Record **root, const char *path) {
  char *text;
  size_t size;
  json_error_t error;
  *root = NULL;
  TRY(file_read(path, &text, &size));
  json_t *tree = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
  memory_free(text);
  if (!tree)
    return status_fail(STATUS_INPUT, "%s:%d:%d: is not JSON: %s", path, error.line, error.column, error.text);
  *root = (Record *)tree;
  return STATUS_OK;
}

void record_adopt(Record *record, const char *key, Record *child) {
  if (child) json_object_set_new(node_of(record), key, node_of(child));
}

const Record *record_find(const Record *record, const char *key) {
  return (const Record *)json_object_get((const json_t *)record, key);
}

const Record *record_at(const Record *list, int index) {
  return index < 0 ? NULL : (const Record *)json_array_get((const json_t *)list, (size_t)index);
}

int record_count(const Record *list) {
  return (int)json_array_size((const json_t *)list);
}

const char *record_find_text(const Record *record, const char *key) {
  return json_string_value((const json_t *)record_find(record, key));
}

double record_find_number(const Record *record, const char *key) {
  const json_t *value = (const json_t *)record_find(record, key);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

bool record_find_bool(const Record *record, const char *key) {
  return json_is_true((const json_t *)record_find(record, key));
}

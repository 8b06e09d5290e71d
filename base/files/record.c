// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/files/record.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/text.h"

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

void record_whole(Record *record, const char *key, double value) {
  bool is_whole = value >= -0x1p62 && value <= 0x1p62;
  json_object_set_new(node_of(record), key, is_whole ? json_integer(llround(value)) : json_null());
}

void record_add(Record *record, const char *key, long long value) {
  record_integer(record, key, json_integer_value(json_object_get(node_of(record), key)) + value);
}

void record_value(Record *record, const char *key, const Record *value) {
  json_object_set_new(node_of(record), key, value ? json_deep_copy((const json_t *)value) : json_null());
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

void record_append_integer(RecordList *list, long long value) {
  json_array_append_new((json_t *)list, json_integer(value));
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

// jansson fails for want of memory, or because the stream takes no more.
static Status print(const void *root, FILE *stream, size_t flags) {
  errno = 0;
  if (json_dumpf(root, stream, flags | JSON_REAL_PRECISION(17)) == 0 && fputc('\n', stream) != EOF)
    return STATUS_OK;
  if (!ferror(stream)) return status_no_memory("JSON");
  return status_fail(STATUS_IO, "writing JSON failed: %s", errno ? strerror(errno) : "write error");
}

static Status print_tree(const json_t *root, FILE *stream) {
  return print(root, stream, JSON_INDENT(2));
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

Status record_parse(Record **root, const char *text, size_t size, const char *name) {
  json_error_t error;
  size_t mark = text_mark_length(text, size);
  *root = (Record *)json_loadb(text + mark, size - mark, JSON_REJECT_DUPLICATES, &error);
  if (*root) return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s:%d:%d: is not JSON: %s", name, error.line, error.column, error.text);
}

Status record_read(Record **root, const char *path) {
  char *text;
  size_t size;
  *root = NULL;
  TRY(file_read(path, &text, &size));
  Status status = record_parse(root, text, size, path);
  memory_free(text);
  return status;
}

Status record_read_in(Record **root, const char *directory, const char *name) {
  char *path = file_join(directory, name);
  *root = NULL;
  if (!path) return status_no_memory("a file name");
  Status status = file_exists(path) ? record_read(root, path) : STATUS_OK;
  memory_free(path);
  return status;
}

char *record_text_of(const Record *root) {
  char *dumped = json_dumps((const json_t *)root, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
  char *text = dumped ? memory_copy(dumped, strlen(dumped) + 1, 1) : NULL;
  free(dumped);
  return text;
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

const char *record_text_value(const Record *text) {
  return json_string_value((const json_t *)text);
}

const char *record_find_text(const Record *record, const char *key) {
  return json_string_value((const json_t *)record_find(record, key));
}

double record_number_value(const Record *number) {
  const json_t *value = (const json_t *)number;
  return json_is_number(value) ? json_number_value(value) : NAN;
}

double record_find_number(const Record *record, const char *key) {
  return record_number_value(record_find(record, key));
}

static void print_value(const json_t *value, char text[RECORD_VALUE]) {
  char *dumped = value ? json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(17)) : NULL;
  snprintf(text, RECORD_VALUE, "%s", dumped ? dumped : "nothing");
  free(dumped);
}

static bool differ(const json_t *a, const json_t *b, size_t used, RecordDifference *difference);

static bool objects_differ(json_t *a, json_t *b, size_t used, RecordDifference *difference) {
  const char *key;
  json_t *value;
  json_object_foreach(a, key, value) {
    size_t end = used;
    text_append(difference->place, RECORD_PLACE, &end, "%s%s", used ? "." : "", key);
    if (differ(value, json_object_get(b, key), end, difference)) return true;
  }
  json_object_foreach(b, key, value) {
    size_t end = used;
    text_append(difference->place, RECORD_PLACE, &end, "%s%s", used ? "." : "", key);
    if (!json_object_get(a, key) && differ(NULL, value, end, difference)) return true;
  }
  return false;
}

static bool lists_differ(json_t *a, json_t *b, size_t used, RecordDifference *difference) {
  size_t most = json_array_size(a) > json_array_size(b) ? json_array_size(a) : json_array_size(b);
  for (size_t i = 0; i < most; i++) {
    size_t end = used;
    text_append(difference->place, RECORD_PLACE, &end, "[%zu]", i);
    if (differ(json_array_get(a, i), json_array_get(b, i), end, difference)) return true;
  }
  return false;
}

// `used`: how much of the place is the way to a and b.
static bool differ(const json_t *a, const json_t *b, size_t used, RecordDifference *difference) {
  if (json_is_object(a) && json_is_object(b))
    return objects_differ((json_t *)a, (json_t *)b, used, difference);
  if (json_is_array(a) && json_is_array(b)) return lists_differ((json_t *)a, (json_t *)b, used, difference);
  print_value(a, difference->a);
  print_value(b, difference->b);
  return a && b ? !json_equal(a, b) : a != b;
}

bool record_differ(const Record *a, const Record *b, RecordDifference *difference) {
  *difference = (RecordDifference){{0}, {0}, {0}};
  return differ((const json_t *)a, (const json_t *)b, 0, difference);
}

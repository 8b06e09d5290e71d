// SPDX-License-Identifier: Apache-2.0
#include "net/json.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include "net/memory.h"

// A NetJson is a json_t by another name: the cast is the whole of the wrapping.
static json_t *inner(const NetJson *value) {
  return (json_t *)(uintptr_t)value;
}
static NetJson *outer(json_t *value) {
  return (NetJson *)value;
}

NetJson *net_json_parse(const char *text, size_t length, char error[160]) {
  json_error_t where;
  json_t *root = json_loadb(text, length, JSON_REJECT_DUPLICATES, &where);
  if (!root) {
    snprintf(error, 160, "%.120s (line %d, column %d)", where.text, where.line, where.column);
    return NULL;
  }
  if (json_is_object(root)) return outer(root);
  snprintf(error, 160, "not a JSON object");
  json_decref(root);
  return NULL;
}

NetJson *net_json_object(void) {
  return outer(json_object());
}

void net_json_destroy(NetJson *value) {
  json_decref(inner(value));
}

int net_json_count(const NetJson *value) {
  json_t *json = inner(value);
  return (int)(json_is_array(json) ? json_array_size(json) : json_object_size(json));
}

const NetJson *net_json_member(const NetJson *object, const char *key) {
  return outer(json_object_get(inner(object), key));
}

const NetJson *net_json_element(const NetJson *array, int index) {
  return index < 0 ? NULL : outer(json_array_get(inner(array), (size_t)index));
}

const char *net_json_text(const NetJson *value) {
  return json_string_value(inner(value));
}

bool net_json_is_object(const NetJson *value) {
  return json_is_object(inner(value));
}

bool net_json_is_array(const NetJson *value) {
  return json_is_array(inner(value));
}

bool net_json_integer(const NetJson *value, int64_t *integer) {
  if (!json_is_integer(inner(value))) return false;
  *integer = json_integer_value(inner(value));
  return true;
}

bool net_json_bool(const NetJson *value, bool *boolean) {
  if (!json_is_boolean(inner(value))) return false;
  *boolean = json_is_true(inner(value));
  return true;
}

bool net_json_next(const NetJson *object, void **cursor, const char **key, const NetJson **value) {
  json_t *json = inner(object);
  *cursor = *cursor ? json_object_iter_next(json, *cursor) : json_object_iter(json);
  if (!*cursor) return false;
  *key = json_object_iter_key(*cursor);
  *value = outer(json_object_iter_value(*cursor));
  return true;
}

bool net_json_set_text(NetJson *object, const char *key, const char *text) {
  return json_object_set_new(inner(object), key, json_string(text)) == 0;
}

bool net_json_set_bool(NetJson *object, const char *key, bool boolean) {
  return json_object_set_new(inner(object), key, json_boolean(boolean)) == 0;
}

bool net_json_set_integer(NetJson *object, const char *key, int64_t integer) {
  return json_object_set_new(inner(object), key, json_integer(integer)) == 0;
}

bool net_json_set_integers(NetJson *object, const char *key, int count, const int64_t integers[]) {
  json_t *array = json_array();
  bool ok = array;
  for (int k = 0; ok && k < count; k++) ok = json_array_append_new(array, json_integer(integers[k])) == 0;
  return json_object_set_new(inner(object), key, array) == 0 && ok;
}

bool net_json_set_object(NetJson *object, const char *key, NetJson *child) {
  return json_object_set_new(inner(object), key, inner(child)) == 0;
}

char *net_json_print(const NetJson *object) {
  char *printed = json_dumps(inner(object), JSON_COMPACT);
  if (!printed) return NULL;
  char *text = net_memory_text(printed);
  free(printed);
  return text;
}

// SPDX-License-Identifier: Apache-2.0
#include "overlap/source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "overlap/weights.h"

static const char COMMAND[] = "exec:", CHANNEL[] = "channel:";

static bool ends_in(const char *word, size_t length, const char *ending) {
  size_t size = strlen(ending);
  return length > size && memcmp(word + length - size, ending, size) == 0;
}

// The length of the path of what Python runs in `path`, or in `path:name`; 0: it is none.
static size_t python_path(const char *word) {
  if (ends_in(word, strlen(word), ".onnx")) return strlen(word);
  const char *colon = strrchr(word, ':');
  if (colon && strchr(colon, '/')) colon = NULL; // a colon in a folder's name
  size_t length = colon ? (size_t)(colon - word) : strlen(word);
  return ends_in(word, length, ".py") ? length : 0;
}

static bool begins_with(const char *word, const char *text) {
  return strncmp(word, text, strlen(text)) == 0;
}

const char *overlap_source_inner(const char *word) {
  size_t length = strspn(word, "abcdefghijklmnopqrstuvwxyz0123456789-");
  const char *end = word + length;
  if (length == 0 || begins_with(word, COMMAND) || begins_with(word, CHANNEL)) return NULL;
  if (*end == ':') end += strcspn(end, "=/"); // the number is read where its wrapper is known
  return *end == '=' ? end + 1 : NULL;
}

const char *overlap_source_model(const char *word) {
  for (const char *inner; (inner = overlap_source_inner(word));) word = inner;
  return word;
}

OverlapSource overlap_source_of(const char *word) {
  word = overlap_source_model(word);
  if (begins_with(word, COMMAND)) return OVERLAP_SOURCE_COMMAND;
  if (begins_with(word, CHANNEL)) return OVERLAP_SOURCE_CHANNEL;
  size_t length = strlen(word);
  if (ends_in(word, length, ".so")) return OVERLAP_SOURCE_LIBRARY;
  if (python_path(word) > 0) return OVERLAP_SOURCE_PYTHON;
  return overlap_weights_is_path(word) ? OVERLAP_SOURCE_WEIGHTS : OVERLAP_SOURCE_NAME;
}

size_t overlap_source_path(const char *word, const char **path) {
  *path = overlap_source_model(word);
  switch (overlap_source_of(*path)) {
  case OVERLAP_SOURCE_WEIGHTS:
  case OVERLAP_SOURCE_LIBRARY:
    return strlen(*path);
  case OVERLAP_SOURCE_PYTHON:
    return python_path(*path);
  case OVERLAP_SOURCE_NAME:
  case OVERLAP_SOURCE_COMMAND:
  case OVERLAP_SOURCE_CHANNEL:
    break;
  }
  return 0;
}

bool overlap_source_with_path(const char *word, const char *path, char *text, size_t size) {
  const char *own;
  size_t length = overlap_source_path(word, &own);
  return snprintf(text, size, "%.*s%s%s", (int)(own - word), word, path, own + length) < (int)size;
}

bool overlap_source_from(const char *word, const char *folder, char *text, size_t size) {
  const char *path;
  if (overlap_source_path(word, &path) == 0 || path[0] == '/')
    return snprintf(text, size, "%s", word) < (int)size;
  const char *here = overlap_source_inner(folder) ? "./" : ""; // a folder `e=1` is no word before a model
  return snprintf(text, size, "%.*s%s%s/%s", (int)(path - word), word, here, folder, path) < (int)size;
}

bool overlap_source_has_form(const char *word) {
  return overlap_source_of(word) != OVERLAP_SOURCE_NAME || overlap_source_inner(word) != NULL;
}

bool overlap_source_is_foreign(const char *word) {
  OverlapSource source = overlap_source_of(word);
  return source != OVERLAP_SOURCE_NAME && source != OVERLAP_SOURCE_WEIGHTS;
}

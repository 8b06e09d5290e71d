// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/tree.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/text.h"

// Messages.

static Status fail_at(const char *origin, int line, int column, const char *format, va_list args) {
  char message[1024];
  vsnprintf(message, sizeof message, format, args);
  if (line == 0) return status_fail(STATUS_USAGE, "--set %s: %s", origin, message);
  return status_fail(STATUS_INPUT, "%s:%d:%d: %s", origin, line, column, message);
}

Status app_scene_tree_fail(const SceneNode *node, const char *format, ...) {
  va_list args;
  va_start(args, format);
  Status status = fail_at(node->origin, node->line, node->column, format, args);
  va_end(args);
  return status;
}

Status app_scene_tree_fail_key(const SceneNode *node, const char *format, ...) {
  va_list args;
  va_start(args, format);
  Status status = fail_at(node->origin, node->key_line, node->key_column, format, args);
  va_end(args);
  return status;
}

static int index_of(const SceneNode *node) {
  int index = 0;
  for (const SceneNode *child = node->parent->first; child != node; child = child->next) index++;
  return index;
}

static void append_path(const SceneNode *node, char *path, size_t size, size_t *used) {
  if (!node->parent) return;
  append_path(node->parent, path, size, used);
  if (node->key)
    text_append(path, size, used, "%s%s", *used ? "." : "", node->key);
  else
    text_append(path, size, used, "[%d]", index_of(node));
}

void app_scene_tree_path(const SceneNode *node, char *path, size_t size) {
  size_t used = 0;
  append_path(node, path, size, &used);
  if (node->parent) return;
  snprintf(path, size, "%s", node->key ? node->key : "the scene");
}

void app_scene_tree_describe(const SceneNode *node, char *text, size_t size) {
  switch (node->kind) {
  case SCENE_NODE_NULL:
    snprintf(text, size, "nothing");
    break;
  case SCENE_NODE_SWITCH:
    snprintf(text, size, "%s", node->text);
    break;
  case SCENE_NODE_NUMBER:
    snprintf(text, size, "the number %.40s", node->text);
    break;
  case SCENE_NODE_TEXT:
    snprintf(text, size, "the text '%.60s'", node->text);
    break;
  case SCENE_NODE_LIST:
    snprintf(text, size, "a list of %d", node->count);
    break;
  case SCENE_NODE_MAP:
    snprintf(text, size, "a mapping {key: value}");
    break;
  }
}

// The tree.

SceneNode *app_scene_tree_find(const SceneNode *node, const char *key) {
  for (SceneNode *child = node->kind == SCENE_NODE_MAP ? node->first : NULL; child; child = child->next)
    if (strcmp(child->key, key) == 0) return child;
  return NULL;
}

SceneNode *app_scene_tree_at(const SceneNode *node, int index) {
  SceneNode *child = node->first;
  while (child && index-- > 0) child = child->next;
  return index < 0 ? child : NULL;
}

// Destroys what hangs below a node and below its later siblings; depth is limited by the parser.
static void destroy_chain(SceneNode *node) {
  while (node) {
    SceneNode *next = node->next;
    destroy_chain(node->first);
    memory_free(node->key);
    memory_free(node->text);
    memory_free(node);
    node = next;
  }
}

void app_scene_tree_destroy(SceneNode *root) {
  destroy_chain(root);
}

static void attach(SceneNode *parent, SceneNode *child) {
  child->parent = parent;
  if (parent->last)
    parent->last->next = child;
  else
    parent->first = child;
  parent->last = child;
  parent->count++;
}

SceneNode *app_scene_tree_add(SceneNode *parent, const char *key) {
  SceneNode *child = memory_zeroed(1, sizeof *child);
  char *copy = key ? memory_copy(key, strlen(key) + 1, 1) : NULL;
  if (!child || (key && !copy)) {
    memory_free(child);
    memory_free(copy);
    return NULL;
  }
  *child = (SceneNode){
      .kind = SCENE_NODE_NULL, .origin = parent->origin, .line = parent->line, .column = parent->column};
  child->key = copy;
  attach(parent, child);
  return child;
}

void app_scene_tree_replace(SceneNode *node, SceneNode *source) {
  destroy_chain(node->first);
  memory_free(node->text);
  SceneNode value = *source;
  value.key = node->key, value.key_line = source->line, value.key_column = source->column;
  value.parent = node->parent, value.next = node->next;
  *node = value;
  for (SceneNode *child = node->first; child; child = child->next) child->parent = node;
  memory_free(source);
}

void app_scene_tree_mark_override(SceneNode *root) {
  for (SceneNode *node = root; node; node = node->next) {
    node->line = node->key_line = 0;
    app_scene_tree_mark_override(node->first);
  }
}

// Scalars.

// [+-] digits [. digits] [e [+-] digits] with a digit before the exponent: YAML 1.2 and JSON, and `1e6`.
static bool is_number(const char *text) {
  const char *at = text + (text[0] == '+' || text[0] == '-');
  size_t whole = strspn(at, "0123456789"), fraction = 0;
  at += whole;
  if (at[0] == '.') {
    fraction = strspn(at + 1, "0123456789");
    at += 1 + fraction;
  }
  if (whole + fraction == 0) return false;
  if (at[0] == 'e' || at[0] == 'E') {
    at += 1 + (at[1] == '+' || at[1] == '-');
    size_t exponent = strspn(at, "0123456789");
    if (exponent == 0) return false;
    at += exponent;
  }
  return at[0] == 0;
}

static bool is_infinity(const char *text) {
  const char *at = text + (text[0] == '+' || text[0] == '-');
  return text_lists(".inf .Inf .INF", at);
}

static void resolve_plain(SceneNode *node) {
  const char *text = node->text;
  if (text[0] == 0 || text_lists("~ null Null NULL", text)) {
    node->kind = SCENE_NODE_NULL;
  } else if (text_lists("true True TRUE false False FALSE", text)) {
    node->kind = SCENE_NODE_SWITCH;
    node->is_true = text[0] == 't' || text[0] == 'T';
  } else if (is_number(text)) {
    node->kind = SCENE_NODE_NUMBER;
    node->number = strtod(text, NULL);
  } else if (is_infinity(text)) {
    node->kind = SCENE_NODE_NUMBER;
    node->number = text[0] == '-' ? -INFINITY : INFINITY;
  } else if (text_lists(".nan .NaN .NAN", text)) {
    node->kind = SCENE_NODE_NUMBER;
    node->number = NAN;
  }
}

// The parser: libyaml's events, one after another, become nodes.

typedef struct Parser {
  yaml_parser_t yaml;
  const char *origin, *text;
  size_t size;
  int depth, node_count;
} Parser;

static Status fail_mark(const Parser *parser, yaml_mark_t mark, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static Status fail_mark(const Parser *parser, yaml_mark_t mark, const char *format, ...) {
  va_list args;
  va_start(args, format);
  Status status = fail_at(parser->origin, (int)mark.line + 1, (int)mark.column + 1, format, args);
  va_end(args);
  return status;
}

static Status fail_offset(const Parser *parser, size_t offset, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static Status fail_offset(const Parser *parser, size_t offset, const char *format, ...) {
  int line, column;
  text_place(parser->text, offset, &line, &column);
  va_list args;
  va_start(args, format);
  Status status = fail_at(parser->origin, line, column, format, args);
  va_end(args);
  return status;
}

// What libyaml found wrong, with the cause that people meet most often put plainly.
static Status fail_syntax(const Parser *parser) {
  const yaml_parser_t *yaml = &parser->yaml;
  if (yaml->error == YAML_MEMORY_ERROR) return status_no_memory("the scene file");
  if (yaml->error == YAML_READER_ERROR)
    return fail_offset(parser, yaml->problem_offset, "%s; a scene is plain UTF-8 text", yaml->problem);
  yaml_mark_t mark = yaml->problem_mark;
  if (mark.index < parser->size && parser->text[mark.index] == '\t')
    return fail_mark(parser, mark, "a tab; YAML is indented with spaces");
  if (yaml->context)
    return fail_mark(parser, mark, "not valid YAML: %s (%s, line %d); check indentation, brackets and quotes",
                     yaml->problem, yaml->context, (int)yaml->context_mark.line + 1);
  return fail_mark(parser, mark, "not valid YAML: %s; check indentation, brackets and quotes", yaml->problem);
}

static Status next_event(Parser *parser, yaml_event_t *event) {
  return yaml_parser_parse(&parser->yaml, event) ? STATUS_OK : fail_syntax(parser);
}

static Status refuse_features(const Parser *parser, const yaml_event_t *event) {
  const yaml_char_t *anchor = NULL, *tag = NULL;
  switch (event->type) {
  case YAML_ALIAS_EVENT:
    return fail_mark(parser, event->start_mark,
                     "the alias '*%s'; aliases are not supported: write the value out",
                     (const char *)event->data.alias.anchor);
  case YAML_SCALAR_EVENT:
    anchor = event->data.scalar.anchor, tag = event->data.scalar.tag;
    break;
  case YAML_SEQUENCE_START_EVENT:
    anchor = event->data.sequence_start.anchor, tag = event->data.sequence_start.tag;
    break;
  case YAML_MAPPING_START_EVENT:
    anchor = event->data.mapping_start.anchor, tag = event->data.mapping_start.tag;
    break;
  default:
    break;
  }
  if (anchor)
    return fail_mark(parser, event->start_mark, "the anchor '&%s'; anchors are not supported: remove it",
                     (const char *)anchor);
  if (tag)
    return fail_mark(parser, event->start_mark, "the tag '%s'; tags are not supported: remove it",
                     (const char *)tag);
  return STATUS_OK;
}

static Status parse_value(Parser *parser, const yaml_event_t *event, SceneNode *node);

static Status add_child(Parser *parser, SceneNode *parent, const char *key, SceneNode **child) {
  if (++parser->node_count > SCENE_TREE_MAX_NODES)
    return app_scene_tree_fail(parent, "more than %d values; a scene of that size is not read",
                               (int)SCENE_TREE_MAX_NODES);
  *child = app_scene_tree_add(parent, key);
  return *child ? STATUS_OK : status_no_memory("the scene file");
}

static Status parse_item(Parser *parser, const yaml_event_t *event, SceneNode *list) {
  SceneNode *item;
  TRY(add_child(parser, list, NULL, &item));
  return parse_value(parser, event, item);
}

// `event` is the key; the value's event follows.
static Status parse_entry(Parser *parser, const yaml_event_t *event, SceneNode *map) {
  yaml_mark_t mark = event->start_mark;
  TRY(refuse_features(parser, event));
  if (event->type != YAML_SCALAR_EVENT)
    return fail_mark(parser, mark, "a key must be a word, found a structure");
  const char *key = (const char *)event->data.scalar.value;
  if (is_number(key))
    return fail_mark(parser, mark,
                     "a number, '%.60s', where a key must be; numbers have no commas: write 1000000, 0.5",
                     key);
  const SceneNode *earlier = app_scene_tree_find(map, key);
  if (earlier)
    return fail_mark(parser, mark, "duplicate key '%.60s'; it is already at line %d, column %d", key,
                     earlier->key_line, earlier->key_column);
  if (map->count >= SCENE_TREE_MAX_KEYS)
    return fail_mark(parser, mark, "more than %d keys in one mapping", (int)SCENE_TREE_MAX_KEYS);
  SceneNode *entry;
  TRY(add_child(parser, map, key, &entry));
  entry->key_line = (int)mark.line + 1, entry->key_column = (int)mark.column + 1;
  yaml_event_t value;
  TRY(next_event(parser, &value));
  Status status = parse_value(parser, &value, entry);
  yaml_event_delete(&value);
  return status;
}

// The children of a list or map up to the event that ends it.
static Status parse_children(Parser *parser, SceneNode *parent) {
  if (++parser->depth > SCENE_TREE_MAX_DEPTH)
    return app_scene_tree_fail(parent, "nested more than %d deep; no scene needs that", SCENE_TREE_MAX_DEPTH);
  yaml_event_type_t end = parent->kind == SCENE_NODE_LIST ? YAML_SEQUENCE_END_EVENT : YAML_MAPPING_END_EVENT;
  Status status = STATUS_OK;
  bool is_end = false;
  while (!status && !is_end) {
    yaml_event_t event;
    TRY(next_event(parser, &event));
    is_end = event.type == end;
    if (!is_end) status = (end == YAML_SEQUENCE_END_EVENT ? parse_item : parse_entry)(parser, &event, parent);
    yaml_event_delete(&event);
  }
  parser->depth--;
  return status;
}

static Status parse_scalar(const yaml_event_t *event, SceneNode *node) {
  node->kind = SCENE_NODE_TEXT;
  node->text = memory_copy(event->data.scalar.value, event->data.scalar.length + 1, 1);
  if (!node->text) return status_no_memory("the scene file");
  if (strlen(node->text) != event->data.scalar.length)
    return app_scene_tree_fail(node, "a text with a zero character in it");
  if (event->data.scalar.style == YAML_PLAIN_SCALAR_STYLE) resolve_plain(node);
  return STATUS_OK;
}

static Status parse_value(Parser *parser, const yaml_event_t *event, SceneNode *node) {
  node->line = (int)event->start_mark.line + 1, node->column = (int)event->start_mark.column + 1;
  TRY(refuse_features(parser, event));
  if (event->type == YAML_SCALAR_EVENT) return parse_scalar(event, node);
  node->kind = event->type == YAML_SEQUENCE_START_EVENT ? SCENE_NODE_LIST : SCENE_NODE_MAP;
  return parse_children(parser, node);
}

// The one document of a stream; an empty stream leaves the root null.
static Status parse_stream(Parser *parser, SceneNode *root) {
  bool is_end = false, has_document = false;
  while (!is_end) {
    yaml_event_t event;
    TRY(next_event(parser, &event));
    Status status = STATUS_OK;
    switch (event.type) {
    case YAML_STREAM_END_EVENT:
      is_end = true;
      break;
    case YAML_STREAM_START_EVENT:
    case YAML_DOCUMENT_END_EVENT:
      break;
    case YAML_DOCUMENT_START_EVENT:
      if (has_document)
        status = fail_mark(parser, event.start_mark, "a second document ('---'); a file holds one scene");
      has_document = true;
      break;
    default:
      status = parse_value(parser, &event, root);
    }
    yaml_event_delete(&event);
    TRY(status);
  }
  return STATUS_OK;
}

static Status check_text(const Parser *parser) {
  if (parser->size > SCENE_TREE_MAX_BYTES)
    return status_fail(STATUS_INPUT, "%s: %zu bytes; a scene file has at most %d", parser->origin,
                       parser->size, (int)SCENE_TREE_MAX_BYTES);
  size_t valid = text_utf8_valid(parser->text, parser->size);
  if (valid < parser->size)
    return fail_offset(parser, valid, "the byte 0x%02x is not UTF-8; save the file as UTF-8 text",
                       (unsigned char)parser->text[valid]);
  const char *zero = memchr(parser->text, 0, parser->size);
  if (zero) return fail_offset(parser, (size_t)(zero - parser->text), "a zero byte; a scene is plain text");
  return STATUS_OK;
}

Status app_scene_tree_parse(const char *origin, const char *text, size_t size, SceneNode **root) {
  *root = NULL;
  size_t mark = text_mark_length(text, size);
  Parser parser = {.origin = origin, .text = text + mark, .size = size - mark};
  TRY(check_text(&parser));
  SceneNode *node = memory_zeroed(1, sizeof *node);
  if (!node || !yaml_parser_initialize(&parser.yaml)) {
    memory_free(node);
    return status_no_memory("the scene file");
  }
  *node = (SceneNode){.origin = origin, .line = 1, .column = 1};
  yaml_parser_set_encoding(&parser.yaml, YAML_UTF8_ENCODING);
  yaml_parser_set_input_string(&parser.yaml, (const unsigned char *)parser.text, parser.size);
  Status status = parse_stream(&parser, node);
  yaml_parser_delete(&parser.yaml);
  if (status) {
    app_scene_tree_destroy(node);
    return status;
  }
  *root = node;
  return STATUS_OK;
}

Status app_scene_tree_read(const char *path, SceneNode **root) {
  char *text;
  size_t size;
  *root = NULL;
  TRY(file_read(path, &text, &size));
  Status status = app_scene_tree_parse(path, text, size, root);
  memory_free(text);
  return status;
}

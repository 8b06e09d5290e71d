// SPDX-License-Identifier: GPL-3.0-or-later
// app/scene/keys/keys.h: the table of keys, and what is made of it: the manual, the schema.
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "app/scene/manual.h"
#include "app/scene/schema.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "scene_text.h"

static const char *const full_yaml = TETLAP_SOURCE_DIR "/tests/data/scene/full.yaml";

// What is printed to the stream that `print` is given; owned by the caller (free).
static char *printed(Status (*print)(FILE *stream)) {
  char *text = NULL;
  size_t size;
  FILE *stream = open_memstream(&text, &size);
  ck_assert_ok(print(stream));
  fclose(stream);
  return text;
}

// Whether a key of the table stands anywhere in a tree that the section describes.
static bool occurs(const SceneSection *section, const SceneNode *node, const SceneKey *wanted) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    const SceneNode *entry = app_scene_tree_find(node, key->name);
    if (!entry) continue;
    if (key == wanted) return true;
    if (key->type == SCENE_SECTION && occurs(key->section, entry, wanted)) return true;
    for (const SceneNode *item = key->type == SCENE_LIST ? entry->first : NULL; item; item = item->next)
      if (occurs(key->section, item, wanted)) return true;
  }
  return false;
}

static void check_all_occur(const SceneSection *section, const SceneNode *root) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    ck_assert_msg(occurs(&app_scene_keys_root, root, key), "full.yaml lacks the key '%s' (%s)", key->name,
                  section->help);
    if (key->section) check_all_occur(key->section, root);
  }
}

// A key that the full scene lacks would be tested by nothing.
START_TEST(the_full_scene_has_every_key_of_the_table) {
  SceneNode *root;
  ck_assert_ok(app_scene_tree_read(full_yaml, &root));
  check_all_occur(&app_scene_keys_root, root);
  app_scene_tree_destroy(root);
}
END_TEST

static Status print_schema(FILE *stream) {
  Record *schema = record_new();
  TRY(app_scene_schema_record(schema));
  Status status = record_print(schema, stream);
  record_destroy(schema);
  return status;
}

static void check_current(const char *path, Status (*print)(FILE *stream), const char *command) {
  char *text, *now = printed(print);
  size_t size;
  ck_assert_ok(file_read(path, &text, &size));
  ck_assert_msg(strcmp(text, now) == 0, "%s is out of date: %s", path, command);
  memory_free(text);
  free(now);
}

START_TEST(the_manual_page_is_current) {
  check_current(TETLAP_SOURCE_DIR "/docs/scene.md", app_scene_manual_print,
                "tetlap schema --markdown > docs/scene.md");
}
END_TEST

START_TEST(the_schema_file_is_current) {
  check_current(TETLAP_SOURCE_DIR "/docs/scene.schema.json", print_schema,
                "tetlap schema > docs/scene.schema.json");
}
END_TEST

// Every range can be read, and its message shows it as the table has it.
static void check_ranges(const SceneSection *section) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    if (key->section) check_ranges(key->section);
    ck_assert_msg(key->help && key->help[0], "'%s' has no help", key->name);
    if (!key->range) continue;
    SceneRange range = app_scene_keys_range(key);
    ck_assert_msg(range.min < range.max, "'%s' has the range %s", key->name, key->range);
    ck_assert(strchr("[(", key->range[0]) && strchr("])", key->range[strlen(key->range) - 1]));
    ck_assert(app_scene_keys_allows(key, range.min) == !range.is_min_open);
    ck_assert(app_scene_keys_allows(key, range.max) == !range.is_max_open);
    ck_assert(!app_scene_keys_allows(key, NAN));
  }
}

START_TEST(ranges_of_the_table_are_well_formed) {
  check_ranges(&app_scene_keys_root);
}
END_TEST

START_TEST(the_examples_of_required_keys_make_a_scene) {
  char text[1024];
  size_t used = 0;
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(&app_scene_keys_root, i)); i++)
    if (key->required) text_append(text, sizeof text, &used, "%s: %s\n", key->name, key->required);
  FemSceneDef scene;
  ck_assert_ok(scene_text_read("s.yaml", text, used, &scene));
  fem_scene_destroy(&scene);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("schema");
  tcase_add_test(cases, the_full_scene_has_every_key_of_the_table);
  tcase_add_test(cases, the_manual_page_is_current);
  tcase_add_test(cases, the_schema_file_is_current);
  tcase_add_test(cases, ranges_of_the_table_are_well_formed);
  tcase_add_test(cases, the_examples_of_required_keys_make_a_scene);
  return suite_run("schema", cases, 60);
}

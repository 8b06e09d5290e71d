// SPDX-License-Identifier: GPL-3.0-or-later
// Scene files: any text is read or refused with a place, and what is read says itself again. A zero byte
// begins an override (`tetlap run --set`). No mesh is opened.
#include <stdlib.h>
#include <string.h>

#include "app/scene/override.h"
#include "app/scene/write.h"
#include "base/files/record.h"
#include "base/memory.h"
#include "scene_text.h"
#include "target.h"

static const char path[] = "scene.yaml";

// What a failure must look like: of these two kinds, with a message that is not cut down to nothing.
static void check_refusal(Status status) {
  FUZZ_CLAIM(status == STATUS_INPUT || status == STATUS_USAGE, "status %d: %s", (int)status,
             status_message());
  FUZZ_CLAIM(strlen(status_message()) > 8, "message '%s'", status_message());
}

// The definition with all its defaults as JSON; owned.
static char *print(const FemSceneDef *scene) {
  Record *record = record_new();
  FUZZ_CLAIM(record && app_scene_write_resolved(scene, record) == STATUS_OK, "%s", status_message());
  char *text = record_text_of(record_find(record, "scene"));
  record_destroy(record);
  return text;
}

// What is written of a scene is that scene.
static void check_written(const FemSceneDef *scene) {
  char *text = print(scene);
  FemSceneDef again;
  // JSON knows no infinity; a scene that has one is refused before it comes here.
  FUZZ_CLAIM(text, "no text");
  Status status = scene_text_read(path, text, strlen(text), &again);
  FUZZ_CLAIM(status == STATUS_OK, "%s\n%s", status_message(), text);
  char *repeated = print(&again);
  FUZZ_CLAIM(repeated && strcmp(text, repeated) == 0, "first\n%s\nthen\n%s", text, repeated);
  memory_free(repeated);
  memory_free(text);
  fem_scene_destroy(&again);
}

static void run_overridden(const char *text, size_t size, const char *override) {
  SceneNode *root;
  Status status = app_scene_tree_parse(path, text, size, &root);
  if (!status) status = app_scene_override_apply(root, override);
  if (status) check_refusal(status);
  app_scene_tree_destroy(root);
}

static void run(const uint8_t *data, size_t size) {
  const uint8_t *zero = memchr(data, 0, size);
  size_t length = zero ? (size_t)(zero - data) : size;
  char *text = memory_zeroed(size + 1, 1);
  FUZZ_CLAIM(text, "no memory");
  memcpy(text, data, size);
  if (zero) run_overridden(text, length, text + length + 1);
  FemSceneDef scene;
  Status status = scene_text_read(path, text, zero && length == 0 ? size : length, &scene);
  if (status)
    check_refusal(status);
  else
    check_written(&scene);
  fem_scene_destroy(&scene);
  memory_free(text);
}

// Scenes that come with the program, and one with an override.
static size_t seed(int k, uint8_t *data) {
  static const char *const names[] = {
      "tests/data/scene/full.yaml",       "tests/data/scene/full.json",   "examples/01_drop.yaml",
      "examples/03_spheres.yaml",         "examples/05_press.yaml",       "examples/12_fold.yaml",
      "examples/20_loads.yaml",           "examples/21_release.yaml",     "examples/23_fibres.yaml",
      "examples/24_pressure_vessel.yaml", "examples/25_plastic_bar.yaml", "examples/26_hertz.yaml",
  };
  static const char override[] = "\0contact.stiffness=1e6";
  enum { NAME_COUNT = sizeof names / sizeof *names };
  if (k > NAME_COUNT) return 0;
  size_t size = fuzz_target_source(names[k % NAME_COUNT], data, FUZZ_MAX_INPUT - sizeof override);
  if (k < NAME_COUNT) return size;
  memcpy(data + size, override, sizeof override);
  return size + sizeof override;
}

const FuzzTarget fuzz_scene = {.name = "scene", .run = run, .seed = seed};

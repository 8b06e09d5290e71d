// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/overlap.h"

#include <stdio.h>
#include <string.h>

#include "app/scene/override.h"
#include "app/scene/read.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "overlap/source.h"

enum { CHOICE_SIZE = 2 * PATH_MAX }; // every character of a path may be doubled

// A text as YAML has it in single quotes.
static void quote(const char *text, char *quoted, size_t size) {
  size_t used = 0;
  quoted[used++] = '\'';
  for (; *text && used + 4 < size; text++) {
    if (*text == '\'') quoted[used++] = '\'';
    quoted[used++] = *text;
  }
  quoted[used++] = '\'';
  quoted[used] = 0;
}

// A failure of the model's word, which the reader takes for an override's.
static Status name_option(Status status, const char *override, const char *overlap) {
  char told[CHOICE_SIZE + 64], message[CHOICE_SIZE];
  snprintf(told, sizeof told, "--set %s: contact.overlap: ", override);
  if (!status || strncmp(status_message(), told, strlen(told)) != 0) return status;
  snprintf(message, sizeof message, "%s", status_message() + strlen(told));
  return status_fail(status, "--overlap %s: %s", overlap, message);
}

static Status read_with(SceneNode *root, const char *path, const char *overlap, FemSceneDef *scene) {
  char absolute[PATH_MAX], quoted[CHOICE_SIZE], override[CHOICE_SIZE + 32];
  bool is_file = app_model_names_settle(overlap, absolute);
  quote(is_file ? absolute : overlap, quoted, sizeof quoted);
  snprintf(override, sizeof override, "contact.overlap=%s", quoted);
  const char *overrides[1] = {override};
  return name_option(app_scene_read_tree(path, root, overrides, 1, scene), override, overlap);
}

// A scene without contact stays one: choosing a model does not switch contact on. A scene that cannot be
// read as it stands is read with the choice, which says what is wrong.
static Status check_contact(const char *path, const char *const *overrides, int override_count,
                            const char *overlap) {
  FemSceneDef scene;
  if (app_scene_read(path, overrides, override_count, &scene) != STATUS_OK) return STATUS_OK;
  bool is_on = scene.contact.is_on;
  fem_scene_destroy(&scene);
  if (is_on) return STATUS_OK;
  return status_fail(
      STATUS_INPUT,
      "%s: has no section 'contact', so there is nothing for the overlap model '%s'; leave the "
      "model out, or write 'contact: {}' into the scene",
      path, overlap);
}

Status app_scene_overlap_read(const char *path, const char *const *overrides, int override_count,
                              const char *overlap, FemSceneDef *scene) {
  if (!overlap) return app_scene_read(path, overrides, override_count, scene);
  *scene = (FemSceneDef){0};
  TRY(check_contact(path, overrides, override_count, overlap));
  SceneNode *root;
  TRY(app_scene_tree_read(path, &root));
  Status status = STATUS_OK;
  for (int i = 0; i < override_count && !status; i++) status = app_scene_override_apply(root, overrides[i]);
  if (!status) return read_with(root, path, overlap, scene);
  app_scene_tree_destroy(root);
  return status;
}

bool app_scene_overlap_source(const FemSceneDef *scene, char source[PATH_MAX]) {
  const char *word = scene->contact.overlap;
  char from[PATH_MAX];
  if (!scene->contact.is_on) return false;
  char *folder = file_directory_of(scene->path ? scene->path : ".");
  bool fits = folder && overlap_source_from(word, folder, from, sizeof from);
  if (!fits || !app_model_names_settle(from, source)) snprintf(source, PATH_MAX, "%s", word);
  memory_free(folder);
  return true;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/overlap.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/scene/read.h"
#include "base/memory.h"
#include "overlap/weights.h"

static Status replace_net(FemSceneDef *scene, const char *path) {
  memory_free(scene->contact.net);
  scene->contact.net = path ? memory_copy(path, strlen(path) + 1, 1) : NULL;
  return path && !scene->contact.net ? status_no_memory("a file name") : STATUS_OK;
}

static Status read_with(const char *path, const char *const *overrides, int count, const char *choice,
                        FemSceneDef *scene) {
  const char **all = memory_zeroed((size_t)count + 1, sizeof *all);
  if (!all) return status_no_memory("a scene's changes");
  for (int i = 0; i < count; i++) all[i] = overrides[i];
  all[count] = choice;
  Status status = app_scene_read(path, all, count + 1, scene);
  memory_free(all);
  return status;
}

// A scene without contact stays one: the choice of a model is no wish for contact. A scene that cannot be
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
  TRY(check_contact(path, overrides, override_count, overlap));
  char choice[PATH_MAX + 32], weights[PATH_MAX];
  bool is_path = overlap_weights_is_path(overlap) && realpath(overlap, weights);
  snprintf(choice, sizeof choice, "contact.overlap=%s", is_path ? "geo" : overlap);
  TRY(read_with(path, overrides, override_count, choice, scene));
  if (strcmp(overlap, "hybrid") == 0) return STATUS_OK;
  return replace_net(scene, is_path ? weights : NULL);
}

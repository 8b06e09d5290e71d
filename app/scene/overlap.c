// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/overlap.h"

#include <stdio.h>
#include <string.h>

#include "app/scene/override.h"
#include "app/scene/read.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "overlap/weights.h"

static const char HYBRID[] = "hybrid";
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

// What stands in for the scene's choice, as overrides; "": nothing.
typedef struct Choice {
  char overlap[CHOICE_SIZE], net[CHOICE_SIZE];
} Choice;

// The key of the weights: `net` alone, or its entry where the scene has more of it.
static const char *net_key(const SceneNode *root) {
  const SceneNode *net = app_scene_tree_find(app_scene_tree_find(root, "contact"), "net");
  return net && net->kind == SCENE_NODE_MAP ? "contact.net.weights" : "contact.net";
}

static void choose(const char *overlap, const SceneNode *root, Choice *choice) {
  char path[PATH_MAX], quoted[CHOICE_SIZE - 32];
  bool is_hybrid = strncmp(overlap, HYBRID, strlen(HYBRID)) == 0 && strchr("=", overlap[strlen(HYBRID)]);
  bool is_file = app_model_names_locate(overlap, path);
  const char *network = is_hybrid ? strchr(overlap, '=') : NULL;
  const char *weights = is_file ? path : network ? network + 1 : NULL;
  *choice = (Choice){0};
  if (weights) quote(weights, quoted, sizeof quoted);
  snprintf(choice->overlap, sizeof choice->overlap, "contact.overlap=%.200s",
           is_hybrid ? HYBRID
           : is_file ? "clip"
                     : overlap);
  if (!is_hybrid || weights)
    snprintf(choice->net, sizeof choice->net, "%s=%s", net_key(root), weights ? quoted : "null");
}

static Status read_with(SceneNode *root, const char *path, const char *overlap, FemSceneDef *scene) {
  Choice *choice = memory_zeroed(1, sizeof *choice);
  if (!choice) {
    app_scene_tree_destroy(root);
    return status_no_memory("a scene's changes");
  }
  choose(overlap, root, choice);
  const char *overrides[2] = {choice->overlap, choice->net};
  Status status = app_scene_read_tree(path, root, overrides, choice->net[0] ? 2 : 1, scene);
  memory_free(choice);
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
  const FemContactDef *contact = &scene->contact;
  if (!contact->is_on) return false;
  bool is_hybrid = strcmp(contact->overlap, HYBRID) == 0;
  snprintf(source, PATH_MAX, "%s", is_hybrid || !contact->net ? contact->overlap : contact->net);
  if (!contact->net) return true;
  char *directory = file_directory_of(scene->path ? scene->path : "."), path[PATH_MAX];
  bool is_file = overlap_weights_is_path(contact->net);
  char *net = directory ? is_file ? file_join(directory, contact->net)
                                  : memory_copy(contact->net, strlen(contact->net) + 1, 1)
                        : NULL;
  if (net && !(is_file && app_model_names_locate(net, path))) snprintf(path, sizeof path, "%s", net);
  if (net && snprintf(source, PATH_MAX, "%s%s", is_hybrid ? "hybrid=" : "", path) >= PATH_MAX) source[0] = 0;
  memory_free(directory), memory_free(net);
  return true;
}

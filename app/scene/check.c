// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/check.h"

#include <string.h>

// Bodies and obstacles share one set of names.
static Status check_names(const SceneNode *root) {
  static const char *const lists[] = {"bodies", "obstacles"};
  for (int l = 0; l < 2; l++) {
    const SceneNode *list = app_scene_tree_find(root, lists[l]);
    for (const SceneNode *item = list ? list->first : NULL; item; item = item->next) {
      const SceneNode *name = app_scene_tree_find(item, "name");
      for (int m = 0; m <= l; m++) {
        const SceneNode *earlier = app_scene_tree_find(root, lists[m]);
        for (const SceneNode *other = earlier ? earlier->first : NULL; other && other != item;
             other = other->next)
          if (strcmp(app_scene_tree_find(other, "name")->text, name->text) == 0)
            return app_scene_tree_fail(name, "the name '%.60s' is taken by another of the %s; choose another",
                                       name->text, lists[m]);
      }
    }
  }
  return STATUS_OK;
}

// Self-contact is a part of contact.
static Status check_self_contact(const SceneNode *root, const FemSceneDef *scene) {
  const SceneNode *bodies = app_scene_tree_find(root, "bodies"), *body = bodies->first;
  for (int b = 0; b < scene->body_count; b++, body = body->next)
    if (scene->bodies[b].self_contact && !scene->contact.is_on)
      return app_scene_tree_fail_key(app_scene_tree_find(body, "self_contact"),
                                     "'self_contact' needs contact; write 'contact: {}' for its defaults");
  return STATUS_OK;
}

// Whether a number, or any of a list of them, is not zero.
static bool is_nonzero(const SceneNode *node) {
  for (const SceneNode *item = node ? node->first : NULL; item; item = item->next)
    if (is_nonzero(item)) return true;
  return node && node->kind == SCENE_NODE_NUMBER && node->number != 0;
}

// What only a motion can have.
static Status check_static(const SceneNode *root, const FemSceneDef *scene) {
  static const char *const initial[] = {"velocity", "spin"}, *const lists[] = {"fixed", "driven"};
  if (!scene->is_static) return STATUS_OK;
  if (scene->contact.rest_is_on)
    return app_scene_tree_fail_key(app_scene_tree_find(app_scene_tree_find(root, "contact"), "rest"),
                                   "a static scene is at rest always; remove 'rest' or time.static");
  const SceneNode *bodies = app_scene_tree_find(root, "bodies");
  for (const SceneNode *body = bodies->first; body; body = body->next)
    for (int k = 0; k < 2; k++) {
      const SceneNode *motion = app_scene_tree_find(body, initial[k]);
      const SceneNode *list = app_scene_tree_find(body, lists[k]);
      if (is_nonzero(motion))
        return app_scene_tree_fail_key(motion, "a static scene has no initial '%s'; remove it or time.static",
                                       initial[k]);
      for (const SceneNode *item = list ? list->first : NULL; item; item = item->next)
        if (app_scene_tree_find(item, "release"))
          return app_scene_tree_fail_key(
              app_scene_tree_find(item, "release"),
              "a static scene cannot release vertices; remove 'release' or time.static");
    }
  if (scene->solver == FEM_SOLVER_KLU)
    return app_scene_tree_fail(app_scene_tree_find(app_scene_tree_find(root, "solver"), "linear"),
                               "klu solves motions only; write cholmod, amg or pcg for a static scene");
  return STATUS_OK;
}

Status app_scene_check(const SceneNode *root, const FemSceneDef *scene) {
  TRY(check_names(root));
  TRY(check_self_contact(root, scene));
  return check_static(root, scene);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"

static void free_constraints(FemConstraintDef *constraints, int count) {
  for (int i = 0; i < count; i++) {
    memory_free(constraints[i].select.group);
    memory_free(constraints[i].table);
    for (int c = 0; c < 3; c++) memory_free(constraints[i].formula[c]);
    memory_free(constraints[i].angle);
    memory_free(constraints[i].angles);
  }
  memory_free(constraints);
}

static void free_loads(FemLoadDef *loads, int count) {
  for (int i = 0; i < count; i++) {
    memory_free(loads[i].select.group);
    memory_free(loads[i].factor);
    memory_free(loads[i].table);
  }
  memory_free(loads);
}

static void free_body(FemBodyDef *body) {
  memory_free(body->name);
  memory_free(body->mesh_path);
  for (int i = 0; i < body->part_count; i++) memory_free(body->parts[i].select.group);
  memory_free(body->parts);
  free_constraints(body->fixed, body->fixed_count);
  free_constraints(body->driven, body->driven_count);
  free_loads(body->loads, body->load_count);
  for (int i = 0; i < body->inner_count; i++) memory_free(body->inner[i].select.group);
  memory_free(body->inner);
  for (int i = 0; i < body->probe_count; i++) {
    memory_free(body->probes[i].select.group);
    memory_free(body->probes[i].name);
  }
  memory_free(body->probes);
  for (int i = 0; i < body->line_count; i++) memory_free(body->lines[i].name);
  memory_free(body->lines);
}

static void free_obstacle(FemObstacleDef *obstacle) {
  memory_free(obstacle->name);
  memory_free(obstacle->mesh_path);
  memory_free(obstacle->motion.select.group);
  memory_free(obstacle->motion.table);
  for (int c = 0; c < 3; c++) memory_free(obstacle->motion.formula[c]);
  memory_free(obstacle->motion.angle);
  memory_free(obstacle->motion.angles);
}

static void free_law(FemContactLawDef *def) {
  memory_free(def->law.table);
  memory_free(def->law.formula);
}

void fem_scene_destroy(FemSceneDef *scene) {
  for (int i = 0; i < scene->body_count; i++) free_body(&scene->bodies[i]);
  for (int i = 0; i < scene->obstacle_count; i++) free_obstacle(&scene->obstacles[i]);
  memory_free(scene->bodies);
  memory_free(scene->obstacles);
  for (int i = 0; i < scene->contact.pair_count; i++) {
    for (int k = 0; k < 2; k++) memory_free(scene->contact.pairs[i].names[k]);
    free_law(&scene->contact.pairs[i].law);
  }
  free_law(&scene->contact.law);
  memory_free(scene->contact.pairs);
  memory_free(scene->contact.overlap);
  memory_free(scene->status_reference);
  memory_free(scene->path);
  memory_free(scene->title);
  memory_free(scene->start);
  *scene = (FemSceneDef){0};
}

const FemMaterial *fem_scene_material(const FemBodyDef *body, int index) {
  return index == 0 ? &body->material : &body->parts[index - 1].material;
}

bool fem_scene_has_material(const FemSceneDef *scene, bool (*is_such)(const FemMaterial *material)) {
  for (int b = 0; b < scene->body_count; b++)
    for (int i = 0; i <= scene->bodies[b].part_count; i++) {
      const FemMaterial *material = fem_scene_material(&scene->bodies[b], i);
      if (material->young > 0 && is_such(material)) return true;
    }
  return false;
}

double fem_scene_most_friction(const FemContactDef *contact) {
  double most = fmax(contact->friction.coefficient, contact->friction.at_rest);
  for (int i = 0; i < contact->pair_count; i++)
    most = fmax(most, fmax(contact->pairs[i].friction.coefficient, contact->pairs[i].friction.at_rest));
  return most;
}

static bool breaks_away(const FemFrictionDef *friction) {
  return friction->at_rest > friction->coefficient;
}

bool fem_scene_has_breakaway(const FemContactDef *contact) {
  bool has = breaks_away(&contact->friction);
  for (int i = 0; i < contact->pair_count; i++) has = has || breaks_away(&contact->pairs[i].friction);
  return has;
}

// μ of a body with itself; the last pair stands.
static double self_friction(const FemContactDef *contact, const char *name) {
  const FemFrictionDef *friction = &contact->friction;
  for (int i = 0; i < contact->pair_count; i++) {
    const FemContactPairDef *pair = &contact->pairs[i];
    bool is_its = strcmp(pair->names[0], name) == 0 && strcmp(pair->names[1], name) == 0;
    if (is_its && pair->friction.coefficient >= 0) friction = &pair->friction;
  }
  return fmax(friction->coefficient, friction->at_rest);
}

bool fem_scene_has_self_friction(const FemSceneDef *scene) {
  for (int b = 0; b < scene->body_count; b++)
    if (scene->bodies[b].self_contact && self_friction(&scene->contact, scene->bodies[b].name) > 0)
      return true;
  return false;
}

double fem_scene_frame_time(const FemSceneDef *scene, int frame) {
  return frame == scene->frames ? scene->end : scene->end * frame / scene->frames;
}

int fem_scene_shape_count(const FemSceneDef *scene) {
  int count = 0;
  for (int o = 0; o < scene->obstacle_count; o++) count += scene->obstacles[o].kind != FEM_OBSTACLE_MESH;
  return count;
}

FemSceneWhere fem_scene_where(const FemSceneDef *scene, const FemScenePlace *place) {
  FemSceneWhere where = {"scene"};
  if (scene->path && place->line > 0)
    snprintf(where.text, sizeof where.text, "%s:%d:%d", scene->path, place->line, place->column);
  else if (scene->path)
    snprintf(where.text, sizeof where.text, "%s with --set", scene->path);
  return where;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/floating.h"

static bool is_prescribed(const FemModel *model, double released) {
  for (int d = 0; d < model->driver_count; d++)
    if (!fem_model_is_released(&model->drivers[d], released) && model->drivers[d].dof_count > 0) return true;
  return false;
}

// Nothing but half-spaces, if anything, notices a velocity.
static bool notices_planes_alone(const FemModel *model, double released) {
  const FemSceneDef *scene = model->scene;
  for (int o = 0; o < scene->obstacle_count; o++)
    if (scene->obstacles[o].kind != FEM_OBSTACLE_HALFSPACE) return false;
  return !scene->is_static && model->load_count == 0 && !is_prescribed(model, released);
}

bool fem_model_floats(const FemModel *model, double released) {
  return model->scene->obstacle_count == 0 && notices_planes_alone(model, released);
}

double fem_model_mass(const FemModel *model) {
  double mass = 0;
  for (int b = 0; b < model->scene->body_count; b++) mass += model->bodies[b].mass;
  return mass;
}

Vec3 fem_model_centre(const FemModel *model, const FemModelBody *body) {
  Vec3 centre = {0, 0, 0};
  for (int a = body->vertex_begin; a < body->vertex_end; a++)
    centre = vec3_add(centre, vec3_scale(model->mass[a] / body->mass, vec3_at(model->rest + 3 * (size_t)a)));
  return centre;
}

// Of the directions whose part is removed; planes that are nearly parallel to the first two add none.
static const double PARALLEL = 1e-6;

static Vec3 without_normals(const FemSceneDef *scene, Vec3 velocity) {
  Vec3 basis[3];
  int count = 0;
  for (int o = 0; o < scene->obstacle_count && count < 3; o++) {
    Vec3 normal = vec3_at(scene->obstacles[o].normal);
    normal = vec3_scale(1 / vec3_length(normal), normal);
    for (int k = 0; k < count; k++)
      normal = vec3_sub(normal, vec3_scale(vec3_dot(normal, basis[k]), basis[k]));
    double rest = vec3_length(normal);
    if (rest > PARALLEL) basis[count++] = vec3_scale(1 / rest, normal);
  }
  for (int k = 0; k < count; k++)
    velocity = vec3_sub(velocity, vec3_scale(vec3_dot(velocity, basis[k]), basis[k]));
  return velocity;
}

Vec3 fem_model_common_part(const FemModel *model, double released, Vec3 velocity) {
  if (fem_model_floats(model, released)) return velocity;
  bool rubs = fem_scene_most_friction(&model->scene->contact) > 0;
  if (rubs || !notices_planes_alone(model, released)) return (Vec3){0, 0, 0};
  return without_normals(model->scene, velocity);
}

// Of a body that starts as another run left it.
static Vec3 mean_velocity(const FemModel *model, int body) {
  Vec3 momentum = {0, 0, 0};
  for (int v = model->bodies[body].vertex_begin; v < model->bodies[body].vertex_end; v++)
    momentum =
        vec3_add(momentum, vec3_scale(model->mass[v], vec3_at(model->initial_velocity + 3 * (size_t)v)));
  return vec3_scale(1 / model->bodies[body].mass, momentum);
}

Vec3 fem_model_common_start(const FemModel *model) {
  Vec3 momentum = {0, 0, 0};
  for (int b = 0; b < model->scene->body_count; b++) {
    Vec3 velocity = model->start ? mean_velocity(model, b) : vec3_at(model->scene->bodies[b].velocity);
    momentum = vec3_add(momentum, vec3_scale(model->bodies[b].mass, velocity));
  }
  return fem_model_common_part(model, 0, vec3_scale(1 / fem_model_mass(model), momentum));
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/compliance/blow.h"

#include <math.h>

#include "base/vec3.h"
#include "fem/model/floating.h"

// How far down the lowest vertex of a body lies.
static double lowest_of(const FemModel *model, const FemModelBody *body, Vec3 down) {
  double lowest = -INFINITY;
  for (int v = body->vertex_begin; v < body->vertex_end; v++)
    lowest = fmax(lowest, vec3_dot(vec3_at(model->rest + 3 * (size_t)v), down));
  return lowest;
}

static bool is_prescribed(const FemModel *model, const FemModelBody *body) {
  for (int dof = 3 * body->vertex_begin; dof < 3 * body->vertex_end; dof++)
    if (model->is_prescribed[dof]) return true;
  return false;
}

// How far a body may go down before it meets the half-space; 0 where that lies above it, or aside.
static double fall_to_plane(const FemModel *model, const FemModelBody *body, const FemObstacleDef *plane,
                            Vec3 down) {
  Vec3 normal = vec3_at(plane->normal);
  double towards = -vec3_dot(normal, down) / vec3_length(normal), least = INFINITY;
  if (!(towards > 0)) return 0;
  for (int v = body->vertex_begin; v < body->vertex_end; v++) {
    Vec3 arm = vec3_sub(vec3_at(model->rest + 3 * (size_t)v), vec3_at(plane->point));
    least = fmin(least, vec3_dot(arm, normal) / vec3_length(normal));
  }
  return fmax(0, least / towards);
}

// What the scene's gravity is, and where it leads.
typedef struct Gravity {
  double g; // [m/s²]
  Vec3 down;
  double bottom; // how far down the lowest of all bodies and obstacles with a mesh lies [m]
} Gravity;

static Gravity gravity_of(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  Gravity gravity = {.bottom = -INFINITY};
  if (!scene->has_gravity || scene->is_static || fem_model_floats(model, 0)) return gravity;
  gravity.g = vec3_length(vec3_at(scene->gravity));
  if (!(gravity.g > 0)) return gravity;
  gravity.down = vec3_scale(1 / gravity.g, vec3_at(scene->gravity));
  for (int b = 0; b < model->body_count; b++)
    gravity.bottom = fmax(gravity.bottom, lowest_of(model, &model->bodies[b], gravity.down));
  return gravity;
}

static double fall_of(const FemModel *model, const FemModelBody *body, const Gravity *gravity) {
  const FemSceneDef *scene = model->scene;
  const Vec3 down = gravity->down;
  double lowest = lowest_of(model, body, down), fall = fmax(0, gravity->bottom - lowest);
  for (int o = 0; o < scene->obstacle_count; o++) {
    const FemObstacleDef *obstacle = &scene->obstacles[o];
    if (obstacle->kind == FEM_OBSTACLE_MESH) continue;
    if (obstacle->kind == FEM_OBSTACLE_HALFSPACE)
      fall = fmax(fall, fall_to_plane(model, body, obstacle, down));
    else
      fall = fmax(fall, vec3_dot(vec3_at(obstacle->point), down) - lowest);
  }
  return fall;
}

static double energy_at_start(const FemModel *model, const FemModelBody *body) {
  const Vec3 common = fem_model_floats(model, 0) ? fem_model_common_start(model) : (Vec3){0, 0, 0};
  double energy = 0;
  for (int v = body->vertex_begin; v < body->vertex_end; v++) {
    Vec3 velocity = vec3_sub(vec3_at(model->initial_velocity + 3 * (size_t)v), common);
    energy += 0.5 * model->mass[v] * vec3_dot(velocity, velocity);
  }
  return energy;
}

static double energy_of(const FemModel *model, const FemModelBody *body, const Gravity *gravity) {
  const double end = model->scene->end;
  if (model->scene->is_static) return 0;
  double energy = energy_at_start(model, body), g = gravity->g;
  if (!(g > 0) || is_prescribed(model, body)) return energy;
  double speed = sqrt(2 * energy / body->mass), farthest = (speed + 0.5 * g * end) * end;
  return energy + body->mass * g * fmin(fall_of(model, body, gravity), farthest);
}

double fem_blow_hardest(const FemModel *model) {
  const Gravity gravity = gravity_of(model);
  double hardest = 0, second = 0;
  for (int b = 0; b < model->scene->body_count; b++) {
    double energy = energy_of(model, &model->bodies[b], &gravity);
    second = fmax(second, fmin(energy, hardest));
    hardest = fmax(hardest, energy);
  }
  return fem_model_floats(model, 0) ? hardest + second : hardest;
}

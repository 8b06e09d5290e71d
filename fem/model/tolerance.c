// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/tolerance.h"

#include <math.h>

#include "base/vec3.h"
#include "fem/model/floating.h"
#include "fem/model/limits.h"
#include "fem/model/parts.h"

double fem_model_speed_share(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (scene->velocity_tolerance > 0 || !scene->contact.is_on) return 0;
  return FEM_OF_PRESENT_SPEED * scene->tolerance;
}

// Of a body's vertices, where the run starts from another one's end state.
static double fastest_of(const FemModel *model, int body, Vec3 common) {
  double fastest = 0;
  for (int v = model->bodies[body].vertex_begin; v < model->bodies[body].vertex_end; v++)
    fastest = fmax(fastest, vec3_length(vec3_sub(vec3_at(model->initial_velocity + 3 * (size_t)v), common)));
  return fastest;
}

// The fastest at t = 0, or after falling the smallest body's length; infinite where neither is given.
static double expected_speed(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  const Vec3 common = fem_model_common_start(model);
  double fastest = scene->has_gravity ? sqrt(vec3_length(vec3_at(scene->gravity)) * model->length) : 0;
  for (int b = 0; b < scene->body_count; b++) {
    const FemBodyDef *body = &scene->bodies[b];
    if (model->start) fastest = fmax(fastest, fastest_of(model, b, common));
    fastest = fmax(fastest, vec3_length(vec3_sub(vec3_at(body->velocity), common)) +
                                0.5 * model->length * vec3_length(vec3_at(body->spin)));
  }
  return fastest > 0 ? fastest : INFINITY;
}

static bool is_free(const FemSceneDef *scene) {
  return !scene->contact.is_on && !scene->is_static;
}

double fem_model_position_tolerance(const FemModel *model) {
  return (is_free(model->scene) ? FEM_FINE : 1) * model->scene->tolerance * model->length;
}

double fem_model_velocity_tolerance(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (scene->velocity_tolerance > 0) return scene->velocity_tolerance;
  double wave = fem_model_slowest_wave(model), motion = FEM_OF_EXPECTED_SPEED * expected_speed(model);
  if (is_free(scene)) return scene->tolerance * fmin(wave, motion);
  // Where a body rubs on itself normals jump from step to step, and a fine tolerance follows every jump. A
  // fold of 180 tetrahedra stalls at 0.3 of the wave's speed and below.
  if (!fem_scene_has_self_friction(scene)) wave *= FEM_FINE;
  return scene->tolerance * fmin(wave, FEM_FINE * motion);
}

double fem_model_rest_time(const FemModel *model) {
  double given = model->scene->contact.rest_time, longest = 0;
  if (given > 0) return given;
  for (int b = 0; b < model->scene->body_count; b++) {
    double diagonal = sqrt(3) * cbrt(fem_model_parts_volume(model, b));
    longest = fmax(longest, diagonal / fem_model_parts_least(model, b, fem_model_wave));
  }
  return FEM_REST_CROSSINGS * longest;
}

// A body that is wrong by the tolerance after a wave has run through it.
double fem_model_rest_speed(const FemModel *model) {
  double given = model->scene->contact.rest_speed;
  return given > 0 ? given : model->scene->tolerance * fem_model_slowest_wave(model);
}

double fem_model_rest_acceleration(const FemModel *model) {
  double given = model->scene->contact.rest_acceleration;
  return given > 0 ? given : FEM_REST_ACCELERATION * fem_model_rest_speed(model) / fem_model_rest_time(model);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/tolerance.h"

#include <math.h>

#include "base/vec3.h"
#include "fem/model/floating.h"

// Of the slowest wave's speed. An impact's waves carry the speed of the impact, hundredths of that: at 1 a
// ball at 0.5 m/s loses 13 % of its energy in a contact, at 0.1 0.3 %, at 0.03 0.1 % (docs/time.md).
static const double VELOCITY_SHARE = 0.03;
// Where a body rubs on itself normals jump from step to step, and a fine tolerance follows every jump: a fold
// of 180 tetrahedra stalls at 0.3 and below.
static const double VELOCITY_SHARE_OF_SELF_FRICTION = 1;

// Of time.tolerance.
static const double SPEED_SHARE = 5;

double fem_model_speed_share(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (scene->velocity_tolerance > 0 || !scene->contact.is_on) return 0;
  return SPEED_SHARE * scene->tolerance;
}

// Of the speed that a scene's motion is expected to have: in stiff bodies that move slowly waves carry far
// less than a hundredth of √(E/ρ).
static const double MOTION_SHARE = 0.3;

// The fastest at t = 0, or after falling the smallest body's length; infinite where neither is given.
static double expected_speed(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  const Vec3 common = fem_model_common_start(model);
  double fastest = scene->has_gravity ? sqrt(vec3_length(vec3_at(scene->gravity)) * model->length) : 0;
  for (int b = 0; b < scene->body_count; b++) {
    const FemBodyDef *body = &scene->bodies[b];
    fastest = fmax(fastest, vec3_length(vec3_sub(vec3_at(body->velocity), common)) +
                                0.5 * model->length * vec3_length(vec3_at(body->spin)));
  }
  return fastest > 0 ? fastest : INFINITY;
}

// Without contact nothing strikes, and what shakes a body are waves that need not be followed: bending needs
// fine positions, not fine velocities (docs/time.md).
static const double POSITION_SHARE_WITHOUT_CONTACT = 0.03;

static bool is_free(const FemSceneDef *scene) {
  return !scene->contact.is_on && !scene->is_static;
}

double fem_model_position_tolerance(const FemModel *model) {
  return (is_free(model->scene) ? POSITION_SHARE_WITHOUT_CONTACT : 1) * model->scene->tolerance *
         model->length;
}

double fem_model_velocity_tolerance(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (scene->velocity_tolerance > 0) return scene->velocity_tolerance;
  double slowest = fem_model_slowest_wave(model);
  double share = fem_scene_has_self_friction(scene) ? VELOCITY_SHARE_OF_SELF_FRICTION : VELOCITY_SHARE;
  double chosen = scene->tolerance * fmin(share * slowest, MOTION_SHARE * expected_speed(model));
  return is_free(scene) ? chosen / VELOCITY_SHARE : chosen;
}

// A body rings with periods of the time that a wave takes through it and back; some periods, and calm is no
// turning point.
static const double REST_CROSSINGS = 20;

double fem_model_rest_time(const FemModel *model) {
  double given = model->scene->contact.rest_time, longest = 0;
  if (given > 0) return given;
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    double diagonal = sqrt(3) * cbrt(body->mass / body->material.density);
    longest = fmax(longest, diagonal / fem_model_wave(&body->material));
  }
  return REST_CROSSINGS * longest;
}

// A body that is wrong by the tolerance after a wave has run through it.
double fem_model_rest_speed(const FemModel *model) {
  double given = model->scene->contact.rest_speed;
  return given > 0 ? given : model->scene->tolerance * fem_model_slowest_wave(model);
}

// A smaller value would never be met: the integrator's own errors accelerate a body at rest by some
// hundredths of a tolerance's speed in the time of a crossing.
static const double REST_ACCELERATION = 5; // speeds in the time it is watched

double fem_model_rest_acceleration(const FemModel *model) {
  double given = model->scene->contact.rest_acceleration;
  return given > 0 ? given : REST_ACCELERATION * fem_model_rest_speed(model) / fem_model_rest_time(model);
}

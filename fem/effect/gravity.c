// SPDX-License-Identifier: GPL-3.0-or-later
// Gravity: m g on every vertex of a body; its energy is −Σ m g · x. In a static scene it grows from nothing
// to all of it, s m g, until the first frame, so that a step of load can be halved; its energy is that of
// rest and −s Σ m g · (x − X).
#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/effect.h"

typedef struct Gravity {
  const FemModel *model; // borrowed
  Vec3 g;                // [m/s²]
  double ramp;           // time until all of it acts; 0: from the start [s]
} Gravity;

static bool is_wanted(const FemSceneDef *scene) {
  return scene->has_gravity;
}

static Status create(void **self, const FemModel *model) {
  Gravity *gravity = memory_zeroed(1, sizeof *gravity);
  if (!gravity) return status_no_memory("gravity");
  *gravity = (Gravity){.model = model,
                       .g = vec3_at(model->scene->gravity),
                       .ramp = model->scene->is_static ? fem_scene_frame_time(model->scene, 1) : 0};
  *self = gravity;
  return STATUS_OK;
}

static double share_at(const Gravity *gravity, double time) {
  return gravity->ramp > 0 ? fmin(time / gravity->ramp, 1) : 1;
}

static Status add_force(void *self, const FemState *state, double *force) {
  const Gravity *gravity = self;
  Vec3 g = vec3_scale(share_at(gravity, state->time), gravity->g);
  for (int a = 0; a < gravity->model->vertex_count; a++)
    vec3_accumulate(force + 3 * (size_t)a, vec3_scale(gravity->model->mass[a], g));
  return STATUS_OK;
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  const Gravity *gravity = self;
  double sum = 0, share = share_at(gravity, state->time);
  for (int a = 0; a < gravity->model->vertex_count; a++) {
    Vec3 X = vec3_at(gravity->model->rest + 3 * (size_t)a), x = vec3_at(state->positions + 3 * (size_t)a);
    Vec3 weighed = vec3_add(X, vec3_scale(share, vec3_sub(x, X)));
    sum -= gravity->model->mass[a] * vec3_dot(gravity->g, weighed);
  }
  energy->gravity += sum;
  return STATUS_OK;
}

static bool is_linear(void *self) {
  (void)self;
  return true;
}

static size_t bytes(const void *self) {
  return memory_held(self);
}

const FemEffectOps fem_effect_gravity = {
    .name = "gravity",
    .help = "the bodies' weight",
    .is_wanted = is_wanted,
    .create = create,
    .add_force = add_force,
    .add_energy = add_energy,
    .is_linear = is_linear,
    .bytes = bytes,
    .destroy = memory_free,
};

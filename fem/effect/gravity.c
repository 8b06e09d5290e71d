// SPDX-License-Identifier: GPL-3.0-or-later
// Gravity: m g on every vertex of a body; its energy is −Σ m g · x. In a static scene it grows from nothing
// to all of it, s m g, until the first frame, so that a step of load can be halved; its energy is that of
// rest and −s Σ m g · (x − X). A run that starts from another one's end state has all of it at once.
#include "fem/effect/gravity.h"

#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/effect.h"

typedef struct Gravity {
  const FemModel *model; // borrowed
  Vec3 g;                // [m/s²]
} Gravity;

static bool is_wanted(const FemSceneDef *scene) {
  return scene->has_gravity;
}

static Status create(void **self, const FemModel *model) {
  Gravity *gravity = memory_zeroed(1, sizeof *gravity);
  if (!gravity) return status_no_memory("gravity");
  *gravity = (Gravity){.model = model, .g = vec3_at(model->scene->gravity)};
  *self = gravity;
  return STATUS_OK;
}

double fem_gravity_share(const FemModel *model, double time) {
  bool grows = model->scene->is_static && !model->start;
  return grows ? fmin(time / fem_scene_frame_time(model->scene, 1), 1) : 1;
}

double fem_gravity_ramp_work(const FemModel *model, double share, const double *positions) {
  double sum = 0;
  if (!model->scene->has_gravity || share == 0) return 0;
  for (int a = 0; a < model->vertex_count; a++)
    sum += model->mass[a] *
           vec3_dot(vec3_at(model->scene->gravity),
                    vec3_sub(vec3_at(positions + 3 * (size_t)a), vec3_at(model->rest + 3 * (size_t)a)));
  return -share * sum;
}

static Status add_force(void *self, const FemState *state, double *force) {
  const Gravity *gravity = self;
  Vec3 g = vec3_scale(fem_gravity_share(gravity->model, state->time), gravity->g);
  for (int a = 0; a < gravity->model->vertex_count; a++)
    vec3_accumulate(force + 3 * (size_t)a, vec3_scale(gravity->model->mass[a], g));
  return STATUS_OK;
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  const Gravity *gravity = self;
  double sum = 0, share = fem_gravity_share(gravity->model, state->time);
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

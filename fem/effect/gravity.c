// SPDX-License-Identifier: GPL-3.0-or-later
// Gravity: m g on every vertex of a body; its energy is −Σ m g · x.
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

static Status add_force(void *self, const FemState *state, double *force) {
  (void)state;
  const Gravity *gravity = self;
  for (int a = 0; a < gravity->model->vertex_count; a++)
    vec3_accumulate(force + 3 * (size_t)a, vec3_scale(gravity->model->mass[a], gravity->g));
  return STATUS_OK;
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  const Gravity *gravity = self;
  double sum = 0;
  for (int a = 0; a < gravity->model->vertex_count; a++)
    sum -= gravity->model->mass[a] * vec3_dot(gravity->g, vec3_at(state->positions + 3 * (size_t)a));
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

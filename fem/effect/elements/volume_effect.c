// SPDX-License-Identifier: GPL-3.0-or-later
// Nodal volume change of the bodies with `element: nodal`, as an effect: fem/effect/elements/volume.h.
#include "fem/effect/elements/volume_effect.h"

#include "base/memory.h"
#include "fem/effect/effect.h"
#include "fem/effect/elements/volume.h"

static bool is_wanted(const FemSceneDef *scene) {
  for (int b = 0; b < scene->body_count; b++)
    if (scene->bodies[b].element == FEM_ELEMENT_NODAL) return true;
  return false;
}

static void destroy(void *self) {
  fem_volume_destroy(self);
  memory_free(self);
}

static Status create(void **self, const FemModel *model) {
  FemVolume *volume = memory_zeroed(1, sizeof *volume);
  if (!volume) return status_no_memory("nodal volumes");
  Status status = fem_volume_create(volume, model);
  if (status)
    memory_free(volume);
  else
    *self = volume;
  return status;
}

static Status couple(void *self, const FemState *state, FemPattern *pattern, int *has_grown) {
  (void)state;
  return fem_volume_couple(self, pattern, has_grown);
}

static Status add_force(void *self, const FemState *state, double *force) {
  fem_volume_evaluate(self, state->positions);
  fem_volume_add_force(self, force);
  return STATUS_OK;
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
  (void)damping_scale;
  if (stiffness_scale == 0) return STATUS_OK;
  fem_volume_evaluate(self, state->positions);
  fem_volume_add_stiffness(self, state->positions, stiffness_scale, matrix);
  return STATUS_OK;
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  fem_volume_evaluate(self, state->positions);
  energy->elastic += fem_volume_energy(self);
  return STATUS_OK;
}

// The stress of P = p ∂θ/∂F.
void fem_effect_volume_add_stress(const void *self, int tet, const double x[12], double stress[6]) {
  const FemVolume *volume = self;
  const FemModel *model = volume->model;
  FemMaterialLaw law = fem_model_law(model, tet);
  double F[9], gradient[9], one[6], pressure = fem_volume_pressure(volume, tet);
  const FemElement element = fem_model_element(model, tet);
  fem_element_deformation(&element, x, F);
  fem_material_volume(law, F, gradient);
  fem_material_cauchy(law, F, gradient, one);
  for (int s = 0; s < 6; s++) stress[s] += pressure * one[s];
}

static bool is_linear(void *self) {
  return fem_model_has_linear_materials(((const FemVolume *)self)->model);
}

static size_t bytes(const void *self) {
  return memory_held(self) + fem_volume_bytes(self);
}

const FemEffectOps fem_effect_volume = {
    .name = "volume",
    .help = "volume changes averaged at the vertices, for bodies with element: nodal",
    .is_wanted = is_wanted,
    .create = create,
    .couple = couple,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .is_linear = is_linear,
    .bytes = bytes,
    .destroy = destroy,
};

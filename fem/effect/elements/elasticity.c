// SPDX-License-Identifier: GPL-3.0-or-later
// Elasticity: every element's stored energy by its material's law.
#include "fem/effect/elements/elasticity.h"

#include "base/ranks.h"
#include "fem/effect/elements/assembly.h"

static bool is_wanted(const FemSceneDef *scene) {
  return scene->body_count > 0;
}

static Status create(void **self, const FemModel *model) {
  return fem_assembly_effect_create(self, model, NULL);
}

static FemQuadraticLaw law_of(const FemModelPart *part) {
  return (FemQuadraticLaw){&part->local, part->bulk};
}

static void pack_force(const FemAssemblyPack *pack, FemLanesRow *force) {
  pack->lanes->force(&pack->part->local, pack->elements, pack->positions, force);
}

static void pack_matrix(const FemAssemblyPack *pack, double stiffness_scale, double damping_scale,
                        FemLanesRow *matrix) {
  (void)damping_scale;
  pack->lanes->matrix(&pack->part->local, pack->elements, pack->positions, stiffness_scale, matrix);
}

static void quadratic_force(const FemAssemblyPack *pack, FemLanesRow *force) {
  pack->lanes->quadratic_force(law_of(pack->part), pack->quadratics, pack->positions, force);
}

static void quadratic_matrix(const FemAssemblyPack *pack, double stiffness_scale, double damping_scale,
                             FemLanesRow *matrix) {
  (void)damping_scale;
  pack->lanes->quadratic_matrix(law_of(pack->part), pack->quadratics, pack->positions, stiffness_scale,
                                matrix);
}

static void pack_energy(const FemAssemblyPack *pack, FemLanesRow energy) {
  pack->lanes->energy(&pack->part->local, pack->elements, pack->positions, energy);
}

static void quadratic_energy(const FemAssemblyPack *pack, FemLanesRow energy) {
  pack->lanes->quadratic_energy(law_of(pack->part), pack->quadratics, pack->positions, energy);
}

static const FemAssemblyKernels kernels = {pack_force,       quadratic_force, pack_matrix,
                                           quadratic_matrix, pack_energy,     quadratic_energy};

static Status add_force(void *self, const FemState *state, double *force) {
  fem_assembly_add_forces(self, state, &kernels, force);
  return STATUS_OK;
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
  if (stiffness_scale == 0) return STATUS_OK;
  return fem_assembly_add_matrices(self, state, &kernels, stiffness_scale, damping_scale, matrix);
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  energy->elastic += fem_assembly_sum(self, state, &kernels);
  return STATUS_OK;
}

void fem_effect_elasticity_energies(void *effect, const FemState *state, double *energies) {
  const FemModel *model = ((const FemAssembly *)effect)->model;
  fem_assembly_sum_bodies(effect, state, &kernels, energies);
  if (model->share) ranks()->sum(energies, (size_t)model->body_count);
}

const FemEffectOps fem_effect_elasticity = {
    .name = "elasticity",
    .help = "the elements' elastic forces, by the materials of bodies",
    .is_divided = true,
    .is_wanted = is_wanted,
    .create = create,
    .create_again = fem_assembly_effect_keep,
    .couple = fem_assembly_effect_couple,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .is_linear = fem_assembly_effect_is_linear,
    .bytes = fem_assembly_effect_bytes,
    .destroy = fem_assembly_effect_destroy,
};

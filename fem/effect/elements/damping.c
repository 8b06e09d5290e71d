// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffness-proportional damping of the strain rate; rigid motion goes undamped (fem/element/element.h). Only
// materials with β > 0 or a viscosity take part.
#include "fem/effect/elements/assembly.h"
#include "fem/effect/system.h"

static bool is_viscous(const FemMaterial *material) {
  return material->damping > 0 || material->viscosity > 0 || material->bulk_viscosity > 0;
}

// By the scene's β.
static bool may_be_damped(const FemMaterial *material) {
  return material->damping < 0 || is_viscous(material);
}

static bool is_wanted(const FemSceneDef *scene) {
  if (scene->is_static) return false;
  return fem_scene_has_material(scene, scene->stiffness_damping > 0 ? may_be_damped : is_viscous);
}

static bool is_damped(const FemModelPart *part) {
  return part->damping > 0 || part->material.viscosity > 0 || part->material.bulk_viscosity > 0;
}

static Status create(void **self, const FemModel *model) {
  return fem_assembly_effect_create(self, model, is_damped);
}

// Where all elastic elements are damped, the elements are those of elasticity.
static Status connect(void *self, const FemSystem *system) {
  FemAssembly *elasticity = fem_system_effect(system, &fem_effect_elasticity);
  if (elasticity) fem_assembly_borrow(self, elasticity);
  return STATUS_OK;
}

static void pack_force(const FemAssemblyPack *pack, FemLanesRow *force) {
  const FemModelPart *part = pack->part;
  pack->lanes->damping_force(&part->local, part->damping, pack->elements, pack->positions, pack->velocities,
                             force);
}

static void pack_matrix(const FemAssemblyPack *pack, double stiffness_scale, double damping_scale,
                        FemLanesRow *matrix) {
  const FemModelPart *part = pack->part;
  pack->lanes->damping_matrix(&part->local, part->damping, pack->elements, pack->positions, pack->velocities,
                              stiffness_scale, damping_scale, matrix);
}

static void quadratic_force(const FemAssemblyPack *pack, FemLanesRow *force) {
  const FemModelPart *part = pack->part;
  pack->lanes->quadratic_damping_force(&part->local, part->damping, pack->quadratics, pack->positions,
                                       pack->velocities, force);
}

static void quadratic_matrix(const FemAssemblyPack *pack, double stiffness_scale, double damping_scale,
                             FemLanesRow *matrix) {
  const FemModelPart *part = pack->part;
  pack->lanes->quadratic_damping_matrix(&part->local, part->damping, pack->quadratics, pack->positions,
                                        pack->velocities, stiffness_scale, damping_scale, matrix);
}

static void pack_power(const FemAssemblyPack *pack, FemLanesRow power) {
  const FemModelPart *part = pack->part;
  pack->lanes->damping_power(&part->local, part->damping, pack->elements, pack->positions, pack->velocities,
                             power);
}

static void quadratic_power(const FemAssemblyPack *pack, FemLanesRow power) {
  const FemModelPart *part = pack->part;
  pack->lanes->quadratic_damping_power(&part->local, part->damping, pack->quadratics, pack->positions,
                                       pack->velocities, power);
}

static const FemAssemblyKernels kernels = {pack_force,       quadratic_force, pack_matrix,
                                           quadratic_matrix, pack_power,      quadratic_power};

static Status add_force(void *self, const FemState *state, double *force) {
  fem_assembly_add_forces(self, state, &kernels, force);
  return STATUS_OK;
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
  if (stiffness_scale == 0 && damping_scale == 0) return STATUS_OK;
  return fem_assembly_add_matrices(self, state, &kernels, stiffness_scale, damping_scale, matrix);
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  energy->dissipated_power += fem_assembly_sum(self, state, &kernels);
  return STATUS_OK;
}

const FemEffectOps fem_effect_damping = {
    .name = "damping",
    .help = "stiffness-proportional damping and viscosity, by the strain rate",
    .dissipates = true,
    .is_divided = true,
    .is_wanted = is_wanted,
    .create = create,
    .create_again = fem_assembly_effect_keep,
    .connect = connect,
    .couple = fem_assembly_effect_couple,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .is_linear = fem_assembly_effect_is_linear,
    .bytes = fem_assembly_effect_bytes,
    .destroy = fem_assembly_effect_destroy,
};

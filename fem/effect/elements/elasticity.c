// SPDX-License-Identifier: GPL-3.0-or-later
// Elasticity: every element's stored energy by its material's law.
#include "base/memory.h"
#include "fem/effect/elements/assembly.h"

static bool is_wanted(const FemSceneDef *scene) {
  return scene->body_count > 0;
}

static void destroy(void *self) {
  fem_assembly_destroy(self);
  memory_free(self);
}

static Status create(void **self, const FemModel *model) {
  FemAssembly *assembly = memory_zeroed(1, sizeof *assembly);
  if (!assembly) return status_no_memory("elasticity");
  Status status = fem_assembly_create(assembly, model, NULL);
  if (status) {
    destroy(assembly);
    return status;
  }
  *self = assembly;
  return STATUS_OK;
}

// Nothing of it depends on former states.
static Status create_again(void **self, void **old) {
  *self = *old;
  *old = NULL;
  return STATUS_OK;
}

static Status couple(void *self, const FemState *state, FemPattern *pattern, int *has_grown) {
  (void)state;
  return fem_assembly_couple(self, pattern, has_grown);
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

static bool is_linear(void *self) {
  return fem_model_has_linear_materials(((const FemAssembly *)self)->model);
}

static size_t bytes(const void *self) {
  return memory_held(self) + fem_assembly_bytes(self);
}

const FemEffectOps fem_effect_elasticity = {
    .name = "elasticity",
    .help = "the elements' elastic forces, by the materials of bodies",
    .is_divided = true,
    .is_wanted = is_wanted,
    .create = create,
    .create_again = create_again,
    .couple = couple,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .is_linear = is_linear,
    .bytes = bytes,
    .destroy = destroy,
};

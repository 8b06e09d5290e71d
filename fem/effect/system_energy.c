// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/system_energy.h"

#include <string.h>

#include "base/ranks.h"
#include "base/vec3.h"
#include "fem/effect/formulas.h"
#include "fem/model/floating.h"

static double kinetic_energy(const FemSystem *system, const double *velocities) {
  double sum = 0;
  for (int i = 0; i < system->numbering.count; i++) {
    int dof = system->numbering.dof_of_unknown[i];
    sum += 0.5 * system->model->mass[dof / 3] * velocities[dof] * velocities[dof];
  }
  return sum;
}

// Of the motion that nothing can notice.
static double common_kinetic(const FemSystem *system, const double *velocities) {
  const FemModel *model = system->model;
  const double mass = fem_model_mass(model);
  double p[3] = {0};
  for (int i = 0; i < system->numbering.count; i++) {
    int dof = system->numbering.dof_of_unknown[i];
    p[dof % 3] += model->mass[dof / 3] * velocities[dof];
  }
  Vec3 common = fem_model_common_part(model, system->numbering.released, vec3_scale(1 / mass, vec3_at(p)));
  return 0.5 * mass * vec3_dot(common, common);
}

// A prescribed coordinate is moved by minus the force that acts on it.
static double driven_power(const FemSystem *system, const double *velocities) {
  const FemModel *model = system->model;
  double sum = 0;
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    if (!fem_model_is_moved(driver, system->numbering.released)) continue;
    for (int i = 0; i < driver->dof_count; i++)
      sum -= system->forces[driver->dofs[i]] * velocities[driver->dofs[i]];
  }
  return sum;
}

static bool has_moving_driver(const FemSystem *system) {
  for (int d = 0; d < system->model->driver_count; d++)
    if (fem_model_is_moved(&system->model->drivers[d], system->numbering.released)) return true;
  return false;
}

static Status add_energies(FemSystem *system, const FemState *state, FemEffectPart part, FemEnergy *energy) {
  for (int i = 0; i < system->effect_count; i++) {
    const FemEffect *effect = &system->effects[i];
    if (effect->ops->add_energy && fem_effect_is_of(effect, part))
      TRY(effect->ops->add_energy(effect->self, state, energy));
  }
  return STATUS_OK;
}

// Σ over ranks of what each gives of energies, unless one cannot.
static Status sum_energies(FemSystem *system, const FemState *state, FemEnergy *energy) {
  FemEnergy own = {0};
  double sums[FEM_ENERGY_TERMS + 1]; // one more for how many could not
  Status status = add_energies(system, state, FEM_EFFECT_DIVIDED, &own);
  memcpy(sums, own.terms, sizeof own.terms);
  sums[FEM_ENERGY_TERMS] = status != STATUS_OK;
  ranks()->sum(sums, FEM_ENERGY_TERMS + 1);
  if (sums[FEM_ENERGY_TERMS] > 0) return ranks()->worst(status);
  memcpy(own.terms, sums, sizeof own.terms);
  fem_energy_add(energy, &own);
  return ranks()->worst(add_energies(system, state, FEM_EFFECT_WHOLE, energy));
}

Status fem_system_energy(FemSystem *system, const FemState *state, FemEnergy *energy) {
  const FemModel *model = system->model;
  TRY(ranks()->worst(fem_formulas_check(model, state->time)));
  *energy = (FemEnergy){.kinetic = kinetic_energy(system, state->velocities)};
  if (has_moving_driver(system)) {
    TRY(fem_system_forces(system, state));
    energy->driven_power = driven_power(system, state->velocities);
  }
  TRY(model->share ? sum_energies(system, state, energy)
                   : add_energies(system, state, FEM_EFFECT_ALL, energy));
  energy->common_kinetic = common_kinetic(system, state->velocities);
  if (fem_model_floats(model, system->numbering.released)) energy->common_gravity = energy->gravity;
  return STATUS_OK;
}

static Status add_damping(FemSystem *system, const FemState *state, FemEnergy *energy) {
  for (int i = 0; i < system->effect_count; i++)
    if (system->effects[i].ops == &fem_effect_damping)
      return fem_effect_damping.add_energy(system->effects[i].self, state, energy);
  return STATUS_OK;
}

Status fem_system_damping_power(FemSystem *system, const FemState *state, double *power) {
  FemEnergy own = {0};
  Status status = add_damping(system, state, &own);
  double sums[2] = {own.dissipated_power, status != STATUS_OK};
  if (system->model->share) ranks()->sum(sums, 2);
  *power = sums[0];
  return sums[1] > 0 ? ranks()->worst(status) : STATUS_OK;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/effect/damping.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

Status fem_damping_create(FemDamping *damping, const FemSystem *system) {
  size_t values = 3 * (size_t)system->model->vertex_count;
  *damping = (FemDamping){.effect = fem_system_effect(system, &fem_effect_damping), .value_count = values};
  if (!damping->effect) return STATUS_OK;
  double **arrays[] = {&damping->now, &damping->rate, &damping->field, &damping->force};
  bool fits = true;
  for (int i = 0; i < 4; i++) fits = (*arrays[i] = memory_zeroed(values, sizeof(double))) && fits;
  return fits ? STATUS_OK : status_no_memory("derivatives of damping");
}

void fem_damping_destroy(FemDamping *damping) {
  double *arrays[] = {damping->now, damping->rate, damping->field, damping->force};
  for (int i = 0; i < 4; i++) memory_free(arrays[i]);
  *damping = (FemDamping){0};
}

void fem_damping_begin(FemDamping *damping, const FemState *state) {
  damping->state = state;
  if (!damping->effect) return;
  memset(damping->now, 0, damping->value_count * sizeof(double));
  memset(damping->rate, 0, damping->value_count * sizeof(double));
}

// Adds share · f(positions, velocities).
static Status add(FemDamping *damping, double *positions, double *velocities, double share, double *sum) {
  FemState other = *damping->state;
  other.positions = positions;
  other.velocities = velocities;
  memset(damping->force, 0, damping->value_count * sizeof(double));
  TRY(fem_effect_damping.add_force(damping->effect, &other, damping->force));
  for (size_t i = 0; i < damping->value_count; i++) sum[i] += share * damping->force[i];
  return STATUS_OK;
}

static double largest_of(const FemDamping *damping, const double *values) {
  double largest = 0;
  for (size_t i = 0; i < damping->value_count; i++) largest = fmax(largest, fabs(values[i]));
  return largest;
}

// λ as long as v, so that neither is lost in the sum.
Status fem_damping_pull(FemDamping *damping, const double *forces, double weight) {
  if (!damping->effect) return STATUS_OK;
  double *field = damping->field, *positions = damping->state->positions;
  const double *velocities = damping->state->velocities;
  double speed = largest_of(damping, velocities), size = largest_of(damping, forces);
  if (!(size > 0)) return STATUS_OK;
  for (size_t i = 0; i < damping->value_count; i++) field[i] = forces[i] / size;
  TRY(add(damping, positions, field, weight * size, damping->rate));
  for (int side = 1; side >= -1 && speed > 0; side -= 2) {
    for (size_t i = 0; i < damping->value_count; i++)
      field[i] = speed / size * forces[i] + side * velocities[i];
    TRY(add(damping, field, positions, 0.5 * side * weight * size / speed, damping->now));
  }
  return STATUS_OK;
}

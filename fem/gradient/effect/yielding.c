// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/effect/yielding.h"

#include <string.h>

#include "base/memory.h"

static size_t values_of(const FemYielding *yielding) {
  return 3 * (size_t)yielding->model->vertex_count;
}

static size_t points_of(const FemYielding *yielding) {
  return (size_t)fem_effect_plasticity_count(yielding->effect);
}

Status fem_yielding_create(FemYielding *yielding, const FemSystem *system) {
  *yielding =
      (FemYielding){.effect = fem_system_effect(system, &fem_effect_plasticity), .model = system->model};
  if (!yielding->effect) return STATUS_OK;
  yielding->now = memory_zeroed(values_of(yielding), sizeof(double));
  yielding->scaled = memory_zeroed(values_of(yielding), sizeof(double));
  yielding->after = memory_zeroed(points_of(yielding), sizeof *yielding->after);
  yielding->before = memory_zeroed(points_of(yielding), sizeof *yielding->before);
  yielding->parts = memory_zeroed((size_t)system->model->part_count, sizeof *yielding->parts);
  bool fits = yielding->now && yielding->scaled && yielding->after && yielding->before && yielding->parts;
  return fits ? STATUS_OK : status_no_memory("derivatives of plasticity");
}

void fem_yielding_destroy(FemYielding *yielding) {
  void *arrays[] = {yielding->now, yielding->scaled, yielding->after, yielding->before, yielding->parts};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i]);
  *yielding = (FemYielding){0};
}

static FemPlasticitySlope slope_of(const FemYielding *yielding) {
  return (FemPlasticitySlope){yielding->now, yielding->before, yielding->parts};
}

void fem_yielding_begin(FemYielding *yielding, const FemState *state) {
  FemPlastic *after = yielding->before;
  yielding->state = state;
  if (!yielding->effect) return;
  yielding->before = yielding->after;
  yielding->after = after;
  memset(yielding->before, 0, points_of(yielding) * sizeof *yielding->before);
  memset(yielding->now, 0, values_of(yielding) * sizeof(double));
  memset(yielding->parts, 0, (size_t)yielding->model->part_count * sizeof *yielding->parts);
}

void fem_yielding_pull_history(FemYielding *yielding) {
  if (!yielding->effect) return;
  const FemPlasticitySlope slope = slope_of(yielding);
  fem_effect_plasticity_pull_history(yielding->effect, yielding->state, 0, yielding->after, &slope);
}

void fem_yielding_pull(FemYielding *yielding, const double *forces, double weight) {
  if (!yielding->effect) return;
  for (size_t i = 0; i < values_of(yielding); i++) yielding->scaled[i] = weight * forces[i];
  const FemPlasticitySlope slope = slope_of(yielding);
  fem_effect_plasticity_pull_forces(yielding->effect, yielding->state, yielding->scaled, &slope);
}

void fem_yielding_pull_energy(FemYielding *yielding, double weight) {
  if (!yielding->effect) return;
  const FemPlasticitySlope slope = slope_of(yielding);
  fem_effect_plasticity_pull_history(yielding->effect, yielding->state, weight, NULL, &slope);
}

double fem_yielding_change(const FemYielding *yielding, const FemParameter *parameter) {
  if (!yielding->effect || parameter->part < 0) return 0;
  const FemPlasticSlope *slope = &yielding->parts[parameter->part];
  const FemMaterial *material = &yielding->model->parts[parameter->part].material;
  switch (parameter->kind) {
  case FEM_PARAMETER_YOUNG:
  case FEM_PARAMETER_POISSON:
    return slope->mu * fem_parameter_lame_rate(material, parameter->kind).mu;
  case FEM_PARAMETER_YIELD:
    return slope->yield;
  case FEM_PARAMETER_HARDENING:
    return slope->hardening;
  default:
    return 0;
  }
}

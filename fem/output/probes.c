// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/probes.h"

#include <string.h>

#include "base/memory.h"
#include "fem/output/reactions.h"

static size_t values_of(const FemProbes *probes) {
  return 3 * (size_t)probes->system->model->vertex_count;
}

Status fem_probes_create(FemProbes *probes, FemSystem *system) {
  *probes = (FemProbes){.system = system};
  if (system->model->probe_count == 0) return STATUS_OK;
  probes->external = memory_zeroed(values_of(probes), sizeof *probes->external);
  probes->reaction = memory_zeroed(values_of(probes), sizeof *probes->reaction);
  probes->readings = memory_zeroed((size_t)system->model->probe_count, sizeof *probes->readings);
  return probes->external && probes->reaction && probes->readings ? STATUS_OK
                                                                  : status_no_memory("the probes");
}

void fem_probes_destroy(FemProbes *probes) {
  memory_free(probes->external);
  memory_free(probes->reaction);
  memory_free(probes->readings);
  *probes = (FemProbes){0};
}

Status fem_probes_add_columns(FemHistory *history, const FemModel *model) {
  for (int p = 0; p < model->probe_count; p++)
    for (int k = 0; k < FEM_READING_COUNT; k++)
      TRY(fem_history_add_column(history, "probe_%s_%s", model->probes[p].def->name, fem_reading_title(k)));
  return STATUS_OK;
}

static void add(size_t count, const double *from, double *to) {
  for (size_t k = 0; k < count && from; k++) to[k] += from[k];
}

static Status find_external(FemProbes *probes, const FemState *state, const FemForces *contact) {
  FemSystem *system = probes->system;
  size_t count = values_of(probes);
  memset(probes->external, 0, count * sizeof *probes->external);
  void *loads = fem_system_effect(system, &fem_effect_loads);
  if (loads) TRY(fem_effect_loads.add_force(loads, state, probes->external));
  if (fem_reactions_any(system->model)) {
    TRY(fem_reactions_measure(system, state, NULL, probes->reaction));
    add(count, probes->reaction, probes->external);
  }
  add(count, contact->contact, probes->external);
  add(count, contact->friction, probes->external);
  return STATUS_OK;
}

Status fem_probes_measure(FemProbes *probes, const FemState *state, const FemForces *contact) {
  const FemModel *model = probes->system->model;
  if (!probes->readings) return STATUS_OK;
  TRY(find_external(probes, state, contact));
  for (int p = 0; p < model->probe_count; p++)
    probes->readings[p] =
        fem_reading_take(&model->probes[p], model->rest, state->positions, probes->external);
  return STATUS_OK;
}

double *fem_probes_fill(const FemProbes *probes, double *row) {
  size_t bytes = FEM_READING_COUNT * sizeof *row;
  for (int p = 0; p < probes->system->model->probe_count; p++, row += FEM_READING_COUNT)
    memcpy(row, &probes->readings[p], bytes);
  return row;
}

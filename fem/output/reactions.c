// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/reactions.h"

#include <stddef.h>
#include <string.h>

// Which entry of which body a driver is; false: it moves an obstacle.
typedef struct Entry {
  const char *body, *list;
  int number;
} Entry;

static bool find_entry(const FemModel *model, const FemModelDriver *driver, Entry *entry) {
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemBodyDef *body = &model->scene->bodies[b];
    for (int i = 0; i < body->fixed_count + body->driven_count; i++) {
      bool is_fixed = i < body->fixed_count;
      int number = is_fixed ? i : i - body->fixed_count;
      if (driver->def != (is_fixed ? &body->fixed[number] : &body->driven[number])) continue;
      *entry = (Entry){model->bodies[b].name, is_fixed ? "fixed" : "driven", number};
      return true;
    }
  }
  return false;
}

bool fem_reactions_any(const FemModel *model) {
  Entry entry;
  for (int d = 0; d < model->driver_count; d++)
    if (find_entry(model, &model->drivers[d], &entry)) return true;
  return false;
}

Status fem_reactions_add_columns(FemHistory *history, const FemModel *model) {
  Entry entry;
  for (int d = 0; d < model->driver_count; d++) {
    if (!find_entry(model, &model->drivers[d], &entry)) continue;
    for (int c = 0; c < 3; c++)
      TRY(fem_history_add_column(history, "reaction_%s_%s_%d_%c_N", entry.body, entry.list, entry.number,
                                 "xyz"[c]));
  }
  return STATUS_OK;
}

Status fem_reactions_measure(FemSystem *system, const FemState *state, double **sums, double *at) {
  const FemModel *model = system->model;
  TRY(fem_system_forces_of_all(system, state));
  if (at) memset(at, 0, 3 * (size_t)model->vertex_count * sizeof *at);
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    Entry entry;
    if (!find_entry(model, driver, &entry)) continue;
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < driver->dof_count && !fem_model_is_released(driver, system->numbering.released);
         i++) {
      int dof = driver->dofs[i];
      sum[dof % 3] -= system->forces[dof];
      if (at) at[dof] = -system->forces[dof];
    }
    for (int c = 0; c < 3 && sums; c++) *(*sums)++ = sum[c];
  }
  return STATUS_OK;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/numbering.h"

#include <math.h>

#include "base/memory.h"

Status fem_numbering_create(FemNumbering *numbering, const FemModel *model) {
  size_t dofs = 3 * (size_t)model->vertex_count;
  *numbering = (FemNumbering){0};
  numbering->unknown_of_dof = memory_zeroed(dofs, sizeof *numbering->unknown_of_dof);
  numbering->dof_of_unknown = memory_zeroed(dofs, sizeof *numbering->dof_of_unknown);
  numbering->is_held = memory_zeroed((size_t)model->body_count, sizeof *numbering->is_held);
  if (!numbering->unknown_of_dof || !numbering->dof_of_unknown || !numbering->is_held)
    return status_no_memory("the numbering of the unknowns");
  fem_numbering_renew(numbering, model);
  return STATUS_OK;
}

void fem_numbering_destroy(FemNumbering *numbering) {
  memory_free(numbering->unknown_of_dof);
  memory_free(numbering->dof_of_unknown);
  memory_free(numbering->is_held);
  *numbering = (FemNumbering){0};
}

static void take_away(FemNumbering *numbering, const FemModel *model) {
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    for (int i = 0; i < driver->dof_count && !fem_model_is_released(driver, numbering->released); i++)
      numbering->unknown_of_dof[driver->dofs[i]] = -1;
  }
  for (int b = 0; b < model->body_count; b++)
    for (int dof = 3 * model->bodies[b].vertex_begin;
         dof < 3 * model->bodies[b].vertex_end && numbering->is_held[b]; dof++)
      numbering->unknown_of_dof[dof] = -1;
}

void fem_numbering_renew(FemNumbering *numbering, const FemModel *model) {
  int n = 0;
  for (int dof = 0; dof < 3 * model->vertex_count; dof++) numbering->unknown_of_dof[dof] = 0;
  take_away(numbering, model);
  for (int dof = 0; dof < 3 * model->vertex_count; dof++) {
    if (numbering->unknown_of_dof[dof] < 0) continue;
    numbering->unknown_of_dof[dof] = n;
    numbering->dof_of_unknown[n++] = dof;
  }
  numbering->count = n;
}

double fem_numbering_next_release(const FemModel *model, double time) {
  double next = INFINITY;
  for (int d = 0; d < model->driver_count; d++) {
    double release = model->drivers[d].def->release;
    if (release > time) next = fmin(next, release);
  }
  return next;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/numbering.h"

#include <math.h>

#include "base/memory.h"

void fem_model_numbering_renew(FemModel *model) {
  for (int dof = 0; dof < 3 * model->vertex_count; dof++) model->unknown_of_dof[dof] = 0;
  for (int d = 0; d < model->driver_count; d++)
    for (int i = 0; i < model->drivers[d].dof_count && !model->drivers[d].is_released; i++)
      model->unknown_of_dof[model->drivers[d].dofs[i]] = -1;
  for (int b = 0; b < model->body_count; b++)
    for (int v = model->bodies[b].vertex_begin; v < model->bodies[b].vertex_end && model->bodies[b].is_held;
         v++)
      for (int c = 0; c < 3; c++) model->unknown_of_dof[3 * v + c] = -1;
  int n = 0;
  for (int dof = 0; dof < 3 * model->vertex_count; dof++) {
    if (model->unknown_of_dof[dof] < 0) continue;
    model->unknown_of_dof[dof] = n;
    model->dof_of_unknown[n++] = dof;
  }
  model->unknown_count = n;
}

Status fem_model_numbering_copy(FemModel *copy, const FemModel *model) {
  size_t dofs = 3 * (size_t)model->vertex_count;
  *copy = *model;
  copy->bodies = memory_copy(model->bodies, (size_t)model->body_count, sizeof *model->bodies);
  copy->drivers = memory_copy(model->drivers, (size_t)model->driver_count, sizeof *model->drivers);
  copy->unknown_of_dof = memory_copy(model->unknown_of_dof, dofs, sizeof *model->unknown_of_dof);
  copy->dof_of_unknown = memory_copy(model->dof_of_unknown, dofs, sizeof *model->dof_of_unknown);
  if (copy->bodies && copy->drivers && copy->unknown_of_dof && copy->dof_of_unknown) return STATUS_OK;
  fem_model_numbering_destroy_copy(copy);
  return status_no_memory("the numbering of the unknowns");
}

void fem_model_numbering_destroy_copy(FemModel *copy) {
  memory_free(copy->bodies);
  memory_free(copy->drivers);
  memory_free(copy->unknown_of_dof);
  memory_free(copy->dof_of_unknown);
  *copy = (FemModel){0};
}

double fem_model_numbering_next_release(const FemModel *model, double time) {
  double next = INFINITY;
  for (int d = 0; d < model->driver_count; d++) {
    double release = model->drivers[d].def->release;
    if (release > time) next = fmin(next, release);
  }
  return next;
}

void fem_model_numbering_release(FemModel *model, double time) {
  for (int d = 0; d < model->driver_count; d++) {
    double release = model->drivers[d].def->release;
    if (release > 0 && release <= time) model->drivers[d].is_released = true;
  }
  fem_model_numbering_renew(model);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/hold.h"

#include "fem/model/numbering.h"

void fem_hold_gather(const FemSystem *system, double *u, double *v) {
  const FemModel *model = system->model;
  for (int i = 0; i < model->unknown_count; i++) {
    int dof = model->dof_of_unknown[i];
    u[i] = system->positions[dof] - model->rest[dof];
    v[i] = system->velocities[dof];
  }
}

// Stops a body; returns the kinetic energy that its unknowns had.
static double stop_body(const FemModel *model, const FemModelBody *body, double *velocities) {
  double energy = 0;
  for (int dof = 3 * body->vertex_begin; dof < 3 * body->vertex_end; dof++) {
    if (model->unknown_of_dof[dof] < 0) continue;
    energy += 0.5 * model->mass[dof / 3] * velocities[dof] * velocities[dof];
    velocities[dof] = 0;
  }
  return energy;
}

Status fem_hold_sleepers(FemModel *model, FemSystem *system, FemRest *rest, double *u, double *v) {
  for (int b = 0; b < model->body_count; b++) {
    bool is_asleep = fem_rest_is_asleep(rest, b);
    if (is_asleep) fem_rest_add_loss(rest, stop_body(model, &model->bodies[b], system->velocities));
    model->bodies[b].is_held = is_asleep;
  }
  fem_model_numbering_renew(model);
  fem_hold_gather(system, u, v);
  return model->unknown_count > 0 ? fem_system_renumber(system) : STATUS_OK;
}

Status fem_hold_renumber(FemModel *model, FemSystem *system, FemRest *rest, double time, FemAudit *audit,
                         double *u, double *v) {
  FemEnergy before, after;
  fem_system_scatter(system, time, u, v);
  TRY(fem_system_energy(system, time, &before));
  fem_model_numbering_release(model, time);
  TRY(fem_system_energy(system, time, &after));
  fem_audit_release(audit, after.kinetic - before.kinetic);
  return fem_hold_sleepers(model, system, rest, u, v);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/hold.h"

#include "fem/model/numbering.h"

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

Status fem_hold_sleepers(FemModel *model, FemSystem *system, FemRest *rest, FemState *state, double *u,
                         double *v) {
  for (int b = 0; b < model->body_count; b++) {
    bool is_asleep = fem_rest_is_asleep(rest, b);
    if (is_asleep) fem_rest_add_loss(rest, stop_body(model, &model->bodies[b], state->velocities));
    model->bodies[b].is_held = is_asleep;
  }
  fem_model_numbering_renew(model);
  fem_system_gather(system, state, u, v);
  return model->unknown_count > 0 ? fem_system_renumber(system) : STATUS_OK;
}

Status fem_hold_renumber(FemModel *model, FemSystem *system, FemRest *rest, FemState *state, FemAudit *audit,
                         double *u, double *v) {
  FemEnergy before, after;
  TRY(fem_system_energy(system, state, &before));
  fem_model_numbering_release(model, state->time);
  TRY(fem_system_energy(system, state, &after));
  fem_audit_release(audit, after.kinetic - before.kinetic);
  return fem_hold_sleepers(model, system, rest, state, u, v);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/rest/hold.h"

#include "fem/effect/system_energy.h"

// Stops a body; returns the kinetic energy that its unknowns had.
static double stop_body(const FemSystem *system, const FemModelBody *body, double *velocities) {
  double energy = 0;
  for (int dof = 3 * body->vertex_begin; dof < 3 * body->vertex_end; dof++) {
    if (system->numbering.unknown_of_dof[dof] < 0) continue;
    energy += 0.5 * system->model->mass[dof / 3] * velocities[dof] * velocities[dof];
    velocities[dof] = 0;
  }
  return energy;
}

Status fem_hold_sleepers(FemSystem *system, FemRest *rest, FemState *state, double *u, double *v) {
  const FemModel *model = system->model;
  for (int b = 0; b < model->body_count; b++) {
    bool is_asleep = fem_rest_is_asleep(rest, b);
    if (is_asleep) fem_rest_add_loss(rest, stop_body(system, &model->bodies[b], state->velocities));
    system->numbering.is_held[b] = is_asleep;
  }
  fem_numbering_renew(&system->numbering, model);
  fem_system_gather(system, state, u, v);
  return fem_system_renumber(system);
}

Status fem_hold_renumber(FemSystem *system, FemRest *rest, FemState *state, FemAudit *audit, double *u,
                         double *v) {
  FemEnergy before, after;
  TRY(fem_system_energy(system, state, &before));
  system->numbering.released = state->time;
  fem_numbering_renew(&system->numbering, system->model);
  TRY(fem_system_energy(system, state, &after));
  fem_audit_release(audit, after.kinetic - before.kinetic);
  return fem_hold_sleepers(system, rest, state, u, v);
}

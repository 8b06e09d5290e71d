// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/checkpoint/restart.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"

Status fem_restart_begin(FemCheckpoint *checkpoint, const FemModel *model, const double *displacement) {
  TRY(fem_checkpoint_create(checkpoint, model->vertex_count));
  size_t bytes = 3 * (size_t)model->vertex_count * sizeof(double);
  memcpy(checkpoint->velocity, model->initial_velocity, bytes);
  if (displacement) memcpy(checkpoint->displacement, displacement, bytes);
  return STATUS_OK;
}

static Status save_effect(FemCheckpointEffect *saved, const FemEffect *effect,
                          const FemEffectHistory *history) {
  snprintf(saved->name, sizeof saved->name, "%s", effect->ops->name);
  saved->count = history->count;
  saved->values = memory_copy(history->values, history->count, sizeof *history->values);
  return saved->values ? STATUS_OK : status_no_memory("a checkpoint");
}

static Status save_effects(FemCheckpoint *checkpoint, const FemSystem *system) {
  for (int i = 0; i < system->effect_count; i++) {
    TRY(save_effect(&checkpoint->effects[i], &system->effects[i], &system->accepted.histories[i]));
    checkpoint->effect_count++;
  }
  return STATUS_OK;
}

// Driven coordinates as the state has them, for whoever reads the file; unknowns as they are, which adding
// and subtracting the place at rest would round.
static void save_state(FemCheckpoint *checkpoint, const FemSystem *system, const FemState *state,
                       const double *u, const double *v) {
  for (int i = 0; i < 3 * system->model->vertex_count; i++) {
    int unknown = system->numbering.unknown_of_dof[i];
    checkpoint->displacement[i] = unknown < 0 ? state->positions[i] - system->model->rest[i] : u[unknown];
    checkpoint->velocity[i] = unknown < 0 ? state->velocities[i] : v[unknown];
  }
  checkpoint->time = state->time;
}

// Numbers, and a copy of the counters.
static Status save_counts(FemCheckpoint *checkpoint, const FemRunResult *so_far) {
  record_destroy(checkpoint->so_far.counters);
  checkpoint->so_far = *so_far;
  checkpoint->so_far.account = (FemRunAccount){0};
  checkpoint->so_far.trajectory = (FemRunTrajectory){0};
  checkpoint->so_far.counters = record_new();
  if (!checkpoint->so_far.counters) return status_no_memory("a checkpoint");
  record_merge(checkpoint->so_far.counters, so_far->counters);
  return STATUS_OK;
}

Status fem_restart_collect(FemCheckpoint *checkpoint, const FemSystem *system, const FemState *state,
                           const double *u, const double *v, const FemRunResult *so_far) {
  TRY(fem_checkpoint_create(checkpoint, system->model->vertex_count));
  save_state(checkpoint, system, state, u, v);
  Status status = save_effects(checkpoint, system);
  if (!status) status = save_counts(checkpoint, so_far);
  if (status) fem_checkpoint_destroy(checkpoint);
  return status;
}

Status fem_restart_check(const FemCheckpoint *checkpoint, const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (checkpoint->vertex_count != model->vertex_count)
    return status_fail(STATUS_INPUT, "the checkpoint is of a scene with %d vertices, this one has %d",
                       checkpoint->vertex_count, model->vertex_count);
  if (checkpoint->next_frame > scene->frames || !(checkpoint->time < scene->end))
    return status_fail(STATUS_INPUT, "the checkpoint, at t = %g s, lies at or beyond the end of the scene",
                       checkpoint->time);
  return STATUS_OK;
}

void fem_restart_load(const FemCheckpoint *checkpoint, const FemNumbering *numbering, double *u, double *v) {
  for (int i = 0; i < numbering->count; i++) {
    u[i] = checkpoint->displacement[numbering->dof_of_unknown[i]];
    v[i] = checkpoint->velocity[numbering->dof_of_unknown[i]];
  }
}

static Status remember(const FemCheckpointEffect *saved, FemSystem *system, int place) {
  const char *name = system->effects[place].ops->name;
  if (strcmp(saved->name, name) != 0)
    return status_fail(STATUS_INPUT, "the checkpoint has the effect '%s' where this scene has '%s'",
                       saved->name, name);
  return fem_system_remember(system, place, saved->values, saved->count);
}

Status fem_restart_remember(const FemCheckpoint *checkpoint, FemSystem *system) {
  if (checkpoint->next_frame == 0) return STATUS_OK; // a beginning
  if (checkpoint->effect_count != system->effect_count)
    return status_fail(STATUS_INPUT, "the checkpoint has %d effects, this scene has %d",
                       checkpoint->effect_count, system->effect_count);
  for (int i = 0; i < system->effect_count; i++) TRY(remember(&checkpoint->effects[i], system, i));
  return STATUS_OK;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/checkpoint/restart.h"

#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "contact/friction/stick_history.h"
#include "fem/effect/contact/contact.h"

static Status copy_text(char **copy, const char *text) {
  memory_free(*copy);
  *copy = memory_copy(text, strlen(text) + 1, 1);
  return *copy ? STATUS_OK : status_no_memory("a checkpoint");
}

static Status begin_histories(FemCheckpoint *checkpoint, const FemStart *start) {
  for (int i = 0; i < start->history_count; i++) {
    const FemStartHistory *history = &start->histories[i];
    FemCheckpointEffect *saved = &checkpoint->effects[checkpoint->effect_count];
    snprintf(saved->name, sizeof saved->name, "%s", history->effect);
    saved->count = history->count;
    saved->values = memory_copy(history->values, history->count, sizeof *history->values);
    if (!saved->values) return status_no_memory("a checkpoint");
    checkpoint->effect_count++;
  }
  return copy_text(&checkpoint->interfaces, start->interfaces);
}

Status fem_restart_begin(FemCheckpoint *checkpoint, const FemModel *model, const double *displacement) {
  TRY(fem_checkpoint_create(checkpoint, model->vertex_count));
  size_t bytes = 3 * (size_t)model->vertex_count * sizeof(double);
  memcpy(checkpoint->velocity, model->initial_velocity, bytes);
  const double *begin = displacement || !model->start ? displacement : model->start->displacement;
  if (begin) memcpy(checkpoint->displacement, begin, bytes);
  return model->start ? begin_histories(checkpoint, model->start) : STATUS_OK;
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

static int interface_count(const FemSystem *system) {
  void *contact = fem_system_effect(system, &fem_effect_contact);
  return contact ? contact_system_layout(fem_effect_contact_system(contact))->interface_count : 0;
}

// "A, B" and its end.
static void name_interface(const FemSystem *system, int i, char *text, size_t size) {
  void *contact = fem_system_effect(system, &fem_effect_contact);
  const ContactInterfaceDef *def = &contact_system_layout(fem_effect_contact_system(contact))->interfaces[i];
  snprintf(text, size, "%s, %s\n", fem_effect_contact_name(contact, def->a),
           fem_effect_contact_name(contact, def->b));
}

enum { INTERFACE_NAME = 512 };

static Status save_interfaces(FemCheckpoint *checkpoint, const FemSystem *system) {
  const int count = interface_count(system);
  const size_t size = (size_t)count * INTERFACE_NAME + 1;
  char name[INTERFACE_NAME], *text = memory_zeroed(size, 1);
  if (!text) return status_no_memory("a checkpoint");
  size_t used = 0;
  for (int i = 0; i < count; i++) {
    name_interface(system, i, name, sizeof name);
    text_append(text, size, &used, "%s", name);
  }
  Status status = copy_text(&checkpoint->interfaces, text);
  memory_free(text);
  return status;
}

// Driven coordinates as the state has them, for those who read the file; unknowns as they are, which adding
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
  if (!status) status = save_interfaces(checkpoint, system);
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

// The number that the interface called so has in this system; −1: it has none.
static int find_interface(const FemSystem *system, const char *line, size_t length) {
  char name[INTERFACE_NAME];
  for (int i = 0; i < interface_count(system); i++) {
    name_interface(system, i, name, sizeof name);
    if (strlen(name) == length && strncmp(name, line, length) == 0) return i;
  }
  return -1;
}

// The number here of each interface of another scene, −1: none; owned by the caller. NULL: no memory.
static int *match_interfaces(const FemCheckpoint *checkpoint, const FemSystem *system, int *count) {
  *count = 0;
  for (const char *c = checkpoint->interfaces; *c; c++) *count += *c == '\n';
  int *numbers = memory_zeroed((size_t)*count, sizeof *numbers);
  const char *line = checkpoint->interfaces;
  for (int i = 0; numbers && i < *count; i++) {
    size_t length = strcspn(line, "\n") + 1;
    numbers[i] = find_interface(system, line, length);
    line += length;
  }
  return numbers;
}

// The entries of vertices whose interface is there in this scene, too; what was slid and dissipated counts
// anew.
static Status remember_stick(const FemCheckpoint *checkpoint, const FemCheckpointEffect *saved,
                             FemSystem *system, int place) {
  int was_count, is_count = interface_count(system), kept = 0;
  int *numbers = match_interfaces(checkpoint, system, &was_count);
  if (!numbers) return status_no_memory("friction");
  Status status =
      contact_stick_history_check(was_count, checkpoint->vertex_count, saved->values, saved->count);
  if (status) {
    memory_free(numbers);
    return status;
  }
  const ContactStickHistory was = contact_stick_history_view(was_count, saved->values, saved->count);
  for (int e = 0; e < was.entry_count; e++) kept += numbers[(int)was.entries[e].interface] >= 0;
  const size_t count = contact_stick_history_count(is_count, kept);
  double *values = memory_zeroed(count, sizeof *values);
  if (values) {
    ContactStickHistory is = contact_stick_history_view(is_count, values, count);
    for (int e = 0, k = 0; e < was.entry_count; e++) {
      const int number = numbers[(int)was.entries[e].interface];
      if (number < 0) continue;
      is.entries[k] = was.entries[e];
      is.entries[k].interface = number;
      is.entries[k].way = is.entries[k].work = 0;
      k++;
    }
    contact_stick_history_sort(&is);
  }
  status = values ? fem_system_remember(system, place, values, count) : status_no_memory("friction");
  memory_free(values);
  memory_free(numbers);
  return status;
}

static Status remember_start(const FemCheckpoint *checkpoint, FemSystem *system) {
  for (int k = 0; k < checkpoint->effect_count; k++) {
    const FemCheckpointEffect *saved = &checkpoint->effects[k];
    for (int i = 0; i < system->effect_count; i++) {
      if (strcmp(saved->name, system->effects[i].ops->name) != 0) continue;
      TRY(system->effects[i].ops == &fem_effect_stick
              ? remember_stick(checkpoint, saved, system, i)
              : fem_system_remember(system, i, saved->values, saved->count));
    }
  }
  return STATUS_OK;
}

Status fem_restart_remember(const FemCheckpoint *checkpoint, FemSystem *system) {
  if (checkpoint->next_frame == 0) return remember_start(checkpoint, system);
  if (checkpoint->effect_count != system->effect_count)
    return status_fail(STATUS_INPUT, "the checkpoint has %d effects, this scene has %d",
                       checkpoint->effect_count, system->effect_count);
  for (int i = 0; i < system->effect_count; i++) TRY(remember(&checkpoint->effects[i], system, i));
  return STATUS_OK;
}

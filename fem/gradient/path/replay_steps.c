// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/replay_steps.h"

#include "base/memory.h"

// Of a step: u, v and histories; of a static scene, where it is looked for.
static size_t bytes_of(const FemSystem *system) {
  size_t numbers = (system->model->scene->is_static ? 3 : 2) * (size_t)system->numbering.count;
  for (int e = 0; e < system->effect_count; e++) numbers += system->accepted.histories[e].count;
  return numbers * sizeof(double) + (size_t)system->effect_count * sizeof(FemEffectHistory);
}

// Of the lists of steps, with the room that they have grown to.
static size_t bytes_of_lists(const FemReplaySteps *steps) {
  return steps->time_capacity * sizeof *steps->times + steps->capacity * sizeof *steps->u;
}

static Status reserve(FemReplaySteps *steps, size_t n, bool is_static) {
  size_t count = (size_t)steps->count;
  bool fits = memory_reserve((void **)&steps->times, &steps->time_capacity, count + 1, sizeof *steps->times);
  if (is_static) {
    fits = fits && memory_reserve((void **)&steps->u, &steps->capacity, count + 1, sizeof *steps->u);
    fits = fits && (steps->u[count] = memory_zeroed(n, sizeof **steps->u));
  }
  return fits ? STATUS_OK : status_no_memory("the steps of a run");
}

static Status add(FemReplaySteps *steps, const FemSystem *system, const FemState *state) {
  size_t n = (size_t)system->numbering.count, bytes = bytes_of(system), lists = bytes_of_lists(steps);
  bool is_static = system->model->scene->is_static;
  TRY(reserve(steps, n, is_static));
  for (size_t i = 0; i < n && is_static && state; i++) {
    int dof = system->numbering.dof_of_unknown[i];
    steps->u[steps->count][i] = state->positions[dof] - system->model->rest[dof];
  }
  steps->unknown_count = (int)n;
  steps->times[steps->count++] = state ? state->time : 0;
  steps->bytes += bytes + bytes_of_lists(steps) - lists;
  if (bytes > steps->largest) steps->largest = bytes;
  return STATUS_OK;
}

Status fem_replay_steps_add(FemReplaySteps *steps, const FemSystem *system) {
  if (steps->count == 0) TRY(add(steps, system, NULL));
  bool is_new = system->accepted.time > steps->times[steps->count - 1];
  return is_new ? add(steps, system, &system->accepted) : STATUS_OK;
}

void fem_replay_steps_destroy(FemReplaySteps *steps) {
  for (int k = 0; steps->u && k < steps->count; k++) memory_free(steps->u[k]);
  memory_free(steps->times);
  memory_free(steps->u);
  *steps = (FemReplaySteps){0};
}

// ---- Segments.

static FemReplayPlan plan_with(const FemReplaySteps *steps, int length) {
  int count = (steps->count - 2) / length + 1;
  size_t found = steps->u ? (size_t)steps->unknown_count * sizeof(double) : 0;
  size_t step = steps->largest - found, places = 2 * sizeof(double) * (size_t)steps->unknown_count;
  size_t begin = FEM_REPLAY_LEAD * places + (step - places); // where a segment begins, with its history
  size_t kept = (size_t)length * step + FEM_REPLAY_LEAD * places + (size_t)count * begin;
  return (FemReplayPlan){length, count, kept + (size_t)steps->count * found + bytes_of_lists(steps), 0};
}

FemReplayPlan fem_replay_steps_plan(const FemReplaySteps *steps) {
  FemReplayPlan plan = {steps->count - 1, 1, steps->bytes, steps->bytes}, found = {0};
  if (steps->most == 0 || steps->bytes <= steps->most) return plan;
  size_t least = steps->bytes;
  for (int length = FEM_REPLAY_BLOCK; length < steps->count - 1; length += FEM_REPLAY_BLOCK) {
    plan = plan_with(steps, length);
    if (plan.bytes <= steps->most) found = plan;
    if (plan.bytes < least) least = plan.bytes;
  }
  found.least = least;
  return found;
}

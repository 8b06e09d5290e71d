// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/state.h"

#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"

Status fem_state_create(FemState *state, int vertex_count, const double *positions,
                        const double *velocities) {
  size_t values = 3 * (size_t)vertex_count;
  *state = (FemState){.last = state, .version = fem_state_new_version()};
  state->positions = memory_copy(positions, values, sizeof *positions);
  state->velocities = memory_copy(velocities, values, sizeof *velocities);
  return state->positions && state->velocities ? STATUS_OK : status_no_memory("the state");
}

void fem_state_destroy(FemState *state) {
  memory_free(state->positions);
  memory_free(state->velocities);
  for (int i = 0; i < FEM_MAX_EFFECTS; i++) fem_effect_history_destroy(&state->histories[i]);
  *state = (FemState){0};
}

long long fem_state_new_version(void) {
  static atomic_llong count;
  return ++count;
}

FemState fem_state_beside(const FemState *state, double time) {
  FemState beside = *state;
  if (time != state->time) beside.version = fem_state_new_version();
  beside.time = time;
  return beside;
}

Status fem_effect_history_resize(FemEffectHistory *history, size_t count) {
  if (!memory_reserve((void **)&history->values, &history->capacity, count, sizeof *history->values))
    return status_no_memory("what an effect remembers");
  history->count = count;
  return STATUS_OK;
}

Status fem_effect_history_set(FemEffectHistory *history, const double *values, size_t count) {
  TRY(fem_effect_history_resize(history, count));
  if (count > 0) memcpy(history->values, values, count * sizeof *values);
  return STATUS_OK;
}

void fem_effect_history_destroy(FemEffectHistory *history) {
  memory_free(history->values);
  *history = (FemEffectHistory){0};
}

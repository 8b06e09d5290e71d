// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/checkpoint/checkpoint.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

Status fem_checkpoint_create(FemCheckpoint *checkpoint, int vertex_count) {
  *checkpoint = (FemCheckpoint){.vertex_count = vertex_count, .so_far.min_det_F = INFINITY};
  size_t values = 3 * (size_t)vertex_count;
  checkpoint->displacement = memory_zeroed(values, sizeof(double));
  checkpoint->velocity = memory_zeroed(values, sizeof(double));
  checkpoint->ledger = memory_zeroed(0, sizeof(double));
  checkpoint->rest = memory_zeroed(0, sizeof(double));
  checkpoint->interfaces = memory_zeroed(1, 1);
  checkpoint->so_far.counters = record_new();
  if (checkpoint->displacement && checkpoint->velocity && checkpoint->ledger && checkpoint->rest &&
      checkpoint->interfaces && checkpoint->so_far.counters)
    return STATUS_OK;
  fem_checkpoint_destroy(checkpoint);
  return status_no_memory("a checkpoint");
}

static bool copy_text(char **copy, const char *text) {
  *copy = text ? memory_copy(text, strlen(text) + 1, 1) : NULL;
  return !text || *copy;
}

static bool copy_effects(FemCheckpoint *copy, const FemCheckpoint *checkpoint) {
  for (; copy->effect_count < checkpoint->effect_count; copy->effect_count++) {
    FemCheckpointEffect *effect = &copy->effects[copy->effect_count];
    *effect = checkpoint->effects[copy->effect_count];
    effect->values = memory_copy(effect->values, effect->count, sizeof(double));
    if (!effect->values) return false;
  }
  return true;
}

Status fem_checkpoint_copy(FemCheckpoint *copy, const FemCheckpoint *checkpoint) {
  size_t values = 3 * (size_t)checkpoint->vertex_count;
  *copy = *checkpoint;
  copy->origin = copy->interfaces = NULL;
  copy->effect_count = 0;
  copy->ledger = memory_copy(checkpoint->ledger, checkpoint->ledger_count, sizeof(double));
  copy->rest = memory_copy(checkpoint->rest, checkpoint->rest_count, sizeof(double));
  copy->displacement = memory_copy(checkpoint->displacement, values, sizeof(double));
  copy->velocity = memory_copy(checkpoint->velocity, values, sizeof(double));
  copy->so_far.counters = record_new();
  record_merge(copy->so_far.counters, checkpoint->so_far.counters);
  if (copy->displacement && copy->velocity && copy->ledger && copy->rest && copy->so_far.counters &&
      copy_text(&copy->origin, checkpoint->origin) && copy_text(&copy->interfaces, checkpoint->interfaces) &&
      copy_effects(copy, checkpoint))
    return STATUS_OK;
  fem_checkpoint_destroy(copy);
  return status_no_memory("a checkpoint");
}

void fem_checkpoint_destroy(FemCheckpoint *checkpoint) {
  memory_free(checkpoint->origin);
  memory_free(checkpoint->interfaces);
  memory_free(checkpoint->displacement);
  memory_free(checkpoint->velocity);
  memory_free(checkpoint->ledger);
  memory_free(checkpoint->rest);
  if (checkpoint->so_far.counters) record_destroy(checkpoint->so_far.counters);
  for (int i = 0; i < checkpoint->effect_count; i++) memory_free(checkpoint->effects[i].values);
  *checkpoint = (FemCheckpoint){0};
}

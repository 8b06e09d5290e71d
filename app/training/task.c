// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/task.h"

#include <stdio.h>

#include "base/memory.h"

const AppTrainingTaskOps *app_training_task_find(AppModelKind kind) {
  static const AppTrainingTaskOps *const tasks[] = {[APP_MODEL_GEO] = &app_training_geo,
                                                    [APP_MODEL_TPN] = &app_training_tpn,
                                                    [APP_MODEL_BOUND] = &app_training_bound};
  return tasks[kind];
}

void app_training_scores_add(AppTrainingScores *scores, const char *set, const char *name, double value) {
  if (scores->count == APP_TRAINING_MAX_SCORES) return;
  snprintf(scores->names[scores->count], APP_TRAINING_SCORE_NAME, "%.19s.%.19s", set, name);
  scores->values[scores->count++] = value;
}

Status app_training_task_fail(NetStatus status) {
  if (status == NET_OK) return STATUS_OK;
  Status code = status == NET_NO_MEMORY ? STATUS_MEMORY : status == NET_BAD_IO ? STATUS_IO : STATUS_INPUT;
  return status_fail(code, "%s", net_status_message());
}

Status app_training_order_create(AppTrainingOrder *order, int count) {
  *order = (AppTrainingOrder){.count = count, .epoch = -1};
  order->order = memory_zeroed((size_t)count, sizeof *order->order);
  return order->order ? STATUS_OK : status_no_memory("the order of samples");
}

void app_training_order_destroy(AppTrainingOrder *order) {
  memory_free(order->order);
  *order = (AppTrainingOrder){0};
}

static void shuffle(AppTrainingOrder *order, int seed, long long epoch) {
  NetRandom random = net_random_seeded((uint64_t)seed, 2 * (uint64_t)epoch);
  for (int i = 0; i < order->count; i++) order->order[i] = i;
  net_random_shuffle(&random, order->count, order->order);
  order->epoch = epoch;
}

void app_training_order_take(AppTrainingOrder *order, int seed, long long step, int batch, int *samples) {
  long long place = step * batch;
  for (int k = 0; k < batch; k++, place++) {
    if (place / order->count != order->epoch) shuffle(order, seed, place / order->count);
    samples[k] = order->order[place % order->count];
  }
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/start.h"

#include "base/memory.h"

void fem_model_start_destroy(FemStart *start) {
  if (!start) return;
  memory_free(start->displacement);
  memory_free(start->positions);
  memory_free(start->interfaces);
  for (int i = 0; i < start->history_count; i++) memory_free(start->histories[i].values);
  memory_free(start);
}

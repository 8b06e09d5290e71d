// SPDX-License-Identifier: Apache-2.0
#include "base/ranks.h"

static void sum(double *values, size_t count) {
  (void)values, (void)count;
}

static void join(void *items, size_t size, const int *begin) {
  (void)items, (void)size, (void)begin;
}

static void tell(void *bytes, size_t size) {
  (void)bytes, (void)size;
}

static Status worst(Status status) {
  return status;
}

static Status divide(const RanksGraph *graph, int rank_count, int *rank_of_node) {
  (void)rank_count;
  for (int i = 0; i < graph->node_count; i++) rank_of_node[i] = 0;
  return STATUS_OK;
}

static const RanksStats nothing;

static const RanksStats *stats(void) {
  return &nothing;
}

static const Ranks alone = {.count = 1,
                            .sum = sum,
                            .most = sum,
                            .join = join,
                            .tell = tell,
                            .worst = worst,
                            .divide = divide,
                            .stats = stats};

static const Ranks *current = &alone;

const Ranks *ranks(void) {
  return current;
}

void ranks_set(const Ranks *table) {
  current = table ? table : &alone;
}

bool ranks_is_first(void) {
  return current->number == 0;
}

bool ranks_any(bool is_so) {
  double value = is_so;
  current->most(&value, 1);
  return value > 0;
}

const int *ranks_split(int count) {
  static int begin[RANKS_MOST + 1];
  for (int r = 0; r <= current->count; r++) begin[r] = (int)((long long)count * r / current->count);
  return begin;
}

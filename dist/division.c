// SPDX-License-Identifier: GPL-3.0-or-later
#include "dist/division.h"

#include <assert.h>
#include <metis.h>

static_assert(sizeof(idx_t) == sizeof(int), "METIS numbers nodes by int");

Status dist_division_divide(const RanksGraph *graph, int rank_count, int *rank_of_node) {
  idx_t nodes = graph->node_count, weights = 1, parts = rank_count, cut, options[METIS_NOPTIONS];
  for (int i = 0; i < graph->node_count; i++) rank_of_node[i] = i % rank_count;
  if (nodes <= rank_count) return STATUS_OK; // some ranks have none
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  int answer = METIS_PartGraphKway(&nodes, &weights, graph->begin, graph->neighbour, NULL, NULL, NULL, &parts,
                                   NULL, NULL, options, &cut, rank_of_node);
  if (answer == METIS_OK) return STATUS_OK;
  if (answer == METIS_ERROR_MEMORY) return status_no_memory("the division of the mesh among ranks");
  return status_fail(STATUS_SOLVER, "METIS could not divide the mesh among %d ranks", rank_count);
}

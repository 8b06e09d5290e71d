// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/division.h"

#include "base/memory.h"
#include "base/ranks.h"
#include "fem/sparse/pattern.h"

// Vertices of bodies come first.
static int elastic_vertices(const FemModel *model) {
  return model->bodies[model->scene->body_count - 1].vertex_end;
}

static int elastic_tets(const FemModel *model) {
  return model->bodies[model->scene->body_count - 1].tet_end;
}

static Status couple(const FemModel *model, FemPattern *pattern) {
  int tets = elastic_tets(model);
  for (int e = 0; e < tets; e++)
    if (model->bodies[model->tet_body[e]].element != FEM_ELEMENT_QUADRATIC)
      TRY(fem_pattern_add_clique(pattern, 4, model->tets[e], NULL));
  for (int e = 0; e < model->quadratic_count; e++)
    TRY(fem_pattern_add_clique(pattern, FEM_QUADRATIC_NODES, model->quadratic_nodes[e], NULL));
  return STATUS_OK;
}

// The pattern's edges both ways; neighbours of a node in ascending order.
static Status make_graph(const FemPattern *pattern, RanksGraph *graph) {
  int nodes = graph->node_count = fem_pattern_vertex_count(pattern), count;
  graph->begin = memory_zeroed((size_t)nodes + 2, sizeof *graph->begin);
  if (!graph->begin) return status_no_memory("the graph of the mesh");
  int *next = graph->begin + 1; // pushed on to where the next node begins
  for (int v = 0; v < nodes; v++) {
    const int *above = fem_pattern_above(pattern, v, &count);
    next[v + 1] += count;
    for (int k = 0; k < count; k++) next[above[k] + 1]++;
  }
  for (int v = 0; v < nodes; v++) next[v + 1] += next[v];
  graph->neighbour = memory_zeroed((size_t)next[nodes], sizeof *graph->neighbour);
  if (!graph->neighbour) return status_no_memory("the graph of the mesh");
  for (int v = 0; v < nodes; v++) {
    const int *above = fem_pattern_above(pattern, v, &count);
    for (int k = 0; k < count; k++) {
      graph->neighbour[next[v]++] = above[k];
      graph->neighbour[next[above[k]]++] = v;
    }
  }
  return STATUS_OK;
}

static Status divide(const FemModel *model, int *owner) {
  FemPattern *pattern = NULL;
  RanksGraph graph = {0};
  Status status = fem_pattern_create(&pattern, elastic_vertices(model));
  if (!status) status = couple(model, pattern);
  if (!status) status = make_graph(pattern, &graph);
  if (!status) status = ranks()->divide(&graph, ranks()->count, owner);
  fem_pattern_destroy(pattern);
  memory_free(graph.begin);
  memory_free(graph.neighbour);
  return status;
}

Status fem_model_divide(FemModel *model) {
  if (ranks()->count == 1) return STATUS_OK;
  FemShare *share = model->share = memory_zeroed(1, sizeof *share);
  if (share) share->owner = memory_zeroed((size_t)model->vertex_count, sizeof *share->owner);
  Status status = share && share->owner ? STATUS_OK : status_no_memory("the division among ranks");
  TRY(ranks()->worst(status));
  share->rank = ranks()->number;
  share->rank_count = ranks()->count;
  if (ranks_is_first()) status = divide(model, share->owner);
  TRY(ranks()->worst(status));
  ranks()->tell(share->owner, (size_t)model->vertex_count * sizeof *share->owner);
  return STATUS_OK;
}

void fem_model_division_destroy(FemModel *model) {
  if (model->share) memory_free(model->share->owner);
  memory_free(model->share);
  model->share = NULL;
}

int fem_model_division_elements(const FemModel *model) {
  int count = 0, tets = elastic_tets(model);
  for (int e = 0; e < tets; e++)
    count += model->bodies[model->tet_body[e]].element != FEM_ELEMENT_QUADRATIC &&
             fem_share_has(model->share, 4, model->tets[e]);
  for (int e = 0; e < model->quadratic_count; e++)
    count += fem_share_has(model->share, FEM_QUADRATIC_NODES, model->quadratic_nodes[e]);
  return count;
}

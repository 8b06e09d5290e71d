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

// The rank of each vertex among so many ranks; obstacles' the first: owner (model->vertex_count).
static Status find_owners(const FemModel *model, int rank_count, int *owner) {
  FemPattern *pattern = NULL;
  for (int v = 0; v < model->vertex_count; v++) owner[v] = 0;
  RanksGraph graph = {0};
  Status status = fem_pattern_create(&pattern, elastic_vertices(model));
  if (!status) status = couple(model, pattern);
  if (!status) status = make_graph(pattern, &graph);
  if (!status) status = ranks()->divide(&graph, rank_count, owner);
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
  if (ranks_is_first()) status = find_owners(model, share->rank_count, share->owner);
  TRY(ranks()->worst(status));
  ranks()->tell(share->owner, (size_t)model->vertex_count * sizeof *share->owner);
  return STATUS_OK;
}

void fem_model_division_destroy(FemModel *model) {
  if (model->share) memory_free(model->share->owner);
  memory_free(model->share);
  model->share = NULL;
}

// What `share` has; *copies: vertices of its elements that are others', marked in `seen` by its rank + 1.
static int count_elements(const FemModel *model, const FemShare *share, int *seen, int *copies) {
  int count = 0, tets = elastic_tets(model);
  for (int e = 0; e < tets + model->quadratic_count; e++) {
    bool is_linear = e < tets;
    if (is_linear && model->bodies[model->tet_body[e]].element == FEM_ELEMENT_QUADRATIC) continue;
    const int *nodes = is_linear ? model->tets[e] : model->quadratic_nodes[e - tets];
    int node_count = is_linear ? 4 : FEM_QUADRATIC_NODES;
    if (!fem_share_has(share, node_count, nodes)) continue;
    count++;
    for (int k = 0; k < node_count && seen; k++) {
      if (share->owner[nodes[k]] == share->rank || seen[nodes[k]] == share->rank + 1) continue;
      seen[nodes[k]] = share->rank + 1;
      ++*copies;
    }
  }
  return count;
}

int fem_model_division_elements(const FemModel *model) {
  return count_elements(model, model->share, NULL, NULL);
}

static void widen(int range[2], int value, bool is_first) {
  if (is_first || value < range[0]) range[0] = value;
  if (is_first || value > range[1]) range[1] = value;
}

static void make_plan(const FemModel *model, FemShare *share, int *seen, FemDivisionPlan *plan) {
  for (share->rank = 0; share->rank < share->rank_count; share->rank++) {
    int vertices = 0, copies = 0;
    for (int v = 0; v < elastic_vertices(model); v++) vertices += share->owner[v] == share->rank;
    int elements = count_elements(model, share, seen, &copies);
    widen(plan->vertices, vertices, share->rank == 0);
    widen(plan->elements, elements, share->rank == 0);
    widen(plan->copies, copies, share->rank == 0);
  }
}

Status fem_model_division_plan(const FemModel *model, int rank_count, FemDivisionPlan *plan) {
  size_t vertices = (size_t)model->vertex_count;
  FemShare share = {.rank_count = rank_count, .owner = memory_zeroed(vertices, sizeof(int))};
  int *seen = memory_zeroed(vertices, sizeof *seen);
  *plan = (FemDivisionPlan){.rank_count = rank_count};
  Status status = share.owner && seen ? STATUS_OK : status_no_memory("the division among ranks");
  if (!status) status = find_owners(model, rank_count, share.owner);
  if (!status) make_plan(model, &share, seen, plan);
  memory_free(share.owner), memory_free(seen);
  return status;
}

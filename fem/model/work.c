// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/work.h"

#include "fem/sparse/pattern.h"
#include "fem/sparse/solver.h"

// Operations of the factor of a cube, in six tetrahedra a cell, over the square of its vertices: 5.4 to 5.9
// with 15 to 31 of them along an edge.
static const double WORK_OF_A_CUBE = 5.5; // not chosen: measured

static Status couple(const FemModel *model, const FemModelBody *body, FemPattern *pattern) {
  const bool is_quadratic = body->element == FEM_ELEMENT_QUADRATIC;
  const int begin = is_quadratic ? body->quadratic_begin : body->tet_begin,
            end = is_quadratic ? body->quadratic_end : body->tet_end,
            count = is_quadratic ? FEM_QUADRATIC_NODES : 4;
  int nodes[FEM_QUADRATIC_NODES];
  for (int e = begin; e < end; e++) {
    const int *of = is_quadratic ? model->quadratic_nodes[e] : model->tets[e];
    for (int k = 0; k < count; k++) nodes[k] = of[k] - body->vertex_begin;
    TRY(fem_pattern_add_clique(pattern, count, nodes, NULL));
  }
  return STATUS_OK;
}

static Status count(const FemModel *model, FemModelBody *body) {
  FemPattern *pattern;
  double work = 0;
  TRY(fem_pattern_create(&pattern, body->vertex_end - body->vertex_begin));
  Status status = couple(model, body, pattern);
  if (!status) status = fem_solver_factor_work(pattern, &work);
  fem_pattern_destroy(pattern);
  body->cube = work / (WORK_OF_A_CUBE * (body->vertex_end - body->vertex_begin));
  return status;
}

Status fem_model_work_count(FemModel *model) {
  for (int b = 0; b < model->body_count; b++) {
    FemModelBody *body = &model->bodies[b];
    const int vertices = body->vertex_end - body->vertex_begin;
    body->cube = vertices;
    if (!body->is_obstacle && vertices > FEM_WORK_UNCOUNTED && model->free_count <= FEM_WORK_UNKNOWNS)
      TRY(count(model, body));
  }
  return STATUS_OK;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/poses/candidates.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

// Rounding of a posed vertex never matters to this part of the model's length.
static const double SLACK = 1e-9;

static void clear(double box[6]) {
  for (int c = 0; c < 3; c++) box[c] = INFINITY, box[3 + c] = -INFINITY;
}

static void include(double box[6], const double x[3], double slack) {
  for (int c = 0; c < 3; c++) {
    box[c] = fmin(box[c], x[c] - slack);
    box[3 + c] = fmax(box[3 + c], x[c] + slack);
  }
}

static void fill_others(AppPosesCandidates *candidates) {
  const FemModel *model = candidates->model;
  const FemModelBody *body = &model->bodies[candidates->body];
  for (int t = 0; t < model->tet_count; t++) {
    if (t >= body->tet_begin && t < body->tet_end) continue;
    double *box = candidates->others[candidates->other_count];
    clear(box);
    for (int v = 0; v < 4; v++) include(box, model->rest + 3 * (size_t)model->tets[t][v], 0);
    candidates->other_tets[candidates->other_count++] = t;
  }
}

Status app_poses_candidates_create(AppPosesCandidates *candidates, const FemModel *model, int body) {
  const FemModelBody *moved = &model->bodies[body];
  const size_t own = (size_t)(moved->tet_end - moved->tet_begin), others = (size_t)model->tet_count - own;
  *candidates = (AppPosesCandidates){.model = model, .body = body, .own_count = (int)own};
  candidates->own = memory_zeroed(own, sizeof *candidates->own);
  candidates->swept =
      memory_zeroed((size_t)(moved->vertex_end - moved->vertex_begin), sizeof *candidates->swept);
  candidates->others = memory_zeroed(others, sizeof *candidates->others);
  candidates->other_tets = memory_zeroed(others, sizeof *candidates->other_tets);
  if (!candidates->own || !candidates->swept || !candidates->others || !candidates->other_tets)
    return status_no_memory("boxes of tetrahedra");
  fill_others(candidates);
  return STATUS_OK;
}

void app_poses_candidates_destroy(AppPosesCandidates *candidates) {
  memory_free(candidates->own), memory_free(candidates->swept);
  memory_free(candidates->others), memory_free(candidates->other_tets);
  contact_boxes_destroy(&candidates->found);
  *candidates = (AppPosesCandidates){0};
}

// Where a vertex is over the poses.
static void sweep(AppPosesCandidates *candidates, int vertex, int count, const double *poses) {
  const FemModel *model = candidates->model;
  const double *x = model->rest + 3 * (size_t)vertex;
  double *box = candidates->swept[vertex - model->bodies[candidates->body].vertex_begin];
  clear(box);
  for (int i = 0; i < count; i++) {
    const double *pose = poses + 12 * (size_t)i;
    double moved[3];
    for (int c = 0; c < 3; c++)
      moved[c] = pose[3 * c] * x[0] + pose[3 * c + 1] * x[1] + pose[3 * c + 2] * x[2] + pose[9 + c];
    include(box, moved, SLACK * model->length);
  }
}

static void unite(AppPosesCandidates *candidates, int tet) {
  const FemModelBody *body = &candidates->model->bodies[candidates->body];
  double *box = candidates->own[tet];
  clear(box);
  for (int v = 0; v < 4; v++) {
    const double *swept =
        candidates->swept[candidates->model->tets[body->tet_begin + tet][v] - body->vertex_begin];
    include(box, swept, 0), include(box, swept + 3, 0);
  }
}

static int compare_pairs(const void *a, const void *b) {
  const int *p = a, *q = b;
  return p[0] != q[0] ? (p[0] > q[0]) - (p[0] < q[0]) : (p[1] > q[1]) - (p[1] < q[1]);
}

Status app_poses_candidates_find(AppPosesCandidates *candidates, int count, const double *poses) {
  const FemModelBody *body = &candidates->model->bodies[candidates->body];
  ContactBoxPairs *found = &candidates->found;
#pragma omp parallel for schedule(static)
  for (int v = body->vertex_begin; v < body->vertex_end; v++) sweep(candidates, v, count, poses);
  for (int t = 0; t < candidates->own_count; t++) unite(candidates, t);
  found->count = 0;
  TRY(contact_boxes_intersect((const double(*)[6])candidates->own, candidates->own_count,
                              (const double(*)[6])candidates->others, candidates->other_count, found));
  for (size_t k = 0; k < found->count; k++) {
    found->pairs[k][0] += body->tet_begin;
    found->pairs[k][1] = candidates->other_tets[found->pairs[k][1]];
  }
  qsort(found->pairs, found->count, sizeof *found->pairs, compare_pairs);
  return STATUS_OK;
}

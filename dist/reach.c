// SPDX-License-Identifier: GPL-3.0-or-later
#include "dist/reach.h"

#include "base/memory.h"

static bool is_own(const FemMatrix *pattern, int vertex) {
  return pattern->share->owner[vertex] == pattern->share->rank;
}

static int count_unknowns(const FemMatrix *pattern, int vertex) {
  const int *unknown = pattern->unknown_of_dof + 3 * (size_t)vertex;
  return (unknown[0] >= 0) + (unknown[1] >= 0) + (unknown[2] >= 0);
}

static bool is_reached(const FemMatrix *pattern, int vertex) {
  return count_unknowns(pattern, vertex) > 0 &&
         (is_own(pattern, vertex) || fem_matrix_is_coupled(pattern, vertex));
}

static void fill(DistReach *reach, const FemMatrix *pattern) {
  int vertex = 0, other = 0;
  for (int v = 0; v < pattern->vertex_count; v++) {
    if (!is_reached(pattern, v)) continue;
    reach->vertices[vertex++] = v;
    for (int c = 0; c < 3 && !is_own(pattern, v); c++) {
      int unknown = pattern->unknown_of_dof[3 * (size_t)v + (size_t)c];
      if (unknown >= 0) reach->others[other++] = unknown;
    }
  }
}

Status dist_reach_create(DistReach *reach, const FemMatrix *pattern) {
  *reach = (DistReach){0};
  for (int v = 0; v < pattern->vertex_count; v++) {
    if (!is_reached(pattern, v)) continue;
    reach->vertex_count++;
    if (!is_own(pattern, v)) reach->other_count += count_unknowns(pattern, v);
  }
  reach->vertices = memory_zeroed((size_t)reach->vertex_count, sizeof *reach->vertices);
  reach->others = memory_zeroed((size_t)reach->other_count, sizeof *reach->others);
  if (!reach->vertices || !reach->others) return status_no_memory("the condensed matrix");
  fill(reach, pattern);
  return STATUS_OK;
}

void dist_reach_destroy(DistReach *reach) {
  memory_free(reach->vertices), memory_free(reach->others);
  *reach = (DistReach){0};
}

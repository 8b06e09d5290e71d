// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/reader/shell.h"

#include <stdlib.h>

#include "base/memory.h"
#include "fem/mesh/sets.h"

typedef struct Edge {
  int low, high, triangle;
} Edge;

static int compare(const void *left, const void *right) {
  const Edge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

// What is wrong with edges, each kind with its first.
typedef struct Faults {
  int open_count, crowded_count;
  Edge first_open, first_crowded;
} Faults;

static Status explain(const Faults *faults, const double *positions) {
  const Edge *edge = faults->open_count ? &faults->first_open : &faults->first_crowded;
  const double *a = positions + 3 * (size_t)edge->low, *b = positions + 3 * (size_t)edge->high;
  if (faults->open_count)
    return status_fail(
        STATUS_INPUT,
        "the surface is open: edges with only one triangle: %d, the first from (%g, %g, %g) to (%g, %g, "
        "%g); close the holes",
        faults->open_count, a[0], a[1], a[2], b[0], b[1], b[2]);
  return status_fail(
      STATUS_INPUT,
      "the surface is not manifold: edges with more than two triangles: %d, the first from (%g, %g, %g) "
      "to (%g, %g, %g); separate the parts that touch there",
      faults->crowded_count, a[0], a[1], a[2], b[0], b[1], b[2]);
}

static Status check_edges(const Edge *edges, int edge_count, int triangle_count, int *shells,
                          const double *positions) {
  Faults faults = {0};
  int shell_count = triangle_count;
  for (int begin = 0, end; begin < edge_count; begin = end) {
    const Edge *edge = &edges[begin];
    for (end = begin + 1; end < edge_count && edges[end].low == edge->low && edges[end].high == edge->high;
         end++)
      shell_count -= fem_mesh_sets_join(shells, edge->triangle, edges[end].triangle);
    if (end - begin == 1 && faults.open_count++ == 0) faults.first_open = *edge;
    if (end - begin > 2 && faults.crowded_count++ == 0) faults.first_crowded = *edge;
  }
  if (faults.open_count || faults.crowded_count) return explain(&faults, positions);
  if (shell_count > 1)
    return status_fail(
        STATUS_INPUT,
        "the surface has %d separate shells; give one file for each body (a hollow body: a .geo or a "
        "volume mesh)",
        shell_count);
  return STATUS_OK;
}

Status fem_mesh_shell_check(const double *positions, int triangle_count, const int (*triangles)[3]) {
  if (triangle_count < 1) return status_fail(STATUS_INPUT, "has no triangles; give a closed surface");
  Edge *edges = memory_zeroed(3 * (size_t)triangle_count, sizeof *edges);
  int *shells = fem_mesh_sets_new(triangle_count);
  Status status = STATUS_OK;
  if (edges && shells) {
    for (int n = 0; n < triangle_count; n++)
      for (int k = 0; k < 3; k++) {
        int a = triangles[n][k], b = triangles[n][(k + 1) % 3];
        edges[3 * n + k] = a < b ? (Edge){a, b, n} : (Edge){b, a, n};
      }
    qsort(edges, 3 * (size_t)triangle_count, sizeof *edges, compare);
    status = check_edges(edges, 3 * triangle_count, triangle_count, shells, positions);
  } else {
    status = status_no_memory("a surface");
  }
  memory_free(edges), memory_free(shells);
  return status;
}

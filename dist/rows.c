// SPDX-License-Identifier: GPL-3.0-or-later
#include "dist/rows.h"

#include <string.h>

#include "base/memory.h"
#include "base/ranks.h"

static bool has_unknowns(const FemMatrix *pattern, int vertex) {
  const int *unknown = pattern->unknown_of_dof + 3 * (size_t)vertex;
  return unknown[0] >= 0 || unknown[1] >= 0 || unknown[2] >= 0;
}

// The rows of one vertex, which begin at `row`.
static void number_vertex(DistRows *rows, const FemMatrix *pattern, int vertex, int row) {
  bool is_own = pattern->share->owner[vertex] == pattern->share->rank;
  for (int c = 0; c < 3; c++) {
    int unknown = pattern->unknown_of_dof[3 * (size_t)vertex + (size_t)c];
    if (unknown >= 0) rows->row[unknown] = row + c;
    if (!is_own) continue;
    rows->dof[row + c - rows->first] = 3 * vertex + c;
    if (pattern->rest) rows->rest[row + c - rows->first] = pattern->rest[3 * (size_t)vertex + (size_t)c];
    if (unknown >= 0)
      rows->own[rows->own_count++] = unknown;
    else
      rows->alone[rows->alone_count++] = row + c;
  }
}

static void count_rows(DistRows *rows, const FemMatrix *pattern) {
  const FemShare *share = pattern->share;
  for (int v = 0; v < pattern->vertex_count; v++)
    if (has_unknowns(pattern, v)) rows->begin[share->owner[v] + 1] += 3;
  for (int r = 0; r < share->rank_count; r++) rows->begin[r + 1] += rows->begin[r];
  rows->count = rows->begin[share->rank_count];
  rows->first = rows->begin[share->rank];
  rows->end = rows->begin[share->rank + 1];
}

static Status reserve(DistRows *rows, const FemMatrix *pattern) {
  rows->unknowns =
      memory_copy(pattern->unknown_of_dof, 3 * (size_t)pattern->vertex_count, sizeof *rows->unknowns);
  rows->begin = memory_zeroed((size_t)pattern->share->rank_count + 1, sizeof *rows->begin);
  rows->row = memory_zeroed((size_t)pattern->size, sizeof *rows->row);
  if (!rows->unknowns || !rows->begin || !rows->row) return status_no_memory("the condensed system");
  count_rows(rows, pattern);
  size_t own = (size_t)(rows->end - rows->first);
  rows->own = memory_zeroed(own, sizeof *rows->own);
  rows->alone = memory_zeroed(own, sizeof *rows->alone);
  rows->rest = memory_zeroed(own, sizeof *rows->rest);
  rows->dof = memory_zeroed(own, sizeof *rows->dof);
  return rows->own && rows->alone && rows->rest && rows->dof ? STATUS_OK
                                                             : status_no_memory("the condensed system");
}

Status dist_rows_create(DistRows *rows, const FemMatrix *pattern) {
  *rows = (DistRows){.size = pattern->size};
  TRY(ranks()->worst(reserve(rows, pattern)));
  int *next = memory_copy(rows->begin, (size_t)pattern->share->rank_count, sizeof *next);
  TRY(ranks()->worst(next ? STATUS_OK : status_no_memory("the condensed system")));
  for (int v = 0; v < pattern->vertex_count; v++) {
    if (!has_unknowns(pattern, v)) continue;
    number_vertex(rows, pattern, v, next[pattern->share->owner[v]]);
    next[pattern->share->owner[v]] += 3;
  }
  memory_free(next);
  return STATUS_OK;
}

void dist_rows_destroy(DistRows *rows) {
  memory_free(rows->begin), memory_free(rows->row), memory_free(rows->unknowns);
  memory_free(rows->own), memory_free(rows->alone), memory_free(rows->rest);
  memory_free(rows->dof);
  *rows = (DistRows){0};
}

bool dist_rows_match(const DistRows *rows, const FemMatrix *pattern) {
  size_t bytes = 3 * (size_t)pattern->vertex_count * sizeof *rows->unknowns;
  return rows->unknowns && rows->size == pattern->size &&
         memcmp(rows->unknowns, pattern->unknown_of_dof, bytes) == 0;
}

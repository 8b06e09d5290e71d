// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/petsc/vertex_rows.h"

#include <limits.h>

#include "base/memory.h"

static void number(FemVertexRows *rows, const FemMatrix *pattern) {
  int unknown = 0;
  rows->count = 0;
  for (int v = 0; v < pattern->vertex_count; v++) {
    int before = unknown;
    for (int c = 0; c < 3; c++)
      if (pattern->unknown_of_dof[3 * v + c] >= 0) rows->place[unknown++] = rows->count + c;
    if (unknown == before) continue;
    for (int c = 0; c < 3 && rows->rest; c++) rows->rest[rows->count + c] = pattern->rest[3 * v + c];
    rows->count += 3;
  }
}

Status fem_vertex_rows_create(FemVertexRows *rows, const FemMatrix *pattern) {
  *rows = (FemVertexRows){.size = pattern->size};
  rows->place = memory_zeroed((size_t)pattern->size, sizeof *rows->place);
  if (pattern->rest) rows->rest = memory_zeroed(3 * (size_t)pattern->size, sizeof *rows->rest);
  if (!rows->place || (pattern->rest && !rows->rest)) {
    fem_vertex_rows_destroy(rows);
    return status_no_memory("the multigrid's rows");
  }
  number(rows, pattern);
  return STATUS_OK;
}

void fem_vertex_rows_destroy(FemVertexRows *rows) {
  memory_free(rows->place), memory_free(rows->rest);
  *rows = (FemVertexRows){0};
}

bool fem_vertex_rows_are_same(const FemVertexRows *a, const FemVertexRows *b) {
  if (a->size != b->size || a->count != b->count) return false;
  for (int u = 0; u < a->size; u++)
    if (a->place[u] != b->place[u]) return false;
  return true;
}

// How many entries each row has, then where it begins. Rows that no unknown has: one.
static void count_entries(const FemVertexRows *rows, const FemMatrix *matrix, int *begin) {
  for (int u = 0; u < matrix->size; u++)
    for (int k = matrix->col_begin[u]; k < matrix->col_begin[u + 1]; k++) {
      begin[rows->place[u] + 1]++;
      if (matrix->row[k] != u) begin[rows->place[matrix->row[k]] + 1]++;
    }
  for (int r = 0; r < rows->count; r++) begin[r + 1] = begin[r] + (begin[r + 1] ? begin[r + 1] : 1);
}

// Columns come in ascending order, so a row is filled from left to right: what is below the diagonal of
// earlier columns, then its own. `begin` is pushed on by a row, and moved back at the end.
static void fill_entries(const FemVertexRows *rows, const FemMatrix *matrix, FemVertexMatrix *to) {
  int *next = to->begin;
  for (int u = 0, row = 0; u <= matrix->size; u++) {
    int own = u < matrix->size ? rows->place[u] : rows->count;
    for (; row < own; row++) { // prescribed ones: as stiff as a neighbour
      int of = u > 0 ? u - 1 : u;
      to->column[next[row]] = row;
      to->value[next[row]++] = matrix->value[matrix->col_begin[of]];
    }
    if (u == matrix->size) break;
    row++;
    for (int k = matrix->col_begin[u]; k < matrix->col_begin[u + 1]; k++) {
      int other = rows->place[matrix->row[k]];
      to->column[next[own]] = other;
      to->value[next[own]++] = matrix->value[k];
      if (other == own) continue;
      to->column[next[other]] = own;
      to->value[next[other]++] = matrix->value[k];
    }
  }
  for (int r = to->count; r > 0; r--) next[r] = next[r - 1];
  next[0] = 0;
}

Status fem_vertex_matrix_fill(FemVertexMatrix *to, const FemVertexRows *rows, const FemMatrix *matrix,
                              const char *name) {
  size_t most = 2 * (size_t)matrix->entry_count + (size_t)rows->count;
  if (most > INT_MAX)
    return status_fail(STATUS_SOLVER, "%s: the matrix has more entries than can be numbered", name);
  to->count = rows->count;
  to->begin = memory_zeroed((size_t)to->count + 1, sizeof *to->begin);
  if (!to->begin) return status_no_memory("the multigrid's matrix");
  count_entries(rows, matrix, to->begin);
  size_t entries = (size_t)to->begin[to->count];
  to->column = memory_zeroed(entries, sizeof *to->column);
  to->value = memory_zeroed(entries, sizeof *to->value);
  if (!to->column || !to->value) return status_no_memory("the multigrid's matrix");
  fill_entries(rows, matrix, to);
  return STATUS_OK;
}

void fem_vertex_matrix_destroy(FemVertexMatrix *matrix) {
  memory_free(matrix->begin), memory_free(matrix->column), memory_free(matrix->value);
  *matrix = (FemVertexMatrix){0};
}

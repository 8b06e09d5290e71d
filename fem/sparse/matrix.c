// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/matrix.h"

#include <assert.h>
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "fem/sparse/matrix_blocks.h"
#include "fem/sparse/vector.h"

// Fewer are multiplied before another thread is awake.
enum { FEW_ENTRIES = 150000 };

static atomic_llong layout_count;

static Status no_memory(void) {
  return status_no_memory("the sparse matrix");
}

static Status lay_out(FemMatrix *matrix, const FemPattern *pattern) {
  TRY(fem_matrix_blocks_create(&matrix->blocks, pattern, matrix->unknown_of_dof));
  const FemMatrixBlocks *blocks = matrix->blocks;
  matrix->size = blocks->size;
  matrix->col_begin = blocks->col_begin;
  matrix->row = blocks->row;
  matrix->entry_count = blocks->entry_count;
  matrix->value = memory_zeroed((size_t)blocks->entry_count, sizeof *matrix->value);
  return matrix->value ? STATUS_OK : no_memory();
}

Status fem_matrix_create(FemMatrix *matrix, const FemPattern *pattern, const int *unknown_of_dof) {
  *matrix = (FemMatrix){.vertex_count = fem_pattern_vertex_count(pattern), .unknown_of_dof = unknown_of_dof};
  matrix->layout = atomic_fetch_add(&layout_count, 1) + 1;
  Status status = lay_out(matrix, pattern);
  if (status != STATUS_OK) fem_matrix_destroy(matrix);
  return status;
}

Status fem_matrix_copy_layout(FemMatrix *copy, const FemMatrix *from) {
  double *value = memory_zeroed((size_t)from->entry_count, sizeof *value);
  if (!value) {
    *copy = (FemMatrix){0};
    return no_memory();
  }
  *copy = *from;
  copy->value = value;
  copy->blocks->reference_count++;
  return STATUS_OK;
}

bool fem_matrix_fits(const FemMatrix *matrix, const FemPattern *pattern, const int *unknown_of_dof) {
  return matrix->blocks && fem_matrix_blocks_fit(matrix->blocks, pattern, unknown_of_dof);
}

void fem_matrix_destroy(FemMatrix *matrix) {
  fem_matrix_blocks_release(matrix->blocks);
  memory_free(matrix->value);
  *matrix = (FemMatrix){0};
}

void fem_matrix_zero(FemMatrix *matrix) {
  fem_vector_fill(matrix->entry_count, 0, matrix->value);
}

// The row offset of the block (v, w), v < w, both with unknowns. The pattern must have it. Halves are chosen
// without a branch, which no processor could guess.
static int find_block(const FemMatrixBlocks *blocks, int v, int w) {
  int at = blocks->above_begin[v], count = blocks->above_begin[v + 1] - at;
  for (; count > 1; count -= count / 2) at += (blocks->above[at + count / 2 - 1] < w) * (count / 2);
  assert(count == 1 && blocks->above[at] == w);
  return blocks->row_offset[at];
}

// block (3 × 3, rows of w, columns of v) += into the entries of (v, w), v < w.
static void add_block(FemMatrix *matrix, int v, int w, const double block[9]) {
  const FemMatrixBlocks *blocks = matrix->blocks;
  int row_offset = find_block(blocks, v, w);
  const int *column = matrix->unknown_of_dof + 3 * v, *row = matrix->unknown_of_dof + 3 * w;
  for (int c = 0; c < 3; c++) {
    if (column[c] < 0) continue;
    double *value =
        matrix->value + fem_matrix_blocks_rows(blocks, v, column[c] - blocks->first[v], row_offset);
    for (int r = 0; r < 3; r++)
      if (row[r] >= 0) *value++ += block[3 * r + c];
  }
}

// The same where both vertices have all their unknowns; the block is in a matrix with rows of `stride`.
static void add_whole_block(FemMatrix *matrix, int v, int w, const double *from, int stride, double scale) {
  int row_offset = find_block(matrix->blocks, v, w);
  for (int c = 0; c < 3; c++) {
    double *value = matrix->value + fem_matrix_blocks_rows(matrix->blocks, v, c, row_offset);
    for (int r = 0; r < 3; r++) value[r] += scale * from[stride * r + c];
  }
}

// The lower triangle of block (3 × 3) += into v's own entries.
static void add_own_block(FemMatrix *matrix, int v, const double block[9]) {
  const int *unknown = matrix->unknown_of_dof + 3 * v;
  for (int c = 0; c < 3; c++) {
    if (unknown[c] < 0) continue;
    double *value = matrix->value + matrix->col_begin[unknown[c]];
    for (int r = c; r < 3; r++)
      if (unknown[r] >= 0) *value++ += block[3 * r + c];
  }
}

void fem_matrix_add(FemMatrix *matrix, int count, const int *vertices, const double *dense, double scale) {
  if (!fem_share_has(matrix->share, count, vertices)) return;
  const signed char *active = matrix->blocks->active;
  for (int i = 0; i < count; i++) {
    int v = vertices[i];
    if (!active[v]) continue;
    for (int j = 0; j < count; j++) {
      int w = vertices[j];
      if (w < v || !active[w]) continue;
      const double *from = dense + (size_t)(3 * j) * (size_t)(3 * count) + 3 * i;
      double block[9];
      if (w > v && active[v] == 3 && active[w] == 3) {
        add_whole_block(matrix, v, w, from, 3 * count, scale);
        continue;
      }
      for (int r = 0; r < 3; r++, from += 3 * count)
        for (int c = 0; c < 3; c++) block[3 * r + c] = scale * from[c];
      if (w == v)
        add_own_block(matrix, v, block);
      else
        add_block(matrix, v, w, block);
    }
  }
}

void fem_matrix_add_outer(FemMatrix *matrix, int count, const int *vertices, const double *w, double scale) {
  if (!fem_share_has(matrix->share, count, vertices)) return;
  const signed char *active = matrix->blocks->active;
  for (int i = 0; i < count; i++) {
    if (!active[vertices[i]]) continue;
    for (int j = 0; j < count; j++) {
      if (vertices[j] < vertices[i] || !active[vertices[j]]) continue;
      double block[9];
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) block[3 * r + c] = scale * w[3 * j + r] * w[3 * i + c];
      if (j == i)
        add_own_block(matrix, vertices[i], block);
      else
        add_block(matrix, vertices[i], vertices[j], block);
    }
  }
}

void fem_matrix_slots(const FemMatrix *matrix, int count, const int *vertices, int *slots) {
  const FemMatrixBlocks *blocks = matrix->blocks;
  int n = 3 * count;
  for (int k = 0; k < n * n; k++) slots[k] = -1;
  for (int i = 0; i < count; i++)
    for (int j = 0; j < count; j++) {
      int v = vertices[i], w = vertices[j];
      if (w < v || !blocks->active[v] || !blocks->active[w]) continue;
      int row_offset = w == v ? -blocks->active[v] : find_block(blocks, v, w);
      for (int c = 0; c < 3; c++)
        for (int r = w == v ? c : 0; r < 3; r++) {
          int column = matrix->unknown_of_dof[3 * v + c], row = matrix->unknown_of_dof[3 * w + r];
          if (column < 0 || row < 0) continue;
          slots[n * (3 * j + r) + 3 * i + c] =
              fem_matrix_blocks_rows(blocks, v, column - blocks->first[v], row_offset) + row -
              blocks->first[w];
        }
    }
}

bool fem_matrix_block_slots(const FemMatrix *matrix, const int vertices[4], int slots[14]) {
  static const int first[6] = {0, 0, 0, 1, 1, 2}, second[6] = {1, 2, 3, 2, 3, 3};
  const FemMatrixBlocks *blocks = matrix->blocks;
  for (int a = 0; a < 4; a++) {
    if (blocks->active[vertices[a]] < 3) return false;
    const int *begin = matrix->col_begin + blocks->first[vertices[a]];
    slots[a] = begin[0];
    slots[10 + a] = begin[1] - begin[0];
  }
  for (int p = 0; p < 6; p++) {
    int v = vertices[first[p]];
    slots[4 + p] = fem_matrix_blocks_rows(blocks, v, 0, find_block(blocks, v, vertices[second[p]]));
  }
  return true;
}

void fem_matrix_add_mass(FemMatrix *matrix, const double *mass, double scale) {
  for (int dof = 0; dof < 3 * matrix->vertex_count; dof++) {
    int unknown = matrix->unknown_of_dof[dof], vertex = dof / 3;
    if (unknown >= 0 && fem_share_has(matrix->share, 1, &vertex))
      matrix->value[matrix->col_begin[unknown]] += scale * mass[vertex];
  }
}

// Where block k, of vertex w, is added to. `kept` NULL: rows of other pieces are not kept beside.
static double *rows_of(const FemMatrixBlocks *blocks, int k, int w, double *y, double *kept) {
  return kept && blocks->target[k] < 0 ? kept + ~blocks->target[k] : y + blocks->first[w];
}

// A vertex with three unknowns and its blocks with higher vertices, each number read once: it is that of two
// entries.
static void spread_vertex(const FemMatrix *matrix, int v, const double *x, double *y, double *kept) {
  const FemMatrixBlocks *blocks = matrix->blocks;
  const int first = blocks->first[v], *begin = matrix->col_begin + first;
  const double *a = matrix->value + begin[0], *b = matrix->value + begin[1], *c = matrix->value + begin[2];
  const double *own = x + first;
  double sum[3] = {a[0] * own[0] + a[1] * own[1] + a[2] * own[2],
                   a[1] * own[0] + b[0] * own[1] + b[1] * own[2],
                   a[2] * own[0] + b[1] * own[1] + c[0] * own[2]};
  a += 3, b += 2, c += 1;
  for (int k = blocks->above_begin[v]; k < blocks->above_begin[v + 1]; k++) {
    const int w = blocks->above[k], count = blocks->active[w];
    const double *at = x + blocks->first[w];
    double *to = rows_of(blocks, k, w, y, kept);
    for (int r = 0; r < count; r++) {
      sum[0] += a[r] * at[r], sum[1] += b[r] * at[r], sum[2] += c[r] * at[r];
      to[r] += a[r] * own[0] + b[r] * own[1] + c[r] * own[2];
    }
    a += count, b += count, c += count;
  }
  for (int r = 0; r < 3; r++) y[first + r] += sum[r];
}

static void spread_own(const FemMatrix *matrix, int column, int end, const double *x, double *y) {
  const double *value = matrix->value + matrix->col_begin[column];
  y[column] += value[0] * x[column];
  for (int r = column + 1; r < end; r++) {
    y[column] += value[r - column] * x[r];
    y[r] += value[r - column] * x[column];
  }
}

// The same for any vertex, a column at a time.
static void spread_columns(const FemMatrix *matrix, int v, const double *x, double *y, double *kept) {
  const FemMatrixBlocks *blocks = matrix->blocks;
  const int first = blocks->first[v], end = first + blocks->active[v];
  for (int column = first; column < end; column++) spread_own(matrix, column, end, x, y);
  for (int k = blocks->above_begin[v]; k < blocks->above_begin[v + 1]; k++) {
    const int w = blocks->above[k], count = blocks->active[w];
    const double *at = x + blocks->first[w];
    double *to = rows_of(blocks, k, w, y, kept);
    for (int column = first; column < end; column++) {
      const double *value =
          matrix->value + fem_matrix_blocks_rows(blocks, v, column - first, blocks->row_offset[k]);
      for (int r = 0; r < count; r++) {
        y[column] += value[r] * at[r];
        to[r] += value[r] * x[column];
      }
    }
  }
}

static void spread(const FemMatrix *matrix, int v, const double *x, double *y, double *kept) {
  if (matrix->blocks->active[v] == 3)
    spread_vertex(matrix, v, x, y, kept);
  else
    spread_columns(matrix, v, x, y, kept);
}

// The rows of piece p.
static void spread_piece(const FemMatrix *matrix, int p, const double *x, double *y) {
  const FemMatrixBlocks *blocks = matrix->blocks;
  const int begin = blocks->piece_begin[p], end = blocks->piece_begin[p + 1], kept = blocks->kept_begin[p];
  const int first = blocks->first[begin], last = blocks->first[end - 1] + blocks->active[end - 1];
  memset(y + first, 0, (size_t)(last - first) * sizeof *y);
  memset(blocks->kept + kept, 0, (size_t)(blocks->kept_begin[p + 1] - kept) * sizeof *y);
  for (int v = begin; v < end; v++) spread(matrix, v, x, y, blocks->kept);
}

static void take_gifts(const FemMatrixBlocks *blocks, int p, double *y) {
  for (int g = blocks->gift_begin[p]; g < blocks->gift_begin[p + 1]; g++) {
    const FemMatrixGift *gift = &blocks->gifts[g];
    for (int r = 0; r < gift->count; r++) y[gift->to + r] += blocks->kept[gift->from + r];
  }
}

void fem_matrix_multiply(const FemMatrix *matrix, const double *x, double *y) {
  const FemMatrixBlocks *blocks = matrix->blocks;
#pragma omp parallel if (matrix->entry_count > FEW_ENTRIES)
  {
#pragma omp for schedule(dynamic)
    for (int p = 0; p < blocks->piece_count; p++) spread_piece(matrix, p, x, y);
#pragma omp for schedule(dynamic)
    for (int p = 0; p < blocks->piece_count; p++) take_gifts(blocks, p, y);
  }
}

bool fem_matrix_is_coupled(const FemMatrix *matrix, int vertex) {
  const FemMatrixBlocks *blocks = matrix->blocks;
  return blocks->above_begin[vertex] < blocks->above_begin[vertex + 1] ||
         blocks->below_begin[vertex] < blocks->below_begin[vertex + 1];
}

void fem_matrix_add_product(const FemMatrix *matrix, int count, const int *vertices, const double *x,
                            double *y) {
  for (int i = 0; i < count; i++) spread(matrix, vertices[i], x, y, NULL);
}

// The entries of a row with columns of lower vertices.
static int copy_below(const FemMatrix *matrix, int vertex, int own, int *columns, double *values) {
  const FemMatrixBlocks *blocks = matrix->blocks;
  int count = 0;
  for (int b = blocks->below_begin[vertex]; b < blocks->below_begin[vertex + 1]; b++) {
    int v = blocks->below[b];
    for (int c = 0; c < blocks->active[v]; c++, count++) {
      if (!columns) continue;
      columns[count] = blocks->first[v] + c;
      values[count] = matrix->value[fem_matrix_blocks_rows(blocks, v, c, blocks->below_offset[b]) + own];
    }
  }
  return count;
}

int fem_matrix_row(const FemMatrix *matrix, int vertex, int unknown, int *columns, double *values) {
  const int first = matrix->blocks->first[vertex], own = unknown - first;
  const int begin = matrix->col_begin[unknown], end = matrix->col_begin[unknown + 1];
  int count = copy_below(matrix, vertex, own, columns, values);
  for (int c = 0; c < own && columns; c++) {
    columns[count + c] = first + c;
    values[count + c] = matrix->value[matrix->col_begin[first + c] + own - c];
  }
  count += own;
  if (columns) {
    memcpy(columns + count, matrix->row + begin, (size_t)(end - begin) * sizeof *columns);
    memcpy(values + count, matrix->value + begin, (size_t)(end - begin) * sizeof *values);
  }
  return count + end - begin;
}

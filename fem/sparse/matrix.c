// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/matrix.h"

#include <assert.h>
#include <limits.h>
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "fem/sparse/vector.h"

// Entries of a piece of a product: a quarter of a megabyte to be read. A matrix with fewer is one piece.
enum { PIECE_SIZE = 32768 };

// Fewer are multiplied before another thread is awake.
enum { FEW_ENTRIES = 150000 };

// Rows of a vertex that an earlier piece of a product has added to.
typedef struct FemMatrixGift {
  int from, to; // in `kept`, in y
  int count;
} FemMatrixGift;

// Where the block of vertices (v, w), v < w, stands. Column c of v (c = 0 … active[v] − 1, counted over v's
// own unknowns) holds
//
//   col_begin[first[v] + c] ─► own rows c … active[v] − 1 │ rows of w₁ │ rows of w₂ │ …
//                                                         └ row_offset counts from here, the same for all c
//
// Vertices without an unknown have no blocks.
typedef struct FemMatrixBlocks {
  int reference_count;
  int *col_begin, *row;
  int *first;          // first unknown                                          (vertex_count)
  signed char *active; // number of unknowns, 0 … 3                              (vertex_count)
  int *above_begin;    // of v in above and row_offset                           (vertex_count + 1)
  int *above;          // w > v, ascending                                       (block_count)
  int *row_offset;     // rows of v's columns that stand before w's              (block_count)
  int *below_begin;    // the same blocks by w: of w in below and below_offset   (vertex_count + 1)
  int *below;          // v < w, ascending                                       (block_count)
  int *below_offset;   // row_offset of the block                                (block_count)
  // Products are formed by pieces of consecutive vertices, which the layout alone determines. A piece writes
  // its own rows and keeps what it has for later ones beside, to be added in the order of the pieces.
  int piece_count;
  int *piece_begin; // first vertex                                              (piece_count + 1)
  int *target;      // of each block: where w's rows are in y; ~ in `kept`       (block_count)
  int *gift_begin;  // of each piece in gifts: what earlier ones have for it     (piece_count + 1)
  FemMatrixGift *gifts;
  double *kept;    // (kept_begin[piece_count])
  int *kept_begin; // of each piece                                              (piece_count + 1)
} FemMatrixBlocks;

static atomic_llong layout_count;

static void release_blocks(FemMatrixBlocks *blocks) {
  if (!blocks || --blocks->reference_count > 0) return;
  memory_free(blocks->col_begin), memory_free(blocks->row);
  memory_free(blocks->first), memory_free(blocks->active);
  memory_free(blocks->above_begin), memory_free(blocks->above), memory_free(blocks->row_offset);
  memory_free(blocks->below_begin), memory_free(blocks->below), memory_free(blocks->below_offset);
  memory_free(blocks->piece_begin), memory_free(blocks->target), memory_free(blocks->gift_begin);
  memory_free(blocks->gifts), memory_free(blocks->kept), memory_free(blocks->kept_begin);
  memory_free(blocks);
}

static Status no_memory(void) {
  return status_no_memory("the sparse matrix");
}

// First unknown and number of unknowns of every vertex.
static Status number_vertices(FemMatrix *matrix) {
  FemMatrixBlocks *blocks = matrix->blocks;
  blocks->first = memory_zeroed((size_t)matrix->vertex_count, sizeof *blocks->first);
  blocks->active = memory_zeroed((size_t)matrix->vertex_count, sizeof *blocks->active);
  if (!blocks->first || !blocks->active) return no_memory();
  int next = 0;
  for (int v = 0; v < matrix->vertex_count; v++) {
    blocks->first[v] = next;
    for (int c = 0; c < 3; c++) {
      int unknown = matrix->unknown_of_dof[3 * v + c];
      assert(unknown < 0 || unknown == next);
      next += unknown >= 0;
    }
    blocks->active[v] = (signed char)(next - blocks->first[v]);
  }
  matrix->size = next;
  return STATUS_OK;
}

// Blocks by their lower vertex, and how many entries the columns have in all.
static Status lay_blocks(FemMatrix *matrix, const FemPattern *pattern, size_t *entry_count) {
  FemMatrixBlocks *blocks = matrix->blocks;
  size_t block_count = 0;
  for (int v = 0; v < matrix->vertex_count; v++) {
    int count;
    fem_pattern_above(pattern, v, &count);
    block_count += (size_t)count;
  }
  if (block_count > INT_MAX)
    return status_fail(
        STATUS_INPUT,
        "the matrix would have %zu pairs of coupled vertices, more than %d can be numbered: use "
        "coarser meshes",
        block_count, INT_MAX);
  blocks->above_begin = memory_zeroed((size_t)matrix->vertex_count + 1, sizeof *blocks->above_begin);
  blocks->above = memory_zeroed(block_count, sizeof *blocks->above);
  blocks->row_offset = memory_zeroed(block_count, sizeof *blocks->row_offset);
  if (!blocks->above_begin || !blocks->above || !blocks->row_offset) return no_memory();

  *entry_count = 0;
  int end = 0;
  for (int v = 0; v < matrix->vertex_count; v++) {
    int count, rows = 0;
    const int *above = fem_pattern_above(pattern, v, &count);
    for (int k = 0; k < count && blocks->active[v]; k++) {
      if (!blocks->active[above[k]]) continue;
      blocks->above[end] = above[k];
      blocks->row_offset[end++] = rows;
      rows += blocks->active[above[k]];
    }
    blocks->above_begin[v + 1] = end;
    size_t a = (size_t)blocks->active[v];
    *entry_count += a * (size_t)rows + a * (a + 1) / 2;
  }
  return STATUS_OK;
}

// The same blocks by their higher vertex, for products.
static Status transpose_blocks(FemMatrix *matrix) {
  FemMatrixBlocks *blocks = matrix->blocks;
  int vertex_count = matrix->vertex_count, block_count = blocks->above_begin[vertex_count];
  blocks->below_begin = memory_zeroed((size_t)vertex_count + 1, sizeof *blocks->below_begin);
  blocks->below = memory_zeroed((size_t)block_count, sizeof *blocks->below);
  blocks->below_offset = memory_zeroed((size_t)block_count, sizeof *blocks->below_offset);
  int *next = memory_zeroed((size_t)vertex_count, sizeof *next);
  if (!blocks->below_begin || !blocks->below || !blocks->below_offset || !next) {
    memory_free(next);
    return no_memory();
  }
  for (int b = 0; b < block_count; b++) blocks->below_begin[blocks->above[b] + 1]++;
  for (int w = 0; w < vertex_count; w++) {
    blocks->below_begin[w + 1] += blocks->below_begin[w];
    next[w] = blocks->below_begin[w];
  }
  for (int v = 0; v < vertex_count; v++)
    for (int b = blocks->above_begin[v]; b < blocks->above_begin[v + 1]; b++) {
      int to = next[blocks->above[b]]++;
      blocks->below[to] = v;
      blocks->below_offset[to] = blocks->row_offset[b];
    }
  memory_free(next);
  return STATUS_OK;
}

// col_begin and row from the blocks.
static Status lay_entries(FemMatrix *matrix, size_t entry_count) {
  FemMatrixBlocks *blocks = matrix->blocks;
  if (entry_count > INT_MAX)
    return status_fail(STATUS_INPUT,
                       "the matrix would have %zu entries, more than %d can be numbered: use coarser meshes",
                       entry_count, INT_MAX);
  blocks->col_begin = memory_zeroed((size_t)matrix->size + 1, sizeof *blocks->col_begin);
  blocks->row = memory_zeroed(entry_count, sizeof *blocks->row);
  matrix->value = memory_zeroed(entry_count, sizeof *matrix->value);
  if (!blocks->col_begin || !blocks->row || !matrix->value) return no_memory();
  int end = 0;
  for (int v = 0; v < matrix->vertex_count; v++)
    for (int c = 0; c < blocks->active[v]; c++) {
      for (int r = c; r < blocks->active[v]; r++) blocks->row[end++] = blocks->first[v] + r;
      for (int b = blocks->above_begin[v]; b < blocks->above_begin[v + 1]; b++) {
        int w = blocks->above[b];
        for (int r = 0; r < blocks->active[w]; r++) blocks->row[end++] = blocks->first[w] + r;
      }
      blocks->col_begin[blocks->first[v] + c + 1] = end;
    }
  assert((size_t)end == entry_count);
  matrix->entry_count = end;
  matrix->col_begin = blocks->col_begin;
  matrix->row = blocks->row;
  return STATUS_OK;
}

static void cut_pieces(FemMatrix *matrix) {
  FemMatrixBlocks *blocks = matrix->blocks;
  int begin = 0; // entry
  for (int v = 0; v < matrix->vertex_count; v++) {
    int end = blocks->col_begin[blocks->first[v] + blocks->active[v]];
    if (end - begin < PIECE_SIZE && v + 1 < matrix->vertex_count) continue;
    blocks->piece_begin[++blocks->piece_count] = v + 1;
    begin = end;
  }
}

// `target`, and how much a piece keeps for each later vertex: all of its rows, once.
static void place_targets(FemMatrix *matrix, int *piece_of, int *slot, int *gift_count) {
  FemMatrixBlocks *blocks = matrix->blocks;
  int end = 0;
  for (int v = 0; v < matrix->vertex_count; v++) slot[v] = -1;
  for (int p = 0; p < blocks->piece_count; p++) {
    int first = end;
    blocks->kept_begin[p] = end;
    for (int v = blocks->piece_begin[p]; v < blocks->piece_begin[p + 1]; v++)
      for (int b = blocks->above_begin[v]; b < blocks->above_begin[v + 1]; b++) {
        int w = blocks->above[b];
        if (w < blocks->piece_begin[p + 1]) {
          blocks->target[b] = blocks->first[w];
          continue;
        }
        if (slot[w] < first) {
          slot[w] = end;
          end += blocks->active[w];
          gift_count[piece_of[w] + 1]++;
        }
        blocks->target[b] = ~slot[w];
      }
  }
  blocks->kept_begin[blocks->piece_count] = end;
}

// Once each, in the order of the pieces that give.
static void list_gifts(FemMatrix *matrix, const int *piece_of, int *seen, int *next) {
  FemMatrixBlocks *blocks = matrix->blocks;
  for (int v = 0; v < matrix->vertex_count; v++) seen[v] = -1;
  for (int p = 0; p < blocks->piece_count; p++)
    for (int v = blocks->piece_begin[p]; v < blocks->piece_begin[p + 1]; v++)
      for (int b = blocks->above_begin[v]; b < blocks->above_begin[v + 1]; b++) {
        int w = blocks->above[b];
        if (blocks->target[b] >= 0 || seen[w] == p) continue;
        seen[w] = p;
        blocks->gifts[next[piece_of[w]]++] =
            (FemMatrixGift){~blocks->target[b], blocks->first[w], blocks->active[w]};
      }
}

static Status make_gifts(FemMatrix *matrix, int *piece_of, int *scratch) {
  FemMatrixBlocks *blocks = matrix->blocks;
  for (int p = 0; p < blocks->piece_count; p++)
    for (int v = blocks->piece_begin[p]; v < blocks->piece_begin[p + 1]; v++) piece_of[v] = p;
  place_targets(matrix, piece_of, scratch, blocks->gift_begin);
  for (int p = 0; p < blocks->piece_count; p++) blocks->gift_begin[p + 1] += blocks->gift_begin[p];
  blocks->gifts = memory_zeroed((size_t)blocks->gift_begin[blocks->piece_count], sizeof *blocks->gifts);
  blocks->kept = memory_zeroed((size_t)blocks->kept_begin[blocks->piece_count], sizeof *blocks->kept);
  int *next = memory_copy(blocks->gift_begin, (size_t)blocks->piece_count + 1, sizeof *next);
  bool fits = blocks->gifts && blocks->kept && next;
  if (fits) list_gifts(matrix, piece_of, scratch, next);
  memory_free(next);
  return fits ? STATUS_OK : no_memory();
}

static Status divide_products(FemMatrix *matrix) {
  FemMatrixBlocks *blocks = matrix->blocks;
  size_t vertices = (size_t)matrix->vertex_count, most = (size_t)matrix->entry_count / PIECE_SIZE + 2;
  blocks->piece_begin = memory_zeroed(most, sizeof *blocks->piece_begin);
  blocks->gift_begin = memory_zeroed(most, sizeof *blocks->gift_begin);
  blocks->kept_begin = memory_zeroed(most, sizeof *blocks->kept_begin);
  blocks->target = memory_zeroed((size_t)blocks->above_begin[vertices], sizeof *blocks->target);
  int *piece_of = memory_zeroed(vertices, sizeof *piece_of),
      *scratch = memory_zeroed(vertices, sizeof *scratch);
  bool fits = blocks->piece_begin && blocks->gift_begin && blocks->kept_begin && blocks->target && piece_of &&
              scratch;
  Status status = STATUS_OK;
  if (fits) {
    cut_pieces(matrix);
    status = make_gifts(matrix, piece_of, scratch);
  }
  memory_free(piece_of), memory_free(scratch);
  return fits ? status : no_memory();
}

static Status lay_out(FemMatrix *matrix, const FemPattern *pattern) {
  size_t entry_count = 0;
  TRY(number_vertices(matrix));
  TRY(lay_blocks(matrix, pattern, &entry_count));
  TRY(transpose_blocks(matrix));
  TRY(lay_entries(matrix, entry_count));
  return divide_products(matrix);
}

Status fem_matrix_create(FemMatrix *matrix, const FemPattern *pattern, const int *unknown_of_dof) {
  *matrix = (FemMatrix){.vertex_count = fem_pattern_vertex_count(pattern), .unknown_of_dof = unknown_of_dof};
  matrix->blocks = memory_zeroed(1, sizeof *matrix->blocks);
  if (!matrix->blocks) return no_memory();
  matrix->blocks->reference_count = 1;
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

// Whether the blocks of the vertex are those of the pattern.
static bool fits_vertex(const FemMatrix *matrix, const FemPattern *pattern, int v) {
  const FemMatrixBlocks *blocks = matrix->blocks;
  int count, at = blocks->above_begin[v];
  const int *above = fem_pattern_above(pattern, v, &count);
  for (int k = 0; k < count && blocks->active[v]; k++) {
    if (!blocks->active[above[k]]) continue;
    if (at == blocks->above_begin[v + 1] || blocks->above[at++] != above[k]) return false;
  }
  return at == blocks->above_begin[v + 1];
}

bool fem_matrix_fits(const FemMatrix *matrix, const FemPattern *pattern, const int *unknown_of_dof) {
  const FemMatrixBlocks *blocks = matrix->blocks;
  if (!blocks || matrix->vertex_count != fem_pattern_vertex_count(pattern)) return false;
  int next = 0;
  for (int v = 0; v < matrix->vertex_count; v++) {
    if (next != blocks->first[v]) return false;
    for (int c = 0; c < 3; c++) next += unknown_of_dof[3 * v + c] >= 0;
    if (next - blocks->first[v] != blocks->active[v]) return false;
  }
  for (int v = 0; v < matrix->vertex_count; v++)
    if (!fits_vertex(matrix, pattern, v)) return false;
  return true;
}

void fem_matrix_destroy(FemMatrix *matrix) {
  release_blocks(matrix->blocks);
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

// The rows of a block in column c of v begin here.
static int block_rows(const FemMatrixBlocks *blocks, int v, int c, int row_offset) {
  return blocks->col_begin[blocks->first[v] + c] + blocks->active[v] - c + row_offset;
}

// block (3 × 3, rows of w, columns of v) += into the entries of (v, w), v < w.
static void add_block(FemMatrix *matrix, int v, int w, const double block[9]) {
  const FemMatrixBlocks *blocks = matrix->blocks;
  int row_offset = find_block(blocks, v, w);
  const int *column = matrix->unknown_of_dof + 3 * v, *row = matrix->unknown_of_dof + 3 * w;
  for (int c = 0; c < 3; c++) {
    if (column[c] < 0) continue;
    double *value = matrix->value + block_rows(blocks, v, column[c] - blocks->first[v], row_offset);
    for (int r = 0; r < 3; r++)
      if (row[r] >= 0) *value++ += block[3 * r + c];
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
              block_rows(blocks, v, column - blocks->first[v], row_offset) + row - blocks->first[w];
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
    slots[4 + p] = block_rows(blocks, v, 0, find_block(blocks, v, vertices[second[p]]));
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
      const double *value = matrix->value + block_rows(blocks, v, column - first, blocks->row_offset[k]);
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
#pragma omp for schedule(static)
    for (int p = 0; p < blocks->piece_count; p++) spread_piece(matrix, p, x, y);
#pragma omp for schedule(static)
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
      values[count] = matrix->value[block_rows(blocks, v, c, blocks->below_offset[b]) + own];
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

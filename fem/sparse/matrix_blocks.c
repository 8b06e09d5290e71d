// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/matrix_blocks.h"

#include <assert.h>
#include <limits.h>

#include "base/memory.h"

// Entries of a piece of a product: a quarter of a megabyte to be read. A matrix with fewer is one piece.
enum { PIECE_SIZE = 32768 };

static Status no_memory(void) {
  return status_no_memory("the sparse matrix");
}

// First unknown and number of unknowns of every vertex.
static Status number_vertices(FemMatrixBlocks *blocks, const int *unknown_of_dof) {
  blocks->first = memory_zeroed((size_t)blocks->vertex_count, sizeof *blocks->first);
  blocks->active = memory_zeroed((size_t)blocks->vertex_count, sizeof *blocks->active);
  if (!blocks->first || !blocks->active) return no_memory();
  int next = 0;
  for (int v = 0; v < blocks->vertex_count; v++) {
    blocks->first[v] = next;
    for (int c = 0; c < 3; c++) {
      int unknown = unknown_of_dof[3 * v + c];
      assert(unknown < 0 || unknown == next);
      next += unknown >= 0;
    }
    blocks->active[v] = (signed char)(next - blocks->first[v]);
  }
  blocks->size = next;
  return STATUS_OK;
}

// Blocks by their lower vertex, and how many entries the columns have in all.
static Status lay_blocks(FemMatrixBlocks *blocks, const FemPattern *pattern, size_t *entry_count) {
  size_t block_count = 0;
  for (int v = 0; v < blocks->vertex_count; v++) {
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
  blocks->above_begin = memory_zeroed((size_t)blocks->vertex_count + 1, sizeof *blocks->above_begin);
  blocks->above = memory_zeroed(block_count, sizeof *blocks->above);
  blocks->row_offset = memory_zeroed(block_count, sizeof *blocks->row_offset);
  if (!blocks->above_begin || !blocks->above || !blocks->row_offset) return no_memory();

  *entry_count = 0;
  int end = 0;
  for (int v = 0; v < blocks->vertex_count; v++) {
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
static Status transpose_blocks(FemMatrixBlocks *blocks) {
  int vertex_count = blocks->vertex_count, block_count = blocks->above_begin[vertex_count];
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
static Status lay_entries(FemMatrixBlocks *blocks, size_t entry_count) {
  if (entry_count > INT_MAX)
    return status_fail(STATUS_INPUT,
                       "the matrix would have %zu entries, more than %d can be numbered: use coarser meshes",
                       entry_count, INT_MAX);
  blocks->col_begin = memory_zeroed((size_t)blocks->size + 1, sizeof *blocks->col_begin);
  blocks->row = memory_zeroed(entry_count, sizeof *blocks->row);
  if (!blocks->col_begin || !blocks->row) return no_memory();
  int end = 0;
  for (int v = 0; v < blocks->vertex_count; v++)
    for (int c = 0; c < blocks->active[v]; c++) {
      for (int r = c; r < blocks->active[v]; r++) blocks->row[end++] = blocks->first[v] + r;
      for (int b = blocks->above_begin[v]; b < blocks->above_begin[v + 1]; b++) {
        int w = blocks->above[b];
        for (int r = 0; r < blocks->active[w]; r++) blocks->row[end++] = blocks->first[w] + r;
      }
      blocks->col_begin[blocks->first[v] + c + 1] = end;
    }
  assert((size_t)end == entry_count);
  blocks->entry_count = end;
  return STATUS_OK;
}

static void cut_pieces(FemMatrixBlocks *blocks) {
  int begin = 0; // entry
  for (int v = 0; v < blocks->vertex_count; v++) {
    int end = blocks->col_begin[blocks->first[v] + blocks->active[v]];
    if (end - begin < PIECE_SIZE && v + 1 < blocks->vertex_count) continue;
    blocks->piece_begin[++blocks->piece_count] = v + 1;
    begin = end;
  }
}

// `target`, and how much a piece keeps for each later vertex: all of its rows, once.
static void place_targets(FemMatrixBlocks *blocks, int *piece_of, int *slot, int *gift_count) {
  int end = 0;
  for (int v = 0; v < blocks->vertex_count; v++) slot[v] = -1;
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
static void list_gifts(FemMatrixBlocks *blocks, const int *piece_of, int *seen, int *next) {
  for (int v = 0; v < blocks->vertex_count; v++) seen[v] = -1;
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

static Status make_gifts(FemMatrixBlocks *blocks, int *piece_of, int *scratch) {
  for (int p = 0; p < blocks->piece_count; p++)
    for (int v = blocks->piece_begin[p]; v < blocks->piece_begin[p + 1]; v++) piece_of[v] = p;
  place_targets(blocks, piece_of, scratch, blocks->gift_begin);
  for (int p = 0; p < blocks->piece_count; p++) blocks->gift_begin[p + 1] += blocks->gift_begin[p];
  blocks->gifts = memory_zeroed((size_t)blocks->gift_begin[blocks->piece_count], sizeof *blocks->gifts);
  blocks->kept = memory_zeroed((size_t)blocks->kept_begin[blocks->piece_count], sizeof *blocks->kept);
  int *next = memory_copy(blocks->gift_begin, (size_t)blocks->piece_count + 1, sizeof *next);
  bool fits = blocks->gifts && blocks->kept && next;
  if (fits) list_gifts(blocks, piece_of, scratch, next);
  memory_free(next);
  return fits ? STATUS_OK : no_memory();
}

static Status divide_products(FemMatrixBlocks *blocks) {
  size_t vertices = (size_t)blocks->vertex_count, most = (size_t)blocks->entry_count / PIECE_SIZE + 2;
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
    cut_pieces(blocks);
    status = make_gifts(blocks, piece_of, scratch);
  }
  memory_free(piece_of), memory_free(scratch);
  return fits ? status : no_memory();
}

static Status lay_out(FemMatrixBlocks *blocks, const FemPattern *pattern, const int *unknown_of_dof) {
  size_t entry_count = 0;
  TRY(number_vertices(blocks, unknown_of_dof));
  TRY(lay_blocks(blocks, pattern, &entry_count));
  TRY(transpose_blocks(blocks));
  TRY(lay_entries(blocks, entry_count));
  return divide_products(blocks);
}

Status fem_matrix_blocks_create(FemMatrixBlocks **blocks, const FemPattern *pattern,
                                const int *unknown_of_dof) {
  FemMatrixBlocks *made = *blocks = memory_zeroed(1, sizeof *made);
  if (!made) return no_memory();
  made->reference_count = 1;
  made->vertex_count = fem_pattern_vertex_count(pattern);
  return lay_out(made, pattern, unknown_of_dof);
}

// Whether the blocks of the vertex are those of the pattern.
static bool fits_vertex(const FemMatrixBlocks *blocks, const FemPattern *pattern, int v) {
  int count, at = blocks->above_begin[v];
  const int *above = fem_pattern_above(pattern, v, &count);
  for (int k = 0; k < count && blocks->active[v]; k++) {
    if (!blocks->active[above[k]]) continue;
    if (at == blocks->above_begin[v + 1] || blocks->above[at++] != above[k]) return false;
  }
  return at == blocks->above_begin[v + 1];
}

bool fem_matrix_blocks_fit(const FemMatrixBlocks *blocks, const FemPattern *pattern,
                           const int *unknown_of_dof) {
  if (blocks->vertex_count != fem_pattern_vertex_count(pattern)) return false;
  int next = 0;
  for (int v = 0; v < blocks->vertex_count; v++) {
    if (next != blocks->first[v]) return false;
    for (int c = 0; c < 3; c++) next += unknown_of_dof[3 * v + c] >= 0;
    if (next - blocks->first[v] != blocks->active[v]) return false;
  }
  for (int v = 0; v < blocks->vertex_count; v++)
    if (!fits_vertex(blocks, pattern, v)) return false;
  return true;
}

void fem_matrix_blocks_release(FemMatrixBlocks *blocks) {
  if (!blocks || --blocks->reference_count > 0) return;
  memory_free(blocks->col_begin), memory_free(blocks->row);
  memory_free(blocks->first), memory_free(blocks->active);
  memory_free(blocks->above_begin), memory_free(blocks->above), memory_free(blocks->row_offset);
  memory_free(blocks->below_begin), memory_free(blocks->below), memory_free(blocks->below_offset);
  memory_free(blocks->piece_begin), memory_free(blocks->target), memory_free(blocks->gift_begin);
  memory_free(blocks->gifts), memory_free(blocks->kept), memory_free(blocks->kept_begin);
  memory_free(blocks);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/front/tree.h"

#include <limits.h>

#include "base/memory.h"

// A subtree with more than this share of all work is divided.
static const double DOMAIN_SHARE = 1.0 / 24;

// While the tree is made.
typedef struct Maker {
  const FemFrontDef *def;
  FemFrontTree *tree;
  int *start; // first unknown in the order of elimination, of each place    (node_count + 1)
  int *place; // of each node                                               (node_count)
  int *front; // of each place                                              (node_count)
  int *local; // row of each place in the front that is being made, else −1  (node_count)
  int *next;  // of each front: the block to be written next                (front_count + 1)
} Maker;

static Status no_memory(void) {
  return status_no_memory("the tree of the factor");
}

static int width_of(const FemFrontDef *def, int node) {
  return def->first[node + 1] - def->first[node];
}

static Status number_places(Maker *maker) {
  const FemFrontDef *def = maker->def;
  size_t nodes = (size_t)def->node_count, fronts = (size_t)def->front_count;
  FemFrontTree *tree = maker->tree;
  tree->size = def->first[def->node_count];
  tree->front_count = def->front_count;
  tree->fronts = memory_zeroed(fronts, sizeof *tree->fronts);
  tree->unknown = memory_zeroed((size_t)tree->size, sizeof *tree->unknown);
  maker->start = memory_zeroed(nodes + 1, sizeof *maker->start);
  maker->place = memory_zeroed(nodes, sizeof *maker->place);
  maker->front = memory_zeroed(nodes, sizeof *maker->front);
  maker->local = memory_zeroed(nodes, sizeof *maker->local);
  maker->next = memory_zeroed(fronts + 1, sizeof *maker->next);
  if (!tree->fronts || !tree->unknown || !maker->start || !maker->place || !maker->front || !maker->local ||
      !maker->next)
    return no_memory();
  int end = 0;
  for (int p = 0; p < def->node_count; p++) {
    int node = def->order[p];
    maker->place[node] = p;
    maker->start[p] = end;
    for (int u = def->first[node]; u < def->first[node + 1]; u++) tree->unknown[end++] = u;
  }
  maker->start[def->node_count] = end;
  for (int f = 0; f < def->front_count; f++)
    for (int p = def->place[f]; p < def->place[f + 1]; p++) maker->front[p] = f;
  return STATUS_OK;
}

// Multiplications of a front by itself.
static double work_of(const FemFront *front) {
  double own = front->own, height = front->height;
  return own * height * height - own * own * height + own * own * own / 3;
}

static void measure_fronts(Maker *maker) {
  const FemFrontDef *def = maker->def;
  FemFrontTree *tree = maker->tree;
  for (int f = 0; f < def->front_count; f++) {
    FemFront *front = &tree->fronts[f];
    int own_nodes = def->place[f + 1] - def->place[f], below = def->row_begin[f] + own_nodes;
    front->begin = maker->start[def->place[f]];
    front->own = maker->start[def->place[f + 1]] - front->begin;
    front->height = front->own;
    for (int k = below; k < def->row_begin[f + 1]; k++)
      front->height += maker->start[def->rows[k] + 1] - maker->start[def->rows[k]];
    front->parent = below < def->row_begin[f + 1] ? maker->front[def->rows[below]] : -1;
    front->values = tree->value_count;
    front->carried = tree->carried_count;
    tree->value_count += (size_t)front->own * (size_t)front->height;
    tree->carried_count += (size_t)(front->height - front->own);
    tree->entry_count += (double)front->own * front->height - 0.5 * front->own * (front->own - 1.0);
    front->first = f;
  }
}

static Status list_children(FemFrontTree *tree) {
  size_t count = (size_t)tree->front_count;
  tree->child_begin = memory_zeroed(count + 2, sizeof *tree->child_begin);
  tree->children = memory_zeroed(count, sizeof *tree->children);
  if (!tree->child_begin || !tree->children) return no_memory();
  int *end = tree->child_begin + 1; // of the front before: becomes where each ends
  for (int f = 0; f < tree->front_count; f++)
    if (tree->fronts[f].parent >= 0) end[tree->fronts[f].parent + 1]++;
  for (int f = 0; f < tree->front_count; f++) end[f + 1] += end[f];
  for (int f = 0; f < tree->front_count; f++)
    if (tree->fronts[f].parent >= 0) tree->children[end[tree->fronts[f].parent]++] = f;
  return STATUS_OK;
}

// Work of subtrees, and which of them are domains.
static void choose_domains(FemFrontTree *tree) {
  double all = 0;
  for (int f = 0; f < tree->front_count; f++) tree->fronts[f].work = work_of(&tree->fronts[f]);
  for (int f = 0; f < tree->front_count; f++) {
    const FemFront *front = &tree->fronts[f];
    if (front->parent < 0) {
      all += front->work;
      continue;
    }
    FemFront *parent = &tree->fronts[front->parent];
    parent->work += front->work;
    if (front->first < parent->first) parent->first = front->first;
  }
  for (int f = 0; f < tree->front_count; f++) {
    FemFront *front = &tree->fronts[f];
    front->is_top = front->first < f && front->work > DOMAIN_SHARE * all;
  }
}

// What a domain holds at once of its fronts' updates: those of the children are freed once they are added.
static void measure_stack(FemFrontTree *tree) {
  size_t held = 0;
  for (int f = 0; f < tree->front_count; f++) {
    const FemFront *front = &tree->fronts[f];
    if (front->is_top) continue;
    size_t below = (size_t)(front->height - front->own);
    bool is_root = front->parent < 0 || tree->fronts[front->parent].is_top;
    if (!is_root) held += below * below;
    if (held > tree->stack) tree->stack = held;
    for (int c = tree->child_begin[f]; c < tree->child_begin[f + 1]; c++) {
      const FemFront *child = &tree->fronts[tree->children[c]];
      held -= (size_t)(child->height - child->own) * (size_t)(child->height - child->own);
    }
  }
}

// The rows below of a front by consecutive unknowns, and by consecutive rows of the parent. `spans` and
// `runs` NULL: only counted.
static void cut_rows(const Maker *maker, int f, FemFrontSpan *spans, int *span_count, FemFrontRun *runs,
                     int *run_count) {
  const FemFrontDef *def = maker->def;
  const int *rows = def->rows, parent = maker->tree->fronts[f].parent;
  int below = def->row_begin[f] + def->place[f + 1] - def->place[f], from = 0, to = 0, last = -2, to_end = -1;
  int at = parent >= 0 ? def->row_begin[parent] : 0,
      parent_own = parent >= 0 ? maker->tree->fronts[parent].own : 0;
  *span_count = *run_count = 0;
  for (int k = below; k < def->row_begin[f + 1]; k++) {
    int width = maker->start[rows[k] + 1] - maker->start[rows[k]];
    for (; rows[at] != rows[k]; at++) to += maker->start[rows[at] + 1] - maker->start[rows[at]];
    if (rows[k] != last + 1) {
      if (spans) spans[*span_count] = (FemFrontSpan){maker->start[rows[k]], 0};
      ++*span_count;
    }
    if (to != to_end || to == parent_own) {
      if (runs) runs[*run_count] = (FemFrontRun){from, to, 0};
      ++*run_count;
    }
    if (spans) spans[*span_count - 1].count += width;
    if (runs) runs[*run_count - 1].count += width;
    last = rows[k];
    from += width;
    to_end = to + width;
  }
}

static Status list_rows(Maker *maker) {
  FemFrontTree *tree = maker->tree;
  size_t spans = 0, runs = 0;
  int span_count, run_count;
  for (int f = 0; f < tree->front_count; f++) {
    cut_rows(maker, f, NULL, &span_count, NULL, &run_count);
    spans += (size_t)span_count, runs += (size_t)run_count;
  }
  if (spans > INT_MAX || runs > INT_MAX)
    return status_fail(STATUS_SOLVER,
                       "cholmod: the factor is too large to be numbered: use solver.linear: pcg");
  tree->spans = memory_zeroed(spans, sizeof *tree->spans);
  tree->runs = memory_zeroed(runs, sizeof *tree->runs);
  if (!tree->spans || !tree->runs) return no_memory();
  int span = 0, run = 0;
  for (int f = 0; f < tree->front_count; f++) {
    FemFront *front = &tree->fronts[f];
    cut_rows(maker, f, tree->spans + span, &span_count, tree->runs + run, &run_count);
    front->span_begin = span, front->run_begin = run;
    front->span_end = span += span_count, front->run_end = run += run_count;
  }
  return STATUS_OK;
}

static int smaller(int a, int b) {
  return a < b ? a : b;
}

// The front that has the entries of two nodes.
static int front_of(const Maker *maker, int node, int other) {
  return maker->front[smaller(maker->place[node], maker->place[other])];
}

static Status count_blocks(Maker *maker) {
  const FemFrontDef *def = maker->def;
  FemFrontTree *tree = maker->tree;
  for (int v = 0; v < def->node_count; v++)
    for (int k = def->begin[v]; k < def->begin[v + 1]; k++)
      maker->next[front_of(maker, v, def->row[k]) + 1]++;
  for (int f = 0; f < tree->front_count; f++) {
    maker->next[f + 1] += maker->next[f];
    tree->fronts[f].block_begin = maker->next[f];
    tree->fronts[f].block_end = maker->next[f + 1];
  }
  tree->blocks = memory_zeroed((size_t)def->begin[def->node_count], sizeof *tree->blocks);
  return tree->blocks ? STATUS_OK : no_memory();
}

// Where the graph's entry k stands in the matrix and which places it couples; `row` and `column` as places.
static FemFrontBlock block_of(const Maker *maker, int v, int w, int offset) {
  const FemFrontDef *def = maker->def;
  int width = width_of(def, v), own = maker->place[v], other = maker->place[w];
  FemFrontBlock block = {.row = own < other ? other : own,
                         .column = smaller(own, other),
                         .width = (signed char)width,
                         .height = (signed char)width_of(def, w),
                         .is_own = v == w,
                         .is_turned = other < own};
  for (int c = 0; c < width; c++)
    block.source[c] = def->col_begin[def->first[v] + c] + (v == w ? 0 : width - c + offset);
  return block;
}

static void write_blocks(Maker *maker) {
  const FemFrontDef *def = maker->def;
  for (int v = 0; v < def->node_count; v++) {
    int offset = 0;
    for (int k = def->begin[v]; k < def->begin[v + 1]; k++) {
      int w = def->row[k];
      maker->tree->blocks[maker->next[front_of(maker, v, w)]++] = block_of(maker, v, w, offset);
      if (w != v) offset += width_of(def, w);
    }
  }
}

// From places to rows and columns of the panel.
static void settle_blocks(Maker *maker) {
  const FemFrontDef *def = maker->def;
  for (int f = 0; f < def->front_count; f++) {
    const FemFront *front = &maker->tree->fronts[f];
    int row = 0;
    for (int k = def->row_begin[f]; k < def->row_begin[f + 1]; k++) {
      int place = def->rows[k];
      maker->local[place] = row;
      row += maker->start[place + 1] - maker->start[place];
    }
    for (int b = front->block_begin; b < front->block_end; b++) {
      FemFrontBlock *block = &maker->tree->blocks[b];
      block->row = maker->local[block->row];
      block->column = maker->local[block->column];
    }
  }
}

// Of what outlives a domain.
static void place_left(FemFrontTree *tree) {
  for (int f = 0; f < tree->front_count; f++) {
    FemFront *front = &tree->fronts[f];
    size_t below = (size_t)(front->height - front->own);
    bool outlives = front->is_top || front->parent < 0 || tree->fronts[front->parent].is_top;
    front->left = tree->left_count;
    if (outlives) tree->left_count += below * below;
  }
}

static Status make(Maker *maker) {
  TRY(number_places(maker));
  measure_fronts(maker);
  TRY(list_children(maker->tree));
  choose_domains(maker->tree);
  measure_stack(maker->tree);
  place_left(maker->tree);
  TRY(list_rows(maker));
  TRY(count_blocks(maker));
  write_blocks(maker);
  settle_blocks(maker);
  return STATUS_OK;
}

Status fem_front_tree_create(FemFrontTree *tree, const FemFrontDef *def) {
  *tree = (FemFrontTree){0};
  Maker maker = {.def = def, .tree = tree};
  Status status = make(&maker);
  memory_free(maker.start), memory_free(maker.place), memory_free(maker.front);
  memory_free(maker.local), memory_free(maker.next);
  if (status) fem_front_tree_destroy(tree);
  return status;
}

void fem_front_tree_destroy(FemFrontTree *tree) {
  memory_free(tree->fronts), memory_free(tree->child_begin), memory_free(tree->children);
  memory_free(tree->unknown), memory_free(tree->runs), memory_free(tree->spans), memory_free(tree->blocks);
  *tree = (FemFrontTree){0};
}

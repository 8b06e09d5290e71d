// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/search/boxes.h"

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"

// Boxes of a group; groups above each other, enough for any number of boxes that an int can count.
enum { GROUP_SIZE = 8, LEVEL_COUNT = 11 };
// Bits and cells along each axis of the grid by which boxes are put in order.
enum { KEY_SIZE = 10, CELL_COUNT = 1 << KEY_SIZE };
// Boxes of the first sequence that are looked for at once, or as many as make PIECE_COUNT pieces.
enum { PIECE_SIZE = 64, PIECE_COUNT = 256 };

#if defined(__x86_64__) && !defined(__clang__)
#define FASTEST __attribute__((target_clones("avx2", "default")))
#else
#define FASTEST
#endif

// The bounds of some boxes, or of some groups, side by side; what is left over meets nothing.
typedef struct Group {
  double low[3][GROUP_SIZE], high[3][GROUP_SIZE];
} Group;

typedef struct Tree {
  int *order; // of the boxes; GROUP_SIZE of them are a group                 (count)
  int levels;
  Group *groups[LEVEL_COUNT]; // of boxes; of groups of the level before; up to a level with one group
} Tree;

static void destroy_tree(Tree *tree) {
  memory_free(tree->order);
  for (int l = 0; l < tree->levels; l++) memory_free(tree->groups[l]);
}

// ---- The order of boxes.

// Bits are moved apart: two places are left between each and the next.
static uint32_t spread_bits(uint32_t x) {
  x = (x | x << 16) & 0x030000ff;
  x = (x | x << 8) & 0x0300f00f;
  x = (x | x << 4) & 0x030c30c3;
  return (x | x << 2) & 0x09249249;
}

// Where the middle of a box stands on the curve that goes through the cells of a grid in the order of their
// bits, x, y and z in turn (Morton 1966).
static uint32_t key_of(const double box[6], const double low[3], const double high[3]) {
  uint32_t key = 0;
  for (int c = 0; c < 3; c++) {
    double at = (box[c] / 2 + box[c + 3] / 2 - low[c]) / (high[c] - low[c]) * CELL_COUNT;
    uint32_t cell = !(at > 0) ? 0 : at < CELL_COUNT ? (uint32_t)at : CELL_COUNT - 1;
    key |= spread_bits(cell) << c;
  }
  return key;
}

static void find_keys(const double (*boxes)[6], int count, uint32_t *keys) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int k = 0; k < count; k++)
    for (int c = 0; c < 3; c++) low[c] = fmin(low[c], boxes[k][c]), high[c] = fmax(high[c], boxes[k][c + 3]);
  for (int k = 0; k < count; k++) keys[k] = key_of(boxes[k], low, high);
}

// Numbers `from` by a part of their keys; those that are equal there keep their order.
static void sort_by_part(const uint32_t *keys, int shift, int count, const int *from, int *to) {
  int begin[CELL_COUNT + 1] = {0};
  for (int k = 0; k < count; k++) begin[(keys[from[k]] >> shift) % CELL_COUNT + 1]++;
  for (int k = 0; k < CELL_COUNT; k++) begin[k + 1] += begin[k];
  for (int k = 0; k < count; k++) to[begin[(keys[from[k]] >> shift) % CELL_COUNT]++] = from[k];
}

static Status put_in_order(Tree *tree, const double (*boxes)[6], int count) {
  uint32_t *keys = memory_zeroed((size_t)count, sizeof *keys);
  int *between = memory_zeroed((size_t)count, sizeof *between);
  tree->order = memory_zeroed((size_t)count, sizeof *tree->order);
  Status status = keys && between && tree->order ? STATUS_OK : status_no_memory("pairs of boxes");
  if (!status) {
    find_keys(boxes, count, keys);
    for (int k = 0; k < count; k++) between[k] = k;
    sort_by_part(keys, 0, count, between, tree->order);
    sort_by_part(keys, KEY_SIZE, count, tree->order, between);
    sort_by_part(keys, 2 * KEY_SIZE, count, between, tree->order);
  }
  memory_free(keys);
  memory_free(between);
  return status;
}

// ---- Groups.

static void bound_group(const Group *group, double box[6]) {
  for (int c = 0; c < 3; c++) {
    box[c] = INFINITY, box[c + 3] = -INFINITY;
    for (int k = 0; k < GROUP_SIZE; k++)
      box[c] = fmin(box[c], group->low[c][k]), box[c + 3] = fmax(box[c + 3], group->high[c][k]);
  }
}

static void set_lane(Group *group, int k, const double box[6]) {
  for (int c = 0; c < 3; c++) group->low[c][k] = box[c], group->high[c][k] = box[c + 3];
}

static const double nothing[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};

static void fill_level(Tree *tree, int level, const double (*boxes)[6], int count) {
  for (int i = 0; i < (count + GROUP_SIZE - 1) / GROUP_SIZE * GROUP_SIZE; i++) {
    Group *group = &tree->groups[level][i / GROUP_SIZE];
    double box[6];
    if (i < count && level > 0) bound_group(&tree->groups[level - 1][i], box);
    set_lane(group, i % GROUP_SIZE, i >= count ? nothing : level > 0 ? box : boxes[tree->order[i]]);
  }
}

static Status make_tree(Tree *tree, const double (*boxes)[6], int count) {
  TRY(put_in_order(tree, boxes, count));
  for (int items = count; tree->levels == 0 || items > 1; items = (items + GROUP_SIZE - 1) / GROUP_SIZE) {
    Group *groups = memory_zeroed((size_t)items / GROUP_SIZE + 1, sizeof *groups);
    if (!groups) return status_no_memory("pairs of boxes");
    tree->groups[tree->levels] = groups;
    fill_level(tree, tree->levels++, boxes, items);
  }
  return STATUS_OK;
}

// ---- Pairs.

static inline void meet(const Group *group, const double box[6], int64_t hits[GROUP_SIZE]) {
  for (int k = 0; k < GROUP_SIZE; k++)
    hits[k] = (group->low[0][k] <= box[3]) & (group->high[0][k] >= box[0]) & (group->low[1][k] <= box[4]) &
              (group->high[1][k] >= box[1]) & (group->low[2][k] <= box[5]) & (group->high[2][k] >= box[2]);
}

// Those of one box: from the top down, by a list of what is still to be looked into.
FASTEST
static bool find_box(const Tree *tree, const double box[6], int number, ContactBoxPairs *found) {
  struct {
    int level, group;
  } open[LEVEL_COUNT * GROUP_SIZE] = {{tree->levels - 1, 0}};
  int open_count = 1;
  while (open_count > 0) {
    int level = open[--open_count].level, first = GROUP_SIZE * open[open_count].group;
    int64_t hits[GROUP_SIZE];
    meet(&tree->groups[level][first / GROUP_SIZE], box, hits);
    for (int k = GROUP_SIZE - 1; k >= 0 && level > 0; k--)
      if (hits[k]) open[open_count].level = level - 1, open[open_count++].group = first + k;
    for (int k = 0; k < GROUP_SIZE && level == 0; k++) {
      if (!hits[k]) continue;
      if (!memory_reserve((void **)&found->pairs, &found->capacity, found->count + 1, sizeof *found->pairs))
        return false;
      int *pair = found->pairs[found->count++];
      pair[0] = number, pair[1] = tree->order[first + k];
    }
  }
  return true;
}

// Pieces are looked for side by side, and what they find is put together in their order.
typedef struct Search {
  const double (*boxes)[6];
  int count, piece, piece_count;
  Tree tree;
  ContactBoxPairs *found; // of each piece                     (piece_count)
} Search;

static Status find_pieces(Search *search) {
  int failures = 0;
#pragma omp parallel for schedule(dynamic) reduction(+ : failures) if (search->piece_count > 4)
  for (int p = 0; p < search->piece_count; p++) {
    int begin = p * search->piece, left = search->count - begin;
    for (int k = begin; k < begin + (left < search->piece ? left : search->piece); k++)
      if (!find_box(&search->tree, search->boxes[k], k, &search->found[p])) {
        failures++;
        break;
      }
  }
  return failures == 0 ? STATUS_OK : status_no_memory("pairs of boxes");
}

static Status put_together(const Search *search, ContactBoxPairs *out) {
  size_t wanted = out->count;
  for (int p = 0; p < search->piece_count; p++) wanted += search->found[p].count;
  if (!memory_reserve((void **)&out->pairs, &out->capacity, wanted, sizeof *out->pairs))
    return status_no_memory("pairs of boxes");
  for (int p = 0; p < search->piece_count; p++) {
    size_t count = search->found[p].count;
    if (count > 0) memcpy(out->pairs + out->count, search->found[p].pairs, count * sizeof *out->pairs);
    out->count += count;
  }
  return STATUS_OK;
}

Status contact_boxes_intersect(const double (*boxes_a)[6], int count_a, const double (*boxes_b)[6],
                               int count_b, ContactBoxPairs *out) {
  if (count_a <= 0 || count_b <= 0) return STATUS_OK;
  int piece = count_a > PIECE_COUNT * PIECE_SIZE ? (count_a - 1) / PIECE_COUNT + 1 : PIECE_SIZE;
  Search search = {
      .boxes = boxes_a, .count = count_a, .piece = piece, .piece_count = (count_a - 1) / piece + 1};
  Status status = make_tree(&search.tree, boxes_b, count_b);
  search.found = memory_zeroed((size_t)search.piece_count, sizeof *search.found);
  if (!status && !search.found) status = status_no_memory("pairs of boxes");
  if (!status) status = find_pieces(&search);
  if (!status) status = put_together(&search, out);
  for (int p = 0; p < search.piece_count && search.found; p++) contact_boxes_destroy(&search.found[p]);
  memory_free(search.found);
  destroy_tree(&search.tree);
  return status;
}

void contact_boxes_destroy(ContactBoxPairs *pairs) {
  memory_free(pairs->pairs);
  *pairs = (ContactBoxPairs){0};
}

// SPDX-License-Identifier: Apache-2.0
#include "overlap/api/sweep.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

// Columns across y and z, over the bounds that both sets have in common.
typedef struct Columns {
  OverlapApiBox bounds;
  int count[2];       // along y, z
  double per_unit[2]; // columns per length
} Columns;

// A set's boxes within the common bounds: in the order in which they begin along x, and in columns.
typedef struct Entries {
  const OverlapApiBox *boxes; // borrowed
  int box_count;
  struct Begin {
    double low;
    int32_t box;
  } * order; // (order_count)
  int order_count;
  size_t *begin; // of each column in `entry`   (columns + 1)
  int32_t *entry;
} Entries;

static bool overlap(const OverlapApiBox *a, const OverlapApiBox *b) {
  bool is_apart = false;
  for (int c = 0; c < 3; c++) is_apart |= !(a->low[c] < b->high[c] && b->low[c] < a->high[c]);
  return !is_apart;
}

static OverlapApiBox bounds_of(const OverlapApiBox *boxes, int count) {
  OverlapApiBox bounds = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (int b = 0; b < count; b++)
    for (int c = 0; c < 3; c++) {
      bounds.low[c] = fmin(bounds.low[c], boxes[b].low[c]);
      bounds.high[c] = fmax(bounds.high[c], boxes[b].high[c]);
    }
  return bounds;
}

static OverlapApiBox common_of(const OverlapApiBox *a, const OverlapApiBox *b) {
  OverlapApiBox common;
  for (int c = 0; c < 3; c++) {
    common.low[c] = fmax(a->low[c], b->low[c]);
    common.high[c] = fmin(a->high[c], b->high[c]);
  }
  return common;
}

static int by_begin(const void *a, const void *b) {
  const struct Begin *x = a, *y = b;
  if (x->low != y->low) return x->low < y->low ? -1 : 1;
  return (x->box > y->box) - (x->box < y->box);
}

static Status sort_entries(Entries *entries, const OverlapApiBox *bounds) {
  entries->order = memory_zeroed((size_t)entries->box_count, sizeof *entries->order);
  if (!entries->order) return status_no_memory("the boxes of a mesh");
  for (int b = 0; b < entries->box_count; b++)
    if (overlap(&entries->boxes[b], bounds))
      entries->order[entries->order_count++] = (struct Begin){entries->boxes[b].low[0], b};
  qsort(entries->order, (size_t)entries->order_count, sizeof *entries->order, by_begin);
  return STATUS_OK;
}

// Two mean boxes wide.
static void choose_columns(Columns *columns, const Entries sets[2]) {
  int box_count = sets[0].order_count + sets[1].order_count;
  for (int d = 0; d < 2; d++) {
    double sum = 0, range = columns->bounds.high[d + 1] - columns->bounds.low[d + 1];
    for (int s = 0; s < 2; s++)
      for (int k = 0; k < sets[s].order_count; k++) {
        const OverlapApiBox *box = &sets[s].boxes[sets[s].order[k].box];
        sum += box->high[d + 1] - box->low[d + 1];
      }
    double wanted = sum > 0 ? range * box_count / (2 * sum) : 1;
    columns->count[d] = (int)fmax(1, fmin(wanted, sqrt(box_count)));
    columns->per_unit[d] = columns->count[d] / range;
  }
}

static void halve_columns(Columns *columns) {
  for (int d = 0; d < 2; d++) {
    columns->count[d] = (columns->count[d] + 1) / 2;
    columns->per_unit[d] = columns->count[d] / (columns->bounds.high[d + 1] - columns->bounds.low[d + 1]);
  }
}

static int column_at(const Columns *columns, int d, double x) {
  double at = (x - columns->bounds.low[d + 1]) * columns->per_unit[d];
  if (!(at > 0)) return 0;
  return at < columns->count[d] ? (int)at : columns->count[d] - 1;
}

// The columns that a box touches: [d][from, to].
typedef struct Span {
  int at[2][2];
} Span;

static Span span_of(const Columns *columns, const OverlapApiBox *box) {
  Span span;
  for (int d = 0; d < 2; d++) {
    span.at[d][0] = column_at(columns, d, box->low[d + 1]);
    span.at[d][1] = column_at(columns, d, box->high[d + 1]);
  }
  return span;
}

static size_t count_entries(const Columns *columns, const Entries *entries) {
  size_t count = 0;
  for (int k = 0; k < entries->order_count; k++) {
    Span span = span_of(columns, &entries->boxes[entries->order[k].box]);
    count += (size_t)(span.at[0][1] - span.at[0][0] + 1) * (size_t)(span.at[1][1] - span.at[1][0] + 1);
  }
  return count;
}

// Calls for each column of each box, in the order along x: with `entry` NULL counts into begin[column + 1],
// else enters the boxes and moves begin[column] on.
static void walk_columns(const Columns *columns, Entries *entries) {
  for (int k = 0; k < entries->order_count; k++) {
    int32_t box = entries->order[k].box;
    Span span = span_of(columns, &entries->boxes[box]);
    for (int y = span.at[0][0]; y <= span.at[0][1]; y++)
      for (int z = span.at[1][0]; z <= span.at[1][1]; z++) {
        size_t column = (size_t)y * (size_t)columns->count[1] + (size_t)z;
        if (entries->entry)
          entries->entry[entries->begin[column]++] = box;
        else
          entries->begin[column + 1]++;
      }
  }
}

static Status fill_columns(const Columns *columns, Entries *entries) {
  size_t count = (size_t)columns->count[0] * (size_t)columns->count[1];
  entries->begin = memory_zeroed(count + 1, sizeof *entries->begin);
  if (!entries->begin) return status_no_memory("the columns of a mesh");
  walk_columns(columns, entries);
  for (size_t k = 0; k < count; k++) entries->begin[k + 1] += entries->begin[k];
  entries->entry = memory_zeroed(entries->begin[count], sizeof *entries->entry);
  if (!entries->entry) return status_no_memory("the columns of a mesh");
  walk_columns(columns, entries);
  for (size_t k = count; k > 0; k--) entries->begin[k] = entries->begin[k - 1];
  entries->begin[0] = 0;
  return STATUS_OK;
}

// A walk along one column.
typedef struct Walk {
  const Columns *columns;
  const Entries *sets; // the two
  int column[2];       // y, z
  OverlapApiCandidates *candidates;
} Walk;

static bool is_first_column(const Walk *walk, const OverlapApiBox *a, const OverlapApiBox *b) {
  for (int d = 0; d < 2; d++)
    if (column_at(walk->columns, d, fmax(a->low[d + 1], b->low[d + 1])) != walk->column[d]) return false;
  return true;
}

static Status offer(const Walk *walk, int32_t first, int32_t second) {
  const OverlapApiBox *a = &walk->sets[0].boxes[first], *b = &walk->sets[1].boxes[second];
  if (!overlap(a, b) || !is_first_column(walk, a, b)) return STATUS_OK;
  OverlapApiCandidates *candidates = walk->candidates;
  if (!memory_reserve((void **)&candidates->at, &candidates->capacity, candidates->count + 1,
                      sizeof *candidates->at))
    return status_no_memory("the list of candidate pairs");
  candidates->at[candidates->count++] = (OverlapApiCandidate){first, second};
  return STATUS_OK;
}

// Offers the boxes of a list, from `from` on, that begin before `box` ends.
static Status meet(const Walk *walk, int set, int32_t box, const int32_t *from, const int32_t *end) {
  double high = walk->sets[set].boxes[box].high[0];
  const OverlapApiBox *others = walk->sets[1 - set].boxes;
  for (; from < end && others[*from].low[0] < high; from++)
    TRY(offer(walk, set == 0 ? box : *from, set == 0 ? *from : box));
  return STATUS_OK;
}

static Status walk_column(const Walk *walk, size_t column) {
  const int32_t *at[2], *end[2];
  for (int s = 0; s < 2; s++) {
    at[s] = walk->sets[s].entry + walk->sets[s].begin[column];
    end[s] = walk->sets[s].entry + walk->sets[s].begin[column + 1];
  }
  while (at[0] < end[0] && at[1] < end[1]) {
    int s = !(walk->sets[0].boxes[*at[0]].low[0] <= walk->sets[1].boxes[*at[1]].low[0]);
    TRY(meet(walk, s, *at[s], at[1 - s], end[1 - s]));
    at[s]++;
  }
  return STATUS_OK;
}

// Copies candidates in the order of one of their numbers, which is below `most`; equal ones stay as they
// stand. `begin` (most + 1) is scratch.
static void order_by(const OverlapApiCandidate *from, size_t count, bool by_second, int most, size_t *begin,
                     OverlapApiCandidate *to) {
  memset(begin, 0, ((size_t)most + 1) * sizeof *begin);
  for (size_t k = 0; k < count; k++) begin[(by_second ? from[k].second : from[k].first) + 1]++;
  for (int n = 0; n < most; n++) begin[n + 1] += begin[n];
  for (size_t k = 0; k < count; k++) to[begin[by_second ? from[k].second : from[k].first]++] = from[k];
}

static Status sort_candidates(OverlapApiCandidates *candidates, const Entries sets[2]) {
  int counts[2] = {sets[0].box_count, sets[1].box_count}, most = counts[counts[1] > counts[0]];
  OverlapApiCandidate *other = memory_zeroed(candidates->count, sizeof *other);
  size_t *begin = memory_zeroed((size_t)most + 1, sizeof *begin);
  if (other && begin) {
    order_by(candidates->at, candidates->count, true, counts[1], begin, other);
    order_by(other, candidates->count, false, counts[0], begin, candidates->at);
  }
  Status status = other && begin ? STATUS_OK : status_no_memory("the list of candidate pairs");
  memory_free(other);
  memory_free(begin);
  return status;
}

static Status walk_all(const Columns *columns, const Entries sets[2], OverlapApiCandidates *candidates) {
  for (int y = 0; y < columns->count[0]; y++)
    for (int z = 0; z < columns->count[1]; z++) {
      Walk walk = {columns, sets, {y, z}, candidates};
      TRY(walk_column(&walk, (size_t)y * (size_t)columns->count[1] + (size_t)z));
    }
  return sort_candidates(candidates, sets);
}

// Entries that a box may have on average, before columns are made wider.
enum { MOST_ENTRIES = 16 };

static Status find(Entries sets[2], OverlapApiCandidates *candidates) {
  OverlapApiBox bounds[2] = {bounds_of(sets[0].boxes, sets[0].box_count),
                             bounds_of(sets[1].boxes, sets[1].box_count)};
  Columns columns = {.bounds = common_of(&bounds[0], &bounds[1])};
  for (int s = 0; s < 2; s++) TRY(sort_entries(&sets[s], &columns.bounds));
  size_t box_count = (size_t)sets[0].order_count + (size_t)sets[1].order_count;
  if (sets[0].order_count == 0 || sets[1].order_count == 0) return STATUS_OK;
  choose_columns(&columns, sets);
  while (count_entries(&columns, &sets[0]) + count_entries(&columns, &sets[1]) > MOST_ENTRIES * box_count)
    halve_columns(&columns);
  for (int s = 0; s < 2; s++) TRY(fill_columns(&columns, &sets[s]));
  return walk_all(&columns, sets, candidates);
}

Status overlap_api_sweep_find(const OverlapApiBox *first, int first_count, const OverlapApiBox *second,
                              int second_count, OverlapApiCandidates *candidates) {
  Entries sets[2] = {{.boxes = first, .box_count = first_count},
                     {.boxes = second, .box_count = second_count}};
  Status status = find(sets, candidates);
  for (int s = 0; s < 2; s++) {
    memory_free(sets[s].order);
    memory_free(sets[s].begin);
    memory_free(sets[s].entry);
  }
  return status;
}

void overlap_api_sweep_destroy(OverlapApiCandidates *candidates) {
  memory_free(candidates->at);
  *candidates = (OverlapApiCandidates){0};
}

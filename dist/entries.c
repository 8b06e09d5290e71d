// SPDX-License-Identifier: GPL-3.0-or-later
#include "dist/entries.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/ranks.h"

static Status agree(bool is_ok) {
  return ranks()->worst(is_ok ? STATUS_OK : status_no_memory("the condensed matrix"));
}

// Vertices that are this rank's, or that a clique of its own has: to others it adds nothing.
static Status find_touched(DistEntries *entries, const FemMatrix *matrix) {
  const FemShare *share = matrix->share;
  int *vertex_of = memory_zeroed((size_t)matrix->size, sizeof *vertex_of);
  entries->is_touched = memory_zeroed((size_t)matrix->vertex_count, sizeof *entries->is_touched);
  Status status = agree(vertex_of && entries->is_touched);
  for (int v = 0; v < matrix->vertex_count && !status; v++) {
    entries->is_touched[v] = share->owner[v] == share->rank;
    for (int c = 0; c < 3; c++) {
      int unknown = matrix->unknown_of_dof[3 * (size_t)v + (size_t)c];
      if (unknown >= 0) vertex_of[unknown] = v;
    }
  }
  for (int u = 0; u < matrix->size && !status; u++)
    for (int k = matrix->col_begin[u]; k < matrix->col_begin[u + 1]; k++)
      if (vertex_of[matrix->row[k]] != vertex_of[u])
        entries->is_touched[vertex_of[u]] = entries->is_touched[vertex_of[matrix->row[k]]] = true;
  memory_free(vertex_of);
  return status;
}

// What is done with an entry of the whole matrix that this rank adds to.
typedef void Visit(DistEntries *entries, int row, int column, double value);

// Each entry of the lower triangle that this rank may add to, and its mirror image.
static void walk(DistEntries *entries, const FemMatrix *matrix, Visit *visit) {
  entries->given_at = entries->given_begin[ranks()->number];
  entries->slot_at = 0;
  for (int v = 0; v < matrix->vertex_count; v++) {
    if (!entries->is_touched[v]) continue;
    for (int c = 0; c < 3; c++) {
      int u = matrix->unknown_of_dof[3 * (size_t)v + (size_t)c];
      if (u < 0) continue;
      for (int k = matrix->col_begin[u]; k < matrix->col_begin[u + 1]; k++) {
        int row = entries->rows->row[matrix->row[k]], column = entries->rows->row[u];
        visit(entries, row, column, matrix->value[k]);
        if (row != column) visit(entries, column, row, matrix->value[k]);
      }
    }
  }
}

// Counts stand two places behind a row, so that sums of them end one behind, where rows are filled from.
static void count_entry(DistEntries *entries, int row, int column, double value) {
  (void)column, (void)value;
  if (dist_rows_have(entries->rows, row))
    entries->row_begin[row - entries->rows->first + 2]++, entries->slot_at++;
  else
    entries->given_at++;
}

static void give_place(DistEntries *entries, int row, int column, double value) {
  (void)value;
  if (!dist_rows_have(entries->rows, row)) entries->given[entries->given_at++] = (DistPlace){row, column};
}

static void list_entry(DistEntries *entries, int row, int column, double value) {
  (void)value;
  if (dist_rows_have(entries->rows, row))
    entries->column[entries->row_begin[row - entries->rows->first + 1]++] = column;
}

static int find_slot(const DistEntries *entries, int row, int column) {
  int low = entries->row_begin[row - entries->rows->first],
      high = entries->row_begin[row - entries->rows->first + 1] - 1;
  while (low < high) {
    int middle = low + (high - low) / 2;
    if (entries->column[middle] < column)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static void place_entry(DistEntries *entries, int row, int column, double value) {
  (void)value;
  if (dist_rows_have(entries->rows, row))
    entries->slots[entries->slot_at++] = find_slot(entries, row, column);
}

static void add_entry(DistEntries *entries, int row, int column, double value) {
  (void)column;
  if (dist_rows_have(entries->rows, row))
    entries->values[entries->slots[entries->slot_at++]] += value;
  else
    entries->given_values[entries->given_at++] = value;
}

// How many entries ranks have for rows of others, and where each rank's begin among all of these.
static Status count_entries(DistEntries *entries, const FemMatrix *pattern, int *own_count) {
  int rank_count = pattern->share->rank_count;
  double *counts = memory_zeroed((size_t)rank_count, sizeof *counts);
  entries->given_begin = memory_zeroed((size_t)rank_count + 1, sizeof *entries->given_begin);
  entries->row_begin =
      memory_zeroed((size_t)(entries->rows->end - entries->rows->first) + 2, sizeof *entries->row_begin);
  Status status = agree(counts && entries->given_begin && entries->row_begin);
  if (!status) {
    walk(entries, pattern, count_entry);
    *own_count = entries->slot_at;
    counts[ranks()->number] = entries->given_at;
    ranks()->sum(counts, (size_t)rank_count);
    for (int r = 0; r < rank_count; r++)
      entries->given_begin[r + 1] = entries->given_begin[r] + (int)counts[r];
  }
  memory_free(counts);
  return status;
}

// Places of the entries that ranks have for rows of others: all of them on each, for they are few.
static Status exchange_places(DistEntries *entries, const FemMatrix *pattern) {
  size_t all = (size_t)entries->given_begin[pattern->share->rank_count];
  entries->given = memory_zeroed(all, sizeof *entries->given);
  entries->given_values = memory_zeroed(all, sizeof *entries->given_values);
  entries->taken = memory_zeroed(all, sizeof *entries->taken);
  TRY(agree(entries->given && entries->given_values && entries->taken));
  walk(entries, pattern, give_place);
  ranks()->join(entries->given, sizeof *entries->given, entries->given_begin);
  entries->taken_count = 0;
  for (int g = 0; g < (int)all; g++) {
    if (!dist_rows_have(entries->rows, entries->given[g].row)) continue;
    entries->taken[entries->taken_count++].from = g;
    entries->row_begin[entries->given[g].row - entries->rows->first + 2]++;
  }
  return STATUS_OK;
}

static int compare_ints(const void *a, const void *b) {
  int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

// Each row ascending, every column once.
static void sort_rows(DistEntries *entries) {
  int to = 0, from = 0, *column = entries->column;
  for (int row = 0; row < entries->rows->end - entries->rows->first; row++) {
    int end = entries->row_begin[row + 1], first = to;
    qsort(column + from, (size_t)(end - from), sizeof *column, compare_ints);
    for (; from < end; from++)
      if (to == first || column[from] != column[to - 1]) column[to++] = column[from];
    entries->row_begin[row + 1] = to;
  }
}

// This rank's rows: of its own entries, of those that it is given, and of coordinates that stand alone.
static Status list_rows(DistEntries *entries, const FemMatrix *pattern, int own_count) {
  const DistRows *rows = entries->rows;
  size_t most = (size_t)own_count + (size_t)entries->taken_count + (size_t)rows->alone_count;
  if (most > INT_MAX) return agree(false); // more than can be numbered
  int row_count = rows->end - rows->first, *begin = entries->row_begin;
  entries->column = memory_zeroed(most, sizeof *entries->column);
  entries->slots = memory_zeroed((size_t)own_count, sizeof *entries->slots);
  entries->alone_slots = memory_zeroed((size_t)rows->alone_count, sizeof *entries->alone_slots);
  TRY(agree(entries->column && entries->slots && entries->alone_slots));
  for (int k = 0; k < rows->alone_count; k++) begin[rows->alone[k] - rows->first + 2]++;
  for (int row = 0; row < row_count; row++) begin[row + 2] += begin[row + 1];
  walk(entries, pattern, list_entry);
  for (int k = 0; k < entries->taken_count; k++) {
    DistPlace place = entries->given[entries->taken[k].from];
    entries->column[begin[place.row - rows->first + 1]++] = place.column;
  }
  for (int k = 0; k < rows->alone_count; k++)
    entries->column[begin[rows->alone[k] - rows->first + 1]++] = rows->alone[k];
  sort_rows(entries);
  walk(entries, pattern, place_entry);
  for (int k = 0; k < entries->taken_count; k++) {
    DistPlace place = entries->given[entries->taken[k].from];
    entries->taken[k].slot = find_slot(entries, place.row, place.column);
  }
  for (int k = 0; k < rows->alone_count; k++)
    entries->alone_slots[k] = find_slot(entries, rows->alone[k], rows->alone[k]);
  return STATUS_OK;
}

// As stiff as a neighbour.
static double stiffness_alone(const DistEntries *entries, const FemMatrix *matrix) {
  double value = entries->rows->own_count > 0 ? matrix->value[matrix->col_begin[entries->rows->own[0]]] : 1;
  return value > 0 ? value : 1;
}

static Status lay_out(DistEntries *entries, const FemMatrix *pattern) {
  int own_count = 0;
  TRY(find_touched(entries, pattern));
  TRY(count_entries(entries, pattern, &own_count));
  TRY(exchange_places(entries, pattern));
  TRY(list_rows(entries, pattern, own_count));
  memory_free(entries->given);
  entries->given = NULL;
  size_t count = (size_t)entries->row_begin[entries->rows->end - entries->rows->first];
  entries->values = memory_zeroed(count, sizeof *entries->values);
  return agree(entries->values);
}

Status dist_entries_create(DistEntries *entries, const DistRows *rows, const FemMatrix *pattern) {
  *entries = (DistEntries){.rows = rows};
  return lay_out(entries, pattern);
}

void dist_entries_forget_columns(DistEntries *entries) {
  memory_free(entries->column);
  entries->column = NULL;
}

void dist_entries_destroy(DistEntries *entries) {
  memory_free(entries->row_begin), memory_free(entries->column), memory_free(entries->values);
  memory_free(entries->is_touched), memory_free(entries->slots), memory_free(entries->alone_slots);
  memory_free(entries->given_begin), memory_free(entries->given), memory_free(entries->given_values);
  memory_free(entries->taken);
  *entries = (DistEntries){0};
}

void dist_entries_sum(DistEntries *entries, const FemMatrix *matrix) {
  const DistRows *rows = entries->rows;
  double alone = stiffness_alone(entries, matrix);
  memset(entries->values, 0, (size_t)entries->row_begin[rows->end - rows->first] * sizeof(double));
  walk(entries, matrix, add_entry);
  ranks()->join(entries->given_values, sizeof *entries->given_values, entries->given_begin);
  for (int k = 0; k < entries->taken_count; k++)
    entries->values[entries->taken[k].slot] += entries->given_values[entries->taken[k].from];
  for (int k = 0; k < rows->alone_count; k++) entries->values[entries->alone_slots[k]] = alone;
}

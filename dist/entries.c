// SPDX-License-Identifier: GPL-3.0-or-later
#include "dist/entries.h"

#include <limits.h>

#include "base/memory.h"
#include "base/ranks.h"

static Status agree(bool is_ok) {
  return ranks()->worst(is_ok ? STATUS_OK : status_no_memory("the condensed matrix"));
}

double dist_entries_alone(const DistRows *rows, const FemMatrix *matrix) {
  double value = rows->own_count > 0 ? matrix->value[matrix->col_begin[rows->own[0]]] : 1;
  return value > 0 ? value : 1;
}

static int local(const DistEntries *entries, int row) {
  return row - entries->rows->first;
}

// What this rank has for rows of others; `to` NULL: only how many.
static size_t give(const DistEntries *entries, const DistReach *reach, DistEntry *to) {
  const FemMatrix *matrix = entries->matrix;
  int *columns = entries->columns;
  double *values = entries->values;
  size_t given = 0;
  for (int i = 0; i < reach->vertex_count; i++) {
    int v = reach->vertices[i];
    if (matrix->share->owner[v] == matrix->share->rank) continue;
    for (int c = 0; c < 3; c++) {
      int unknown = matrix->unknown_of_dof[3 * (size_t)v + (size_t)c];
      if (unknown < 0) continue;
      int count = fem_matrix_row(matrix, v, unknown, columns, values);
      for (int k = 0; k < count; k++) {
        if (entries->skips_zeros && values[k] == 0) continue;
        if (to)
          to[given] = (DistEntry){.row = entries->rows->row[unknown],
                                  .column = entries->rows->row[columns[k]],
                                  .value = values[k]};
        given++;
      }
    }
  }
  return given;
}

// Where each rank's entries for rows of others begin among those of all.
static Status count_given(size_t own, int *begin) {
  int rank_count = ranks()->count;
  double *counts = memory_zeroed((size_t)rank_count, sizeof *counts), sum = 0;
  Status status = agree(counts && begin);
  if (!status) {
    counts[ranks()->number] = (double)own;
    ranks()->sum(counts, (size_t)rank_count);
    for (int r = 0; r < rank_count; r++) {
      sum += counts[r];
      begin[r + 1] = sum > INT_MAX ? INT_MAX : (int)sum;
    }
    status = agree(sum <= INT_MAX); // more than can be numbered
  }
  memory_free(counts);
  return status;
}

// Those for rows of this rank, by row; counts stand two places behind a row while they are sorted.
static Status take(DistEntries *entries, const DistEntry *given, int given_count) {
  const DistRows *rows = entries->rows;
  int *begin = entries->taken_begin, count = 0;
  for (int g = 0; g < given_count; g++) {
    if (!dist_rows_have(rows, given[g].row)) continue;
    begin[local(entries, given[g].row) + 2]++;
    count++;
  }
  entries->taken = memory_zeroed((size_t)count, sizeof *entries->taken);
  if (!entries->taken) return status_no_memory("the condensed matrix");
  for (int row = 0; row < rows->end - rows->first; row++) begin[row + 2] += begin[row + 1];
  for (int g = 0; g < given_count; g++)
    if (dist_rows_have(rows, given[g].row))
      entries->taken[begin[local(entries, given[g].row) + 1]++] = given[g];
  return STATUS_OK;
}

static int count_taken(const DistEntries *entries, int row) {
  return entries->taken_begin[local(entries, row) + 1] - entries->taken_begin[local(entries, row)];
}

static int unknown_of(const DistEntries *entries, int row) {
  return entries->matrix->unknown_of_dof[entries->rows->dof[local(entries, row)]];
}

static int vertex_of(const DistEntries *entries, int row) {
  return entries->rows->dof[local(entries, row)] / 3;
}

// The most entries that this rank has in any row.
static int find_longest(const DistEntries *entries, const DistReach *reach) {
  const FemMatrix *matrix = entries->matrix;
  int longest = 1;
  for (int i = 0; i < reach->vertex_count; i++)
    for (int c = 0; c < 3; c++) {
      int v = reach->vertices[i], unknown = matrix->unknown_of_dof[3 * (size_t)v + (size_t)c];
      int count = unknown >= 0 ? fem_matrix_row(matrix, v, unknown, NULL, NULL) : 0;
      if (count > longest) longest = count;
    }
  return longest;
}

static Status make_room(DistEntries *entries, size_t longest) {
  memory_free(entries->columns), memory_free(entries->values);
  entries->columns = memory_zeroed(longest, sizeof *entries->columns);
  entries->values = memory_zeroed(longest, sizeof *entries->values);
  return entries->columns && entries->values ? STATUS_OK : status_no_memory("the condensed matrix");
}

// Room for what others have beside.
static Status widen(DistEntries *entries, int longest) {
  int most = 0;
  for (int row = entries->rows->first; row < entries->rows->end; row++)
    if (count_taken(entries, row) > most) most = count_taken(entries, row);
  return make_room(entries, (size_t)longest + (size_t)most);
}

static Status exchange(DistEntries *entries, const DistReach *reach, int *begin) {
  TRY(count_given(give(entries, reach, NULL), begin));
  int all = begin[ranks()->count];
  DistEntry *given = memory_zeroed((size_t)all, sizeof *given);
  Status status = agree(given);
  if (!status) {
    give(entries, reach, given + begin[ranks()->number]);
    ranks()->join(given, sizeof *given, begin);
    status = take(entries, given, all);
  }
  memory_free(given);
  return status;
}

Status dist_entries_create(DistEntries *entries, const DistRows *rows, const DistReach *reach,
                           const FemMatrix *matrix, bool skips_zeros) {
  *entries = (DistEntries){
      .rows = rows, .matrix = matrix, .skips_zeros = skips_zeros, .alone = dist_entries_alone(rows, matrix)};
  int longest = find_longest(entries, reach);
  int *begin = memory_zeroed((size_t)ranks()->count + 1, sizeof *begin);
  entries->taken_begin = memory_zeroed((size_t)(rows->end - rows->first) + 2, sizeof *entries->taken_begin);
  Status status = begin && entries->taken_begin ? make_room(entries, (size_t)longest)
                                                : status_no_memory("the condensed matrix");
  status = ranks()->worst(status);
  if (!status) status = exchange(entries, reach, begin);
  if (!status) status = widen(entries, longest);
  memory_free(begin);
  status = ranks()->worst(status);
  if (status) dist_entries_destroy(entries);
  return status;
}

void dist_entries_destroy(DistEntries *entries) {
  memory_free(entries->taken_begin), memory_free(entries->taken);
  memory_free(entries->columns), memory_free(entries->values);
  *entries = (DistEntries){0};
}

// Ascending: those of a rank are, and of each rank there is a run.
static void sort(int *columns, double *values, int count) {
  for (int i = 1; i < count; i++) {
    int column = columns[i], k = i;
    double value = values[i];
    for (; k > 0 && columns[k - 1] > column; k--) columns[k] = columns[k - 1], values[k] = values[k - 1];
    columns[k] = column;
    values[k] = value;
  }
}

static int find(const int *columns, int count, int column) {
  int low = 0, high = count;
  while (low < high) {
    int middle = low + (high - low) / 2;
    if (columns[middle] < column)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

// Adds one, in its place; how many there are now.
static int add(DistEntries *entries, int count, const DistEntry *entry) {
  int at = find(entries->columns, count, entry->column);
  if (at < count && entries->columns[at] == entry->column) {
    entries->values[at] += entry->value;
    return count;
  }
  for (int k = count; k > at; k--) {
    entries->columns[k] = entries->columns[k - 1];
    entries->values[k] = entries->values[k - 1];
  }
  entries->columns[at] = entry->column;
  entries->values[at] = entry->value;
  return count + 1;
}

int dist_entries_row(DistEntries *entries, int row) {
  int unknown = unknown_of(entries, row), *columns = entries->columns;
  if (unknown < 0) {
    columns[0] = row;
    entries->values[0] = entries->alone;
    return 1;
  }
  int all = fem_matrix_row(entries->matrix, vertex_of(entries, row), unknown, columns, entries->values),
      count = 0;
  for (int k = 0; k < all; k++) {
    if (entries->skips_zeros && entries->values[k] == 0 && columns[k] != unknown) continue;
    entries->values[count] = entries->values[k];
    columns[count++] = entries->rows->row[columns[k]];
  }
  sort(columns, entries->values, count);
  const int *begin = entries->taken_begin + local(entries, row);
  for (int k = begin[0]; k < begin[1]; k++) count = add(entries, count, &entries->taken[k]);
  return count;
}

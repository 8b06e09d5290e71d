// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/pattern.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

// An ascending list of distinct vertices.
typedef struct VertexList {
  int *vertices;
  int count;
  size_t capacity;
  bool is_kept; // as it was at the mark
} VertexList;

// The list of a vertex at the mark.
typedef struct Kept {
  int vertex, count;
  int *vertices; // owned
} Kept;

struct FemPattern {
  int vertex_count;
  VertexList *above; // of each vertex: its neighbours with a higher number   (vertex_count)
  bool is_marked;
  Kept *kept; // of the lists that have grown since the mark                      (kept_count)
  int kept_count;
  size_t kept_capacity;
  const FemShare *share; // cliques that are taken; NULL: all
  VertexList clique;     // scratch: the clique that is being added
};

Status fem_pattern_create(FemPattern **pattern, int vertex_count) {
  assert(vertex_count >= 0);
  *pattern = memory_zeroed(1, sizeof **pattern);
  if (!*pattern) return status_no_memory("the matrix pattern");
  (*pattern)->vertex_count = vertex_count;
  (*pattern)->above = memory_zeroed((size_t)vertex_count, sizeof *(*pattern)->above);
  if ((*pattern)->above) return STATUS_OK;
  fem_pattern_destroy(*pattern);
  *pattern = NULL;
  return status_no_memory("the matrix pattern");
}

void fem_pattern_destroy(FemPattern *pattern) {
  if (!pattern) return;
  if (pattern->above)
    for (int v = 0; v < pattern->vertex_count; v++) memory_free(pattern->above[v].vertices);
  for (int k = 0; k < pattern->kept_count; k++) memory_free(pattern->kept[k].vertices);
  memory_free(pattern->kept);
  memory_free(pattern->above);
  memory_free(pattern->clique.vertices);
  memory_free(pattern);
}

static int compare_ints(const void *a, const void *b) {
  int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

static void sort_ints(int *values, int count) {
  if (count > 16) {
    qsort(values, (size_t)count, sizeof *values, compare_ints);
    return;
  }
  for (int i = 1; i < count; i++) {
    int value = values[i], j = i;
    for (; j > 0 && values[j - 1] > value; j--) values[j] = values[j - 1];
    values[j] = value;
  }
}

static int reserve(VertexList *list, int wanted) {
  return memory_reserve((void **)&list->vertices, &list->capacity, (size_t)wanted, sizeof *list->vertices);
}

// The clique, ascending and without repetitions, in the pattern's scratch list.
static Status sort_clique(FemPattern *pattern, int count, const int *vertices) {
  VertexList *clique = &pattern->clique;
  if (!reserve(clique, count)) return status_no_memory("a clique of the matrix pattern");
  for (int i = 0; i < count; i++) {
    assert(vertices[i] >= 0 && vertices[i] < pattern->vertex_count);
    clique->vertices[i] = vertices[i];
  }
  sort_ints(clique->vertices, count);
  clique->count = 0;
  for (int i = 0; i < count; i++)
    if (i == 0 || clique->vertices[i] != clique->vertices[i - 1])
      clique->vertices[clique->count++] = clique->vertices[i];
  return STATUS_OK;
}

// How many of `wanted` (ascending) the list lacks. Most are a few places on: steps that double bracket each.
static int count_missing(const VertexList *list, int wanted_count, const int *wanted) {
  int missing = 0, from = 0;
  for (int i = 0; i < wanted_count; i++) {
    int low = from, high = from;
    for (int step = 1; high < list->count && list->vertices[high] < wanted[i]; step *= 2) {
      low = high + 1;
      high = step < list->count - low ? low + step : list->count;
    }
    while (low < high) {
      int middle = low + (high - low) / 2;
      if (list->vertices[middle] < wanted[i])
        low = middle + 1;
      else
        high = middle;
    }
    missing += low == list->count || list->vertices[low] != wanted[i];
    from = low;
  }
  return missing;
}

// Merges `added` (ascending, `missing` of them new) into the list, from the back so that nothing is moved
// twice.
static Status merge(VertexList *list, int added_count, const int *added, int missing) {
  if (!reserve(list, list->count + missing)) return status_no_memory("the matrix pattern");
  int kept = list->count - 1, next = added_count - 1;
  for (int to = list->count + missing - 1; next >= 0; to--) {
    if (kept >= 0 && list->vertices[kept] > added[next]) {
      list->vertices[to] = list->vertices[kept--];
      continue;
    }
    if (kept >= 0 && list->vertices[kept] == added[next]) kept--;
    list->vertices[to] = added[next--];
  }
  list->count += missing;
  return STATUS_OK;
}

void fem_pattern_mark(FemPattern *pattern) {
  fem_pattern_take_back(pattern);
  pattern->is_marked = true;
}

void fem_pattern_take_back(FemPattern *pattern) {
  for (int k = 0; k < pattern->kept_count; k++) {
    const Kept *kept = &pattern->kept[k];
    VertexList *list = &pattern->above[kept->vertex];
    memcpy(list->vertices, kept->vertices, (size_t)kept->count * sizeof *list->vertices);
    list->count = kept->count;
    list->is_kept = false;
    memory_free(kept->vertices);
  }
  pattern->kept_count = 0;
}

// The vertex' list is about to grow.
static Status keep(FemPattern *pattern, int vertex) {
  VertexList *list = &pattern->above[vertex];
  if (!pattern->is_marked || list->is_kept) return STATUS_OK;
  if (!memory_reserve((void **)&pattern->kept, &pattern->kept_capacity, (size_t)pattern->kept_count + 1,
                      sizeof *pattern->kept))
    return status_no_memory("the matrix pattern");
  Kept *kept = &pattern->kept[pattern->kept_count];
  *kept =
      (Kept){vertex, list->count, memory_copy(list->vertices, (size_t)list->count, sizeof *list->vertices)};
  if (!kept->vertices) return status_no_memory("the matrix pattern");
  pattern->kept_count++;
  list->is_kept = true;
  return STATUS_OK;
}

void fem_pattern_set_share(FemPattern *pattern, const FemShare *share) {
  pattern->share = share;
}

Status fem_pattern_add_clique(FemPattern *pattern, int count, const int *vertices, int *has_grown) {
  if (count == 0 || !fem_share_has(pattern->share, count, vertices)) return STATUS_OK;
  TRY(sort_clique(pattern, count, vertices));
  const VertexList *clique = &pattern->clique;
  for (int i = 0; i + 1 < clique->count; i++) {
    VertexList *list = &pattern->above[clique->vertices[i]];
    const int *higher = clique->vertices + i + 1;
    int higher_count = clique->count - i - 1;
    int missing = count_missing(list, higher_count, higher);
    if (missing == 0) continue;
    TRY(keep(pattern, clique->vertices[i]));
    TRY(merge(list, higher_count, higher, missing));
    if (has_grown) *has_grown = 1;
  }
  return STATUS_OK;
}

int fem_pattern_vertex_count(const FemPattern *pattern) {
  return pattern->vertex_count;
}

const int *fem_pattern_above(const FemPattern *pattern, int vertex, int *count) {
  *count = pattern->above[vertex].count;
  return pattern->above[vertex].vertices;
}

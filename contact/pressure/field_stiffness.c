// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/field_stiffness.h"

#include <assert.h>
#include <stdlib.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "contact/pressure/field.h"

// Pairs whose matrices are held at once; vertices that two elements have at most: of a star ten, four and
// one.
enum { PORTION = 512, MOST = 32, STRIDE = 3 * MOST };

Status contact_field_stiffness_create(ContactFieldStiffness *stiffness, const ContactLayout *layout) {
  *stiffness = (ContactFieldStiffness){0};
  if (!layout->depth.has_field) return STATUS_OK;
  stiffness->matrices = memory_zeroed((size_t)PORTION * 576, sizeof(double));
  stiffness->vertices = memory_zeroed(MOST, sizeof(int));
  stiffness->place = memory_zeroed((size_t)layout->def.vertex_count, sizeof(int));
  stiffness->sum = memory_zeroed((size_t)STRIDE * STRIDE, sizeof(double));
  stiffness->dense = memory_zeroed((size_t)STRIDE * STRIDE, sizeof(double));
  bool fits =
      stiffness->matrices && stiffness->vertices && stiffness->place && stiffness->sum && stiffness->dense;
  return fits ? STATUS_OK : status_no_memory("contact stiffness");
}

void contact_field_stiffness_destroy(ContactFieldStiffness *stiffness) {
  memory_free(stiffness->order);
  memory_free(stiffness->matrices);
  memory_free(stiffness->vertices);
  memory_free(stiffness->place);
  memory_free(stiffness->sum);
  memory_free(stiffness->dense);
  *stiffness = (ContactFieldStiffness){0};
}

size_t contact_field_stiffness_bytes(const ContactFieldStiffness *stiffness) {
  const void *const arrays[] = {stiffness->order, stiffness->matrices, stiffness->vertices,
                                stiffness->place, stiffness->sum,      stiffness->dense};
  return memory_held_by(sizeof arrays / sizeof *arrays, arrays);
}

// ---- Which pairs are of the same two elements.

static int compare(const void *left, const void *right) {
  const ContactFieldKey *a = left, *b = right;
  if (a->facing != b->facing) return a->facing < b->facing ? -1 : 1;
  for (int side = 0; side < 2; side++)
    if (a->elements[side] != b->elements[side]) return a->elements[side] < b->elements[side] ? -1 : 1;
  return (a->pair > b->pair) - (a->pair < b->pair);
}

static bool are_alike(const ContactFieldKey *a, const ContactFieldKey *b) {
  return a->facing == b->facing && a->elements[0] == b->elements[0] && a->elements[1] == b->elements[1];
}

static Status order_pairs(ContactFieldStiffness *stiffness, const ContactLayout *layout, int count,
                          const ContactPair *pairs) {
  if (!memory_reserve((void **)&stiffness->order, &stiffness->order_capacity, (size_t)count,
                      sizeof *stiffness->order))
    return status_no_memory("contact stiffness");
  for (int k = 0; k < count; k++) {
    const int *cells = pairs[k].tets;
    stiffness->order[k] = (ContactFieldKey){pairs[k].facing,
                                            {contact_layout_origin(layout, cells[0]),
                                             cells[1] < 0 ? -1 : contact_layout_origin(layout, cells[1])},
                                            k};
  }
  if (count > 1) qsort(stiffness->order, (size_t)count, sizeof *stiffness->order, compare);
  return STATUS_OK;
}

Status contact_field_stiffness_thin(ContactFieldStiffness *stiffness, const ContactLayout *layout, int *count,
                                    ContactPair *pairs) {
  int kept = 0;
  TRY(order_pairs(stiffness, layout, *count, pairs));
  // pairs are told by their place: one of each kind is marked, then all others are dropped in their own order
  for (int k = 0; k < *count; k++)
    if (k > 0 && are_alike(&stiffness->order[k], &stiffness->order[k - 1]))
      pairs[stiffness->order[k].pair].facing = -1;
  for (int k = 0; k < *count; k++)
    if (pairs[k].facing >= 0) pairs[kept++] = pairs[k];
  *count = kept;
  return STATUS_OK;
}

// ---- The sum over the cells of two elements.

static int place_of(ContactFieldStiffness *stiffness, int vertex) {
  int *place = &stiffness->place[vertex];
  if (*place == 0) {
    assert(stiffness->count < MOST);
    stiffness->vertices[stiffness->count] = vertex;
    *place = ++stiffness->count;
  }
  return *place - 1;
}

// The part of a pair's matrix, of `width` rows, that belongs to sides which carry unknowns.
static void add_pair(ContactFieldStiffness *stiffness, const ContactLayout *layout, const ContactPair *pair,
                     const double *matrix) {
  const double *weight = layout->facings[pair->facing].weight;
  int places[8], count = pair->tets[1] < 0 ? 4 : 8, width = 3 * count;
  for (int v = 0; v < count; v++)
    places[v] = weight[v / 4] > 0
                    ? place_of(stiffness, contact_layout_vertices(layout, pair->tets[v / 4])[v % 4])
                    : -1;
  for (int v = 0; v < count; v++)
    for (int w = 0; w < count; w++) {
      if (places[v] < 0 || places[w] < 0) continue;
      double *to = stiffness->sum + 3 * places[v] * STRIDE + 3 * places[w];
      const double *from = matrix + 3 * v * width + 3 * w;
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) to[STRIDE * r + c] += from[width * r + c];
    }
}

static void hand_on(ContactFieldStiffness *stiffness, void *self, ContactFieldTake take) {
  int width = 3 * stiffness->count;
  for (int r = 0; r < width; r++) {
    memcpy(stiffness->dense + r * width, stiffness->sum + r * STRIDE, (size_t)width * sizeof(double));
    memset(stiffness->sum + r * STRIDE, 0, (size_t)width * sizeof(double));
  }
  if (width > 0) take(self, stiffness->count, stiffness->vertices, stiffness->dense);
  for (int k = 0; k < stiffness->count; k++) stiffness->place[stiffness->vertices[k]] = 0;
  stiffness->count = 0;
}

// ---- All of it.

static void bend(const ContactLayout *layout, const ContactEvaluation *evaluation, int k, double *matrix) {
  bool is_full = layout->def.use_full_hessian;
  const ContactPair *pair = &evaluation->pairs[k];
  double coordinates[OVERLAP_PAIR_SIZE];
  memcpy(coordinates, evaluation->coordinates + OVERLAP_PAIR_SIZE * (size_t)k, sizeof coordinates);
  if (pair->tets[1] < 0) {
    contact_field_bend_shape(layout, pair, evaluation->time, coordinates, is_full, matrix);
    return;
  }
  int mode = contact_field_area_mode();
  if (!is_full && (mode == 1 || mode == 2)) {
    contact_field_bend_area(layout, pair, coordinates, &evaluation->fields[k], matrix);
    return;
  }
  contact_layout_unsettle_pair(layout, pair, coordinates);
  contact_field_bend(layout, pair, coordinates, is_full, mode == 3 ? &evaluation->fields[k] : NULL, matrix);
}

static double spent_bend, spent_all;
static long asked;
static double cpu(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static void tell(void) { fprintf(stderr, "AREA %g %g %ld\n", spent_bend, spent_all, asked); }

// For the study of patches: the mesh once, then at each matrix positions and pairs.
static void dump_patches(const ContactLayout *layout, const ContactEvaluation *evaluation) {
  static FILE *file;
  static int every, calls;
  const ContactDepth *depth = &layout->depth;
  if (!getenv("TETLAP_PATCH_DUMP")) return;
  if (!file) {
    file = fopen(getenv("TETLAP_PATCH_DUMP"), "wb");
    every = atoi(getenv("TETLAP_PATCH_EVERY"));
    int virtual_count = depth->position_count - layout->def.vertex_count;
    int head[6] = {depth->position_count, depth->cell_count, virtual_count, layout->def.vertex_count, layout->facing_count, layout->def.tet_count};
    fwrite(head, sizeof head, 1, file);
    fwrite(depth->cells, 16, (size_t)depth->cell_count, file);
    fwrite(depth->outer, 1, (size_t)depth->cell_count, file);
    fwrite(depth->replaced, 1, (size_t)depth->cell_count, file);
    fwrite(depth->tets, 4, (size_t)depth->cell_count, file);
    fwrite(layout->def.tets, 16, (size_t)layout->def.tet_count, file);
    for (int k = 0; k < virtual_count; k++) fwrite(depth->virtuals[k].weights, 8, 4, file);
    fwrite(depth->depths, 8, (size_t)depth->position_count, file);
    fwrite(layout->cell_volumes, 8, (size_t)depth->cell_count, file);
    for (int f = 0; f < layout->facing_count; f++) fwrite(&layout->facings[f].stiffness, 8, 1, file);
  }
  if (calls++ % every || evaluation->mesh_pair_count == 0) return;
  fwrite(&evaluation->mesh_pair_count, 4, 1, file);
  fwrite(&evaluation->time, 8, 1, file);
  fwrite(evaluation->positions, 24, (size_t)depth->position_count, file);
  for (int k = 0; k < evaluation->mesh_pair_count; k++) {
    const ContactPair *pair = &evaluation->pairs[k];
    const ContactFieldPair *field = &evaluation->fields[k];
    int ids[3] = {pair->facing, pair->tets[0], pair->tets[1]};
    double numbers[4] = {field->volume, field->centroid[0], field->centroid[1], field->centroid[2]};
    fwrite(ids, sizeof ids, 1, file);
    fwrite(numbers, sizeof numbers, 1, file);
  }
  fflush(file);
}

Status contact_field_stiffness_add(ContactFieldStiffness *stiffness, const ContactLayout *layout,
                                   const ContactEvaluation *evaluation, void *self, ContactFieldTake take) {
  int count = evaluation->pair_count;
  dump_patches(layout, evaluation);
  static int told;
  if (!told++) atexit(tell);
  double t0 = cpu();
  TRY(order_pairs(stiffness, layout, count, evaluation->pairs));
  asked += evaluation->mesh_pair_count;
  const ContactFieldKey *order = stiffness->order;
  for (int first = 0; first < count; first += PORTION) {
    int end = first + PORTION < count ? first + PORTION : count;
    double t1 = cpu();
    for (int k = first; k < end; k++)
      bend(layout, evaluation, order[k].pair, stiffness->matrices + 576 * (size_t)(k - first));
    spent_bend += cpu() - t1;
    for (int k = first; k < end; k++) {
      if (k > 0 && !are_alike(&order[k], &order[k - 1])) hand_on(stiffness, self, take);
      add_pair(stiffness, layout, &evaluation->pairs[order[k].pair],
               stiffness->matrices + 576 * (size_t)(k - first));
    }
  }
  hand_on(stiffness, self, take);
  spent_all += cpu() - t0;
  return STATUS_OK;
}

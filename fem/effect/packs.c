// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/packs.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

// Elements of a chunk: some kilobytes of positions and forces, and work worth handing to a thread.
enum { CHUNK_PACKS = 16, CHUNK = CHUNK_PACKS * FEM_LANES };
// A chunk conflicts with fewer than this many others unless a vertex has thousands of elements.
enum { COLOUR_WORDS = 8 };

typedef struct Place {
  uint64_t code; // along the curve
  int tet;
} Place;

typedef struct ColourSet {
  uint64_t words[COLOUR_WORDS];
} ColourSet;

// While the packs are made.
typedef struct Order {
  const FemModel *model;
  Place *places; // elements by body, then along the curve   (count)
  int count;
  int *begin, *body; // of each chunk in `places`                (chunk_count + 1)
  int *colour;       // of each chunk                            (chunk_count)
  ColourSet *used;   // around each vertex                       (vertex_count)
  int chunk_count, colour_count;
} Order;

static void free_order(Order *order) {
  memory_free(order->places), memory_free(order->begin), memory_free(order->body);
  memory_free(order->colour), memory_free(order->used);
}

// Bits of a coordinate with two free places behind each.
static uint64_t spread_bits(uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
  x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
  x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
  x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
  return (x | x << 2) & UINT64_C(0x1249249249249249);
}

// Of the centroid at rest, in cells of the curve's finest level.
static uint64_t code_of(const FemModel *model, const double origin[3], double cell, int tet) {
  uint64_t code = 0;
  for (int c = 0; c < 3; c++) {
    double sum = 0;
    for (int a = 0; a < 4; a++) sum += model->rest[3 * (size_t)model->tets[tet][a] + (size_t)c];
    double at = fmin(fmax((0.25 * sum - origin[c]) / cell, 0), 0x1fffff);
    code |= spread_bits((uint64_t)at) << c;
  }
  return code;
}

static int compare(const void *left, const void *right) {
  const Place *a = left, *b = right;
  if (a->code != b->code) return a->code < b->code ? -1 : 1;
  return a->tet < b->tet ? -1 : a->tet > b->tet;
}

static void place_body(Order *order, const FemModelBody *body) {
  const FemModel *model = order->model;
  double low[3] = {INFINITY, INFINITY, INFINITY}, size = 0;
  for (int v = body->vertex_begin; v < body->vertex_end; v++)
    for (int c = 0; c < 3; c++) low[c] = fmin(low[c], model->rest[3 * (size_t)v + (size_t)c]);
  for (int v = body->vertex_begin; v < body->vertex_end; v++)
    for (int c = 0; c < 3; c++) size = fmax(size, model->rest[3 * (size_t)v + (size_t)c] - low[c]);
  int first = order->count;
  for (int tet = body->tet_begin; tet < body->tet_end; tet++)
    order->places[order->count++] = (Place){code_of(model, low, size / 0x1fffff, tet), tet};
  qsort(order->places + first, (size_t)(order->count - first), sizeof *order->places, compare);
}

static bool is_taken(const FemModelBody *body, bool (*takes)(const FemModelBody *body)) {
  return !body->is_obstacle && body->element != FEM_ELEMENT_QUADRATIC && (!takes || takes(body));
}

static void cut_chunks(Order *order, bool (*takes)(const FemModelBody *body)) {
  const FemModel *model = order->model;
  for (int b = 0; b < model->body_count; b++) {
    if (!is_taken(&model->bodies[b], takes)) continue;
    int first = order->count;
    place_body(order, &model->bodies[b]);
    for (int at = first; at < order->count; at += CHUNK) {
      order->body[order->chunk_count] = b;
      order->begin[order->chunk_count++] = at;
    }
  }
  order->begin[order->chunk_count] = order->count;
}

static Status choose_colours(Order *order) {
  for (int chunk = 0; chunk < order->chunk_count; chunk++) {
    ColourSet taken = {{0}};
    int begin = order->begin[chunk], end = order->begin[chunk + 1], colour = -1;
    for (int i = begin; i < end; i++)
      for (int a = 0; a < 4; a++)
        for (int w = 0; w < COLOUR_WORDS; w++)
          taken.words[w] |= order->used[order->model->tets[order->places[i].tet][a]].words[w];
    for (int w = 0; w < COLOUR_WORDS && colour < 0; w++)
      if (~taken.words[w]) colour = 64 * w + __builtin_ctzll(~taken.words[w]);
    if (colour < 0)
      return status_fail(STATUS_INPUT, "a vertex has tens of thousands of tetrahedra; remesh it");
    order->colour[chunk] = colour;
    if (colour >= order->colour_count) order->colour_count = colour + 1;
    for (int i = begin; i < end; i++)
      for (int a = 0; a < 4; a++)
        order->used[order->model->tets[order->places[i].tet][a]].words[colour / 64] |= UINT64_C(1)
                                                                                       << colour % 64;
  }
  return STATUS_OK;
}

// Nodes in ascending order, gradients with them.
static void fill_lane(const FemModel *model, int tet, FemLanesElements *pack, int lane) {
  const FemElement *element = &model->elements[tet];
  int order[4] = {0, 1, 2, 3};
  for (int i = 1; i < 4; i++)
    for (int k = i; k > 0 && model->tets[tet][order[k]] < model->tets[tet][order[k - 1]]; k--) {
      int swapped = order[k];
      order[k] = order[k - 1], order[k - 1] = swapped;
    }
  for (int a = 0; a < 4; a++) pack->node[a][lane] = model->tets[tet][order[a]];
  for (int a = 1; a < 4; a++)
    for (int j = 0; j < 3; j++) pack->gradient[3 * (a - 1) + j][lane] = element->gradient[order[a]][j];
  pack->volume[lane] = element->volume;
  pack->tet[lane] = tet;
}

static void fill_chunk(FemPacks *packs, const Order *order, int chunk) {
  for (int at = order->begin[chunk]; at < order->begin[chunk + 1]; at += FEM_LANES) {
    FemLanesElements *pack = &packs->packs[packs->pack_count++];
    int left = order->begin[chunk + 1] - at;
    pack->count = left < FEM_LANES ? left : FEM_LANES;
    for (int l = 0; l < FEM_LANES; l++)
      fill_lane(order->model, order->places[at + (l < pack->count ? l : pack->count - 1)].tet, pack, l);
  }
}

static Status fill(FemPacks *packs, const Order *order) {
  size_t chunks = (size_t)order->chunk_count;
  packs->chunk_begin = memory_zeroed(chunks + 1, sizeof *packs->chunk_begin);
  packs->chunk_body = memory_zeroed(chunks, sizeof *packs->chunk_body);
  packs->colour_begin = memory_zeroed((size_t)order->colour_count + 1, sizeof *packs->colour_begin);
  packs->packs = memory_zeroed((size_t)order->count / FEM_LANES + chunks, sizeof *packs->packs);
  if (!packs->chunk_begin || !packs->chunk_body || !packs->colour_begin || !packs->packs)
    return status_no_memory("the elements in packs");
  packs->tet_count = order->count;
  packs->colour_count = order->colour_count;
  for (int colour = 0; colour < order->colour_count; colour++) {
    packs->colour_begin[colour] = packs->chunk_count;
    for (int chunk = 0; chunk < order->chunk_count; chunk++) {
      if (order->colour[chunk] != colour) continue;
      packs->chunk_body[packs->chunk_count] = order->body[chunk];
      packs->chunk_begin[packs->chunk_count++] = packs->pack_count;
      fill_chunk(packs, order, chunk);
    }
  }
  packs->colour_begin[packs->colour_count] = packs->chunk_count;
  packs->chunk_begin[packs->chunk_count] = packs->pack_count;
  return STATUS_OK;
}

static Status make_order(Order *order, bool (*takes)(const FemModelBody *body)) {
  const FemModel *model = order->model;
  size_t chunks = (size_t)model->tet_count / CHUNK + (size_t)model->body_count;
  order->places = memory_zeroed((size_t)model->tet_count, sizeof *order->places);
  order->begin = memory_zeroed(chunks + 1, sizeof *order->begin);
  order->body = memory_zeroed(chunks, sizeof *order->body);
  order->colour = memory_zeroed(chunks, sizeof *order->colour);
  order->used = memory_zeroed((size_t)model->vertex_count, sizeof *order->used);
  if (!order->places || !order->begin || !order->body || !order->colour || !order->used)
    return status_no_memory("the order of elements");
  cut_chunks(order, takes);
  return choose_colours(order);
}

Status fem_packs_create(FemPacks *packs, const FemModel *model, bool (*takes)(const FemModelBody *body)) {
  *packs = (FemPacks){0};
  Order order = {.model = model};
  Status status = make_order(&order, takes);
  if (!status) status = fill(packs, &order);
  free_order(&order);
  return status;
}

void fem_packs_destroy(FemPacks *packs) {
  memory_free(packs->packs), memory_free(packs->slots), memory_free(packs->chunk_begin);
  memory_free(packs->chunk_body), memory_free(packs->colour_begin);
  *packs = (FemPacks){0};
}

size_t fem_packs_bytes(const FemPacks *packs) {
  return memory_held(packs->packs) + memory_held(packs->slots) + memory_held(packs->chunk_begin) +
         memory_held(packs->chunk_body) + memory_held(packs->colour_begin);
}

Status fem_packs_find_slots(FemPacks *packs, const FemMatrix *matrix) {
  if (!packs->slots) packs->slots = memory_zeroed((size_t)packs->pack_count, sizeof *packs->slots);
  if (!packs->slots) return status_no_memory("the elements' places in the matrix");
#pragma omp parallel for schedule(static)
  for (int p = 0; p < packs->pack_count; p++) {
    const FemLanesElements *pack = &packs->packs[p];
    for (int l = 0; l < FEM_LANES; l++) {
      int vertices[4], slots[FEM_LANES_SLOTS];
      for (int a = 0; a < 4; a++) vertices[a] = pack->node[a][l];
      if (!fem_matrix_block_slots(matrix, vertices, slots)) slots[0] = -1;
      for (int s = 0; s < FEM_LANES_SLOTS; s++) packs->slots[p][s][l] = slots[0] < 0 ? -1 : slots[s];
    }
  }
  return STATUS_OK;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/elements/packs.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

// Elements of a chunk at most: positions and forces that a first-level cache holds, and work worth handing to
// a thread. Fewer and larger chunks have fewer colours.
enum { CHUNK_PACKS = 128, CHUNK = CHUNK_PACKS * FEM_LANES };
// A chunk conflicts with fewer than this many others unless a vertex has thousands of elements.
enum { COLOUR_WORDS = 8 };

typedef struct Place {
  uint64_t code; // along the curve
  int element;
} Place;

typedef struct ColourSet {
  uint64_t words[COLOUR_WORDS];
} ColourSet;

// While the packs are made.
typedef struct Order {
  const FemModel *model;
  bool is_quadratic;
  int node_count;
  const int *nodes; // of the model's elements, borrowed          (…, node_count)
  Place *places;    // elements by part, then along the curve   (count)
  int count;
  int *begin, *part; // of each chunk in `places`                (chunk_count + 1)
  int *colour;       // of each chunk                            (chunk_count)
  ColourSet *used;   // around each vertex                       (vertex_count)
  int chunk_count, colour_count;
} Order;

static void free_order(Order *order) {
  memory_free(order->places), memory_free(order->begin), memory_free(order->part);
  memory_free(order->colour), memory_free(order->used);
}

static const int *nodes_of(const Order *order, int element) {
  return order->nodes + (size_t)order->node_count * (size_t)element;
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

// Of the centroid of the corners at rest, in cells of the curve's finest level.
static uint64_t code_of(const Order *order, const double origin[3], double cell, int element) {
  const int *nodes = nodes_of(order, element);
  uint64_t code = 0;
  for (int c = 0; c < 3; c++) {
    double sum = 0;
    for (int a = 0; a < 4; a++) sum += order->model->rest[3 * (size_t)nodes[a] + (size_t)c];
    double at = fmin(fmax((0.25 * sum - origin[c]) / cell, 0), 0x1fffff);
    code |= spread_bits((uint64_t)at) << c;
  }
  return code;
}

static int compare(const void *left, const void *right) {
  const Place *a = left, *b = right;
  if (a->code != b->code) return a->code < b->code ? -1 : 1;
  return a->element < b->element ? -1 : a->element > b->element;
}

static void place_part(Order *order, int part) {
  const FemModel *model = order->model;
  const FemModelBody *body = &model->bodies[model->parts[part].body];
  const int *part_of = order->is_quadratic ? model->quadratic_part : model->tet_part;
  double low[3] = {INFINITY, INFINITY, INFINITY}, size = 0;
  for (int v = body->vertex_begin; v < body->vertex_end; v++)
    for (int c = 0; c < 3; c++) low[c] = fmin(low[c], model->rest[3 * (size_t)v + (size_t)c]);
  for (int v = body->vertex_begin; v < body->vertex_end; v++)
    for (int c = 0; c < 3; c++) size = fmax(size, model->rest[3 * (size_t)v + (size_t)c] - low[c]);
  int first = order->count;
  int begin = order->is_quadratic ? body->quadratic_begin : body->tet_begin;
  int end = order->is_quadratic ? body->quadratic_end : body->tet_end;
  for (int e = begin; e < end; e++)
    if (part_of[e] == part && fem_share_has(order->model->share, order->node_count, nodes_of(order, e)))
      order->places[order->count++] = (Place){code_of(order, low, size / 0x1fffff, e), e};
  qsort(order->places + first, (size_t)(order->count - first), sizeof *order->places, compare);
}

static bool is_taken(const Order *order, const FemModelPart *part, bool (*takes)(const FemModelPart *part)) {
  bool is_quadratic = order->model->bodies[part->body].element == FEM_ELEMENT_QUADRATIC;
  return is_quadratic == order->is_quadratic && (!takes || takes(part));
}

// Of the elements of a part in each of its chunks, whole packs.
static int even_size(int count) {
  int packs = (count + FEM_LANES - 1) / FEM_LANES, chunks = (packs + CHUNK_PACKS - 1) / CHUNK_PACKS;
  return chunks > 0 ? (packs + chunks - 1) / chunks * FEM_LANES : CHUNK;
}

static void cut_chunks(Order *order, bool (*takes)(const FemModelPart *part)) {
  const FemModel *model = order->model;
  for (int p = 0; p < model->part_count; p++) {
    if (!is_taken(order, &model->parts[p], takes)) continue;
    int first = order->count;
    place_part(order, p);
    int size = even_size(order->count - first);
    for (int at = first; at < order->count; at += size) {
      order->part[order->chunk_count] = p;
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
      for (int a = 0; a < order->node_count; a++)
        for (int w = 0; w < COLOUR_WORDS; w++)
          taken.words[w] |= order->used[nodes_of(order, order->places[i].element)[a]].words[w];
    for (int w = 0; w < COLOUR_WORDS && colour < 0; w++)
      if (~taken.words[w]) colour = 64 * w + __builtin_ctzll(~taken.words[w]);
    if (colour < 0)
      return status_fail(STATUS_INPUT, "a vertex has tens of thousands of tetrahedra; remesh it");
    order->colour[chunk] = colour;
    if (colour >= order->colour_count) order->colour_count = colour + 1;
    for (int i = begin; i < end; i++)
      for (int a = 0; a < order->node_count; a++)
        order->used[nodes_of(order, order->places[i].element)[a]].words[colour / 64] |= UINT64_C(1)
                                                                                        << colour % 64;
  }
  return STATUS_OK;
}

// Nodes in ascending order, gradients with them.
static void fill_lane(const FemModel *model, int tet, FemLanesElements *pack, int lane) {
  const FemElement element = fem_model_element(model, tet);
  int order[4] = {0, 1, 2, 3};
  for (int i = 1; i < 4; i++)
    for (int k = i; k > 0 && model->tets[tet][order[k]] < model->tets[tet][order[k - 1]]; k--) {
      int swapped = order[k];
      order[k] = order[k - 1], order[k - 1] = swapped;
    }
  for (int a = 0; a < 4; a++) pack->node[a][lane] = model->tets[tet][order[a]];
  for (int a = 1; a < 4; a++)
    for (int j = 0; j < 3; j++) pack->gradient[3 * (a - 1) + j][lane] = element.gradient[order[a]][j];
  pack->volume[lane] = element.volume;
  pack->tet[lane] = tet;
}

static void fill_quadratic_lane(const FemModel *model, int number, FemLanesQuadratics *pack, int lane) {
  const FemQuadratic *element = &model->quadratics[number];
  for (int a = 0; a < FEM_QUADRATIC_NODES; a++) pack->node[a][lane] = model->quadratic_nodes[number][a];
  for (int p = 0; p < FEM_QUADRATIC_POINTS; p++) {
    for (int a = 1; a < FEM_QUADRATIC_NODES; a++)
      for (int j = 0; j < 3; j++) pack->gradient[p][3 * (a - 1) + j][lane] = element->gradient[p][a][j];
    pack->weight[p][lane] = element->weight[p];
  }
  pack->volume[lane] = element->volume;
  pack->element[lane] = number;
}

static void fill_pack(FemPacks *packs, const Order *order, int begin, int end) {
  int count = end - begin < FEM_LANES ? end - begin : FEM_LANES, number = packs->pack_count++;
  for (int l = 0; l < FEM_LANES; l++) {
    int element = order->places[begin + (l < count ? l : count - 1)].element;
    if (packs->is_quadratic)
      fill_quadratic_lane(order->model, element, &packs->quadratics[number], l);
    else
      fill_lane(order->model, element, &packs->packs[number], l);
  }
  *(packs->is_quadratic ? &packs->quadratics[number].count : &packs->packs[number].count) = count;
}

static void fill_chunk(FemPacks *packs, const Order *order, int chunk) {
  for (int at = order->begin[chunk]; at < order->begin[chunk + 1]; at += FEM_LANES)
    fill_pack(packs, order, at, order->begin[chunk + 1]);
}

static Status make_room(FemPacks *packs, size_t most) {
  if (packs->is_quadratic)
    packs->quadratics = memory_zeroed(most, sizeof *packs->quadratics);
  else
    packs->packs = memory_zeroed(most, sizeof *packs->packs);
  return packs->quadratics || packs->packs ? STATUS_OK : status_no_memory("the elements in packs");
}

static Status fill(FemPacks *packs, const Order *order) {
  size_t chunks = (size_t)order->chunk_count;
  packs->chunk_begin = memory_zeroed(chunks + 1, sizeof *packs->chunk_begin);
  packs->chunk_part = memory_zeroed(chunks, sizeof *packs->chunk_part);
  packs->colour_begin = memory_zeroed((size_t)order->colour_count + 1, sizeof *packs->colour_begin);
  if (!packs->chunk_begin || !packs->chunk_part || !packs->colour_begin)
    return status_no_memory("the elements in packs");
  TRY(make_room(packs, (size_t)order->count / FEM_LANES + chunks));
  packs->element_count = order->count;
  packs->colour_count = order->colour_count;
  for (int colour = 0; colour < order->colour_count; colour++) {
    packs->colour_begin[colour] = packs->chunk_count;
    for (int chunk = 0; chunk < order->chunk_count; chunk++) {
      if (order->colour[chunk] != colour) continue;
      packs->chunk_part[packs->chunk_count] = order->part[chunk];
      packs->chunk_begin[packs->chunk_count++] = packs->pack_count;
      fill_chunk(packs, order, chunk);
    }
  }
  packs->colour_begin[packs->colour_count] = packs->chunk_count;
  packs->chunk_begin[packs->chunk_count] = packs->pack_count;
  return STATUS_OK;
}

static Status make_order(Order *order, bool (*takes)(const FemModelPart *part)) {
  const FemModel *model = order->model;
  size_t most = (size_t)(order->is_quadratic ? model->quadratic_count : model->tet_count);
  size_t chunks = most / CHUNK + (size_t)model->part_count;
  order->places = memory_zeroed(most, sizeof *order->places);
  order->begin = memory_zeroed(chunks + 1, sizeof *order->begin);
  order->part = memory_zeroed(chunks, sizeof *order->part);
  order->colour = memory_zeroed(chunks, sizeof *order->colour);
  order->used = memory_zeroed((size_t)model->vertex_count, sizeof *order->used);
  if (!order->places || !order->begin || !order->part || !order->colour || !order->used)
    return status_no_memory("the order of elements");
  cut_chunks(order, takes);
  return choose_colours(order);
}

Status fem_packs_create(FemPacks *packs, const FemModel *model, bool is_quadratic,
                        bool (*takes)(const FemModelPart *part)) {
  *packs = (FemPacks){.is_quadratic = is_quadratic};
  Order order = {.model = model, .is_quadratic = is_quadratic};
  order.node_count = is_quadratic ? FEM_QUADRATIC_NODES : 4;
  order.nodes = is_quadratic ? (const int *)model->quadratic_nodes : (const int *)model->tets;
  Status status = make_order(&order, takes);
  if (!status) status = fill(packs, &order);
  free_order(&order);
  return status;
}

void fem_packs_destroy(FemPacks *packs) {
  memory_free(packs->packs), memory_free(packs->slots), memory_free(packs->chunk_begin);
  memory_free(packs->quadratics), memory_free(packs->half_slots);
  memory_free(packs->chunk_part), memory_free(packs->colour_begin);
  *packs = (FemPacks){0};
}

size_t fem_packs_bytes(const FemPacks *packs) {
  return memory_held(packs->packs) + memory_held(packs->slots) + memory_held(packs->quadratics) +
         memory_held(packs->half_slots) + memory_held(packs->chunk_begin) + memory_held(packs->chunk_part) +
         memory_held(packs->colour_begin);
}

static void find_slots(const FemLanesElements *pack, const FemMatrix *matrix,
                       int slots[FEM_LANES_SLOTS][FEM_LANES]) {
  for (int l = 0; l < FEM_LANES; l++) {
    int vertices[4], own[FEM_LANES_SLOTS];
    for (int a = 0; a < 4; a++) vertices[a] = pack->node[a][l];
    if (!fem_matrix_block_slots(matrix, vertices, own)) own[0] = -1;
    for (int s = 0; s < FEM_LANES_SLOTS; s++) slots[s][l] = own[0] < 0 ? -1 : own[s];
  }
}

// An entry and its mirror image are one number, and at most one of the two has a place in the matrix.
static void find_half_slots(const FemLanesQuadratics *pack, const FemMatrix *matrix,
                            int slots[FEM_LANES_HALF][FEM_LANES]) {
  enum { N = 3 * FEM_QUADRATIC_NODES };
  for (int l = 0; l < FEM_LANES; l++) {
    int nodes[FEM_QUADRATIC_NODES], own[N * N];
    for (int a = 0; a < FEM_QUADRATIC_NODES; a++) nodes[a] = pack->node[a][l];
    fem_matrix_slots(matrix, FEM_QUADRATIC_NODES, nodes, own);
    for (int r = 0, k = 0; r < N; r++)
      for (int c = 0; c <= r; c++, k++) slots[k][l] = own[N * r + c] >= 0 ? own[N * r + c] : own[N * c + r];
  }
}

Status fem_packs_find_slots(FemPacks *packs, const FemMatrix *matrix) {
  size_t count = (size_t)packs->pack_count;
  if (packs->layout == matrix->layout) return STATUS_OK;
  if (packs->is_quadratic && !packs->half_slots)
    packs->half_slots = memory_zeroed(count, sizeof *packs->half_slots);
  if (!packs->is_quadratic && !packs->slots) packs->slots = memory_zeroed(count, sizeof *packs->slots);
  if (!packs->half_slots && !packs->slots) return status_no_memory("the elements' places in the matrix");
#pragma omp parallel for schedule(static)
  for (int p = 0; p < packs->pack_count; p++) {
    if (packs->is_quadratic)
      find_half_slots(&packs->quadratics[p], matrix, packs->half_slots[p]);
    else
      find_slots(&packs->packs[p], matrix, packs->slots[p]);
  }
  packs->layout = matrix->layout;
  return STATUS_OK;
}

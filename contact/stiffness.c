// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/stiffness.h"

#include <assert.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "contact/pressure/field.h"
#include "contact/search/bounds.h"
#include "contact/shape/shape.h"
#include "contact/volume/volume.h"

enum { PORTION_SIZE = 16 }; // pairs whose matrices a thread holds at once
// Fewer are done before another thread is awake.
enum { FEW_PAIRS = 64 };
enum { MATRIX_SIZE = OVERLAP_PAIR_SIZE * OVERLAP_PAIR_SIZE };

// ---- The vertices of an element.

static int element_of(const ContactLayout *layout, int tet) {
  return layout->def.origin ? layout->def.origin[tet] : tet;
}

static int place_of(ContactStiffness *stiffness, int vertex) {
  int *place = &stiffness->place[vertex];
  if (*place == 0) {
    assert(stiffness->count < stiffness->most);
    stiffness->vertices[stiffness->count] = vertex;
    *place = ++stiffness->count;
  }
  return *place - 1;
}

static void forget_vertices(ContactStiffness *stiffness) {
  for (int k = 0; k < stiffness->count; k++) stiffness->place[stiffness->vertices[k]] = 0;
  stiffness->count = 0;
}

// Those of all that the contact mesh has in place of one element, which stands together.
static void list_element(ContactStiffness *stiffness, const ContactLayout *layout, int tet) {
  int element = element_of(layout, tet), begin = tet, end = tet + 1;
  while (begin > 0 && element_of(layout, begin - 1) == element) begin--;
  while (end < layout->def.tet_count && element_of(layout, end) == element) end++;
  for (int i = begin; i < end; i++)
    for (int v = 0; v < 4; v++) place_of(stiffness, layout->def.tets[i][v]);
}

// How many vertices two elements have at most.
static int most_of(const ContactLayout *layout) {
  int cells = 0, most = 1;
  for (int i = 0; i < layout->def.tet_count; i++) {
    cells = i > 0 && element_of(layout, i) == element_of(layout, i - 1) ? cells + 1 : 1;
    if (cells > most) most = cells;
  }
  return 2 * (most + 3 < 4 * most ? 3 + most : 4 * most);
}

Status contact_stiffness_create(ContactStiffness *stiffness, const ContactLayout *layout) {
  *stiffness = (ContactStiffness){0};
  stiffness->most = most_of(layout);
  size_t width = 3 * (size_t)stiffness->most;
  stiffness->vertices = memory_zeroed((size_t)stiffness->most, sizeof(int));
  stiffness->place = memory_zeroed((size_t)layout->def.vertex_count, sizeof(int));
  stiffness->sum = memory_zeroed(width * width, sizeof(double));
  stiffness->dense = memory_zeroed(width * width, sizeof(double));
  bool fits = stiffness->vertices && stiffness->place && stiffness->sum && stiffness->dense;
  return fits ? STATUS_OK : status_no_memory("contact stiffness");
}

void contact_stiffness_destroy(ContactStiffness *stiffness) {
  memory_free(stiffness->near_pairs);
  memory_free(stiffness->order);
  memory_free(stiffness->vertices);
  memory_free(stiffness->place);
  memory_free(stiffness->sum);
  memory_free(stiffness->dense);
  *stiffness = (ContactStiffness){0};
}

size_t contact_stiffness_bytes(const ContactStiffness *stiffness) {
  const void *const arrays[] = {stiffness->near_pairs, stiffness->order, stiffness->vertices,
                                stiffness->place,      stiffness->sum,   stiffness->dense};
  return memory_held_by(sizeof arrays / sizeof *arrays, arrays);
}

// ---- Which pairs are of the same two elements.

static int compare_elements(const ContactStiffnessKey *a, const ContactStiffnessKey *b) {
  if (a->interface != b->interface) return a->interface < b->interface ? -1 : 1;
  for (int side = 0; side < 2; side++)
    if (a->elements[side] != b->elements[side]) return a->elements[side] < b->elements[side] ? -1 : 1;
  return 0;
}

static int compare(const void *left, const void *right) {
  const ContactStiffnessKey *a = left, *b = right;
  int order = compare_elements(a, b);
  return order ? order : (a->pair > b->pair) - (a->pair < b->pair);
}

static bool are_alike(const ContactStiffnessKey *a, const ContactStiffnessKey *b) {
  return compare_elements(a, b) == 0;
}

static ContactStiffnessKey key_of(const ContactLayout *layout, const ContactPair *pair, int place) {
  const int *cells = pair->cells;
  return (ContactStiffnessKey){pair->interface,
                               {contact_layout_origin(layout, cells[0]),
                                cells[1] < 0 ? -1 : contact_layout_origin(layout, cells[1])},
                               place};
}

// Those of the interface; `*ordered`: how many they are.
static Status order_pairs(ContactStiffness *stiffness, const ContactLayout *layout, int interface, int count,
                          const ContactPair *pairs, int *ordered) {
  *ordered = 0;
  if (!memory_reserve((void **)&stiffness->order, &stiffness->order_capacity, (size_t)count,
                      sizeof *stiffness->order))
    return status_no_memory("contact stiffness");
  for (int k = 0; k < count; k++) {
    if (interface != CONTACT_ALL_INTERFACES && pairs[k].interface != interface) continue;
    stiffness->order[(*ordered)++] = key_of(layout, &pairs[k], k);
  }
  if (*ordered > 1) qsort(stiffness->order, (size_t)*ordered, sizeof *stiffness->order, compare);
  return STATUS_OK;
}

// ---- The sum over the cells of two elements.

// Where the vertices of a pair stand, −1: on a side without unknowns. Returns how many they are.
static int place_pair(ContactStiffness *stiffness, const ContactLayout *layout, const ContactPair *pair,
                      int places[8]) {
  const double *weight = layout->interfaces[pair->interface].weight;
  int count = pair->cells[1] < 0 ? 4 : 8;
  for (int v = 0; v < count; v++)
    places[v] = weight[v / 4] > 0
                    ? place_of(stiffness, contact_layout_vertices(layout, pair->cells[v / 4])[v % 4])
                    : -1;
  return count;
}

// The part of a pair's matrix that belongs to sides which carry unknowns.
static void add_pair(ContactStiffness *stiffness, int count, const int places[8], const double *matrix) {
  size_t stride = 3 * (size_t)stiffness->most;
  int width = 3 * count;
  for (int v = 0; v < count; v++)
    for (int w = 0; w < count; w++) {
      if (places[v] < 0 || places[w] < 0) continue;
      double *to = stiffness->sum + 3 * (size_t)places[v] * stride + 3 * places[w];
      const double *from = matrix + 3 * v * width + 3 * w;
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) to[stride * (size_t)r + (size_t)c] += from[width * r + c];
    }
}

static void hand_on(ContactStiffness *stiffness, const ContactStiffnessSink *sink) {
  size_t width = 3 * (size_t)stiffness->count, stride = 3 * (size_t)stiffness->most;
  for (size_t r = 0; r < width; r++) {
    memcpy(stiffness->dense + r * width, stiffness->sum + r * stride, width * sizeof(double));
    memset(stiffness->sum + r * stride, 0, width * sizeof(double));
  }
  if (width > 0) sink->add_dense(sink->self, stiffness->count, stiffness->vertices, stiffness->dense);
  forget_vertices(stiffness);
}

// ---- All of it.

static void bend(const ContactLayout *layout, const ContactEvaluation *evaluation, int k,
                 const ContactStiffnessWay *way, double *matrix) {
  const ContactPair *pair = &evaluation->pairs[k];
  double coordinates[OVERLAP_PAIR_SIZE];
  if (!contact_layout_has_field(layout)) {
    contact_volume_bend(evaluation->fields[k].energy, evaluation->pair_forces + OVERLAP_PAIR_SIZE * (size_t)k,
                        pair->cells[1] < 0 ? 4 : 8, matrix);
    return;
  }
  memcpy(coordinates, evaluation->coordinates + OVERLAP_PAIR_SIZE * (size_t)k, sizeof coordinates);
  if (way->is_turned && evaluation->fields[k].law) {
    contact_field_turn_law(layout, pair, evaluation->time, coordinates, &evaluation->fields[k], matrix);
    return;
  }
  if (pair->cells[1] < 0) {
    contact_field_bend_shape(layout, pair, evaluation->time, coordinates, matrix);
    return;
  }
  if (way->slopes) {
    contact_field_turn(layout, pair, coordinates, &evaluation->fields[k], way->slopes + 96 * (size_t)k,
                       matrix);
    return;
  }
  contact_layout_unsettle_pair(layout, pair, coordinates);
  contact_field_bend(layout, pair, coordinates, matrix);
}

// Two elements that have one pair need no sum.
static void hand_on_portion(ContactStiffness *stiffness, const ContactLayout *layout, int first, int end,
                            int whole, const ContactPair *pairs, const double *matrices,
                            const ContactStiffnessSink *sink) {
  const ContactStiffnessKey *order = stiffness->order;
  for (int k = first; k < end; k++) {
    const double *matrix = matrices + MATRIX_SIZE * (size_t)(k - first);
    bool is_first = k == 0 || !are_alike(&order[k], &order[k - 1]);
    bool is_last = k + 1 == whole || !are_alike(&order[k], &order[k + 1]);
    int places[8], count = place_pair(stiffness, layout, &pairs[order[k].pair], places);
    if (is_first && is_last && stiffness->count == count) {
      sink->add_dense(sink->self, count, stiffness->vertices, matrix);
      forget_vertices(stiffness);
      continue;
    }
    add_pair(stiffness, count, places, matrix);
    if (is_last) hand_on(stiffness, sink);
  }
}

// Portions are handed on in their order, each while another thread finds the next one's matrices.
Status contact_stiffness_add(ContactStiffness *stiffness, const ContactLayout *layout,
                             const ContactEvaluation *evaluation, int interface,
                             const ContactStiffnessWay *way, const ContactStiffnessSink *sink) {
  int count;
  TRY(order_pairs(stiffness, layout, interface, evaluation->pair_count, evaluation->pairs, &count));
  const ContactStiffnessKey *order = stiffness->order;
#pragma omp parallel for ordered schedule(dynamic) if (count > FEW_PAIRS)
  for (int first = 0; first < count; first += PORTION_SIZE) {
    double matrices[MATRIX_SIZE * PORTION_SIZE];
    int end = first + PORTION_SIZE < count ? first + PORTION_SIZE : count;
    for (int k = first; k < end; k++)
      bend(layout, evaluation, order[k].pair, way, matrices + MATRIX_SIZE * (size_t)(k - first));
#pragma omp ordered
    hand_on_portion(stiffness, layout, first, end, count, evaluation->pairs, matrices, sink);
  }
  return STATUS_OK;
}

// ---- What may couple.

void contact_coupled_destroy(ContactCoupled *coupled) {
  memory_free(coupled->keys);
  *coupled = (ContactCoupled){0};
}

// Takes the first `count` of the order, ascending and new, from the back so that nothing is moved twice.
static Status merge(const ContactStiffness *stiffness, int count, ContactCoupled *coupled) {
  int kept = coupled->count, whole = kept + count;
  if (!memory_reserve((void **)&coupled->keys, &coupled->capacity, (size_t)whole, sizeof *coupled->keys))
    return status_no_memory("contact couplings");
  for (int to = whole - 1; count > 0; to--) {
    bool is_new = kept == 0 || compare_elements(&stiffness->order[count - 1], &coupled->keys[kept - 1]) > 0;
    coupled->keys[to] = is_new ? stiffness->order[--count] : coupled->keys[--kept];
  }
  coupled->count = whole;
  return STATUS_OK;
}

// Visits the vertices that any two elements with a pair among these couple. None of them is coupled.
static Status visit_elements(ContactStiffness *stiffness, const ContactLayout *layout, int count,
                             const ContactPair *pairs, ContactCoupled *coupled, void *visitor,
                             Status (*visit)(void *visitor, int count, const int *vertices)) {
  int new_count = 0;
  TRY(order_pairs(stiffness, layout, CONTACT_ALL_INTERFACES, count, pairs, &count));
  for (int k = 0; k < count; k++) {
    const ContactStiffnessKey key = stiffness->order[k];
    if (k > 0 && are_alike(&key, &stiffness->order[k - 1])) continue;
    const ContactPair *pair = &pairs[key.pair];
    for (int side = 0; side < 2; side++)
      if (layout->interfaces[pair->interface].weight[side] > 0)
        list_element(stiffness, layout, contact_mesh_tet(&layout->mesh, pair->cells[side]));
    Status status = visit(visitor, stiffness->count, stiffness->vertices);
    forget_vertices(stiffness);
    TRY(status);
    stiffness->order[new_count++] = key;
  }
  return merge(stiffness, new_count, coupled);
}

// Looks for elements that are coupled among those of one interface in the order of the candidates, in which
// one cell meets several in turn.
typedef struct Lookup {
  const ContactCoupled *coupled;
  ContactStiffnessKey last; // that was looked for
  bool was_found;
  int begin, end; // keys of its interface and first element
} Lookup;

// The first of the keys that is not before this one, by its elements.
static int find_key(const ContactCoupled *coupled, int low, int high, const ContactStiffnessKey *key) {
  while (low < high) {
    int middle = low + (high - low) / 2;
    if (compare_elements(&coupled->keys[middle], key) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static bool is_coupled(Lookup *lookup, const ContactStiffnessKey *key) {
  const ContactCoupled *coupled = lookup->coupled;
  if (are_alike(key, &lookup->last)) return lookup->was_found;
  if (key->interface != lookup->last.interface || key->elements[0] != lookup->last.elements[0]) {
    ContactStiffnessKey edge = {key->interface, {key->elements[0], INT_MIN}, 0};
    lookup->begin = find_key(coupled, 0, coupled->count, &edge);
    edge.elements[1] = INT_MAX;
    lookup->end = find_key(coupled, lookup->begin, coupled->count, &edge);
  }
  int place = find_key(coupled, lookup->begin, lookup->end, key);
  lookup->last = *key;
  lookup->was_found = place < lookup->end && are_alike(&coupled->keys[place], key);
  return lookup->was_found;
}

// The box round a cell, found once for those that follow each other.
typedef struct Box {
  int cell; // −1: none
  double sides[6];
} Box;

static const double *box_of(Box *box, const ContactLayout *layout, int cell, const double *positions) {
  if (box->cell != cell) contact_bounds_of_tet(layout->mesh.cells[cell], positions, box->sides);
  box->cell = cell;
  return box->sides;
}

static bool is_within(const ContactLayout *layout, const ContactPair *pair, double time,
                      const double *positions, double reach, Box *first) {
  if (pair->cells[1] >= 0) {
    double other[6];
    contact_bounds_of_tet(layout->mesh.cells[pair->cells[1]], positions, other);
    return contact_bounds_distance(box_of(first, layout, pair->cells[0], positions), other) <=
           reach + 3 * layout->nudge;
  }
  double x[12];
  contact_layout_gather_whole(layout, pair->cells[0], positions, x);
  const ContactShape *shape = &layout->def.shapes[layout->interfaces[pair->interface].shape];
  return contact_shape_separation(shape, time, x, reach) <= reach;
}

Status contact_stiffness_couple(ContactStiffness *stiffness, const ContactLayout *layout,
                                const ContactCandidateList *candidates, double time, const double *positions,
                                double reach, ContactCoupled *coupled, void *visitor,
                                Status (*visit)(void *visitor, int count, const int *vertices)) {
  int count = 0;
  Lookup lookup = {.coupled = coupled, .last = {.interface = -1}};
  Box box = {.cell = -1};
  for (int k = 0; k < candidates->count; k++) {
    const ContactPair *pair = &candidates->pairs[k];
    const ContactStiffnessKey key = key_of(layout, pair, k);
    if (is_coupled(&lookup, &key) || !is_within(layout, pair, time, positions, reach, &box)) continue;
    if (!memory_reserve((void **)&stiffness->near_pairs, &stiffness->near_capacity, (size_t)count + 1,
                        sizeof(ContactPair)))
      return status_no_memory("contact couplings");
    stiffness->near_pairs[count++] = *pair;
  }
  return visit_elements(stiffness, layout, count, stiffness->near_pairs, coupled, visitor, visit);
}

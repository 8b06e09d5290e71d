// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/stiffness.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "contact/pressure/potential.h"
#include "contact/search/bounds.h"
#include "contact/shape/shape.h"
#include "overlap/clip/clip.h"

enum { PAIRS_AT_ONCE = 256 }; // Hessians held in memory: 1.2 MB

Status contact_stiffness_create(ContactStiffness *stiffness, const ContactLayout *layout) {
  *stiffness = (ContactStiffness){0};
  stiffness->hessians = memory_zeroed(PAIRS_AT_ONCE, 576 * sizeof(double));
  stiffness->volumes = memory_zeroed(PAIRS_AT_ONCE, sizeof(double));
  if (!stiffness->hessians || !stiffness->volumes) return status_no_memory("contact stiffness");
  TRY(contact_field_stiffness_create(&stiffness->field, layout));
  return contact_patches_create(&stiffness->near, layout);
}

void contact_stiffness_destroy(ContactStiffness *stiffness) {
  contact_patches_destroy(&stiffness->near);
  contact_field_stiffness_destroy(&stiffness->field);
  memory_free(stiffness->near_pairs);
  memory_free(stiffness->nodes);
  memory_free(stiffness->vertices);
  memory_free(stiffness->gradient);
  memory_free(stiffness->place);
  memory_free(stiffness->hessians);
  memory_free(stiffness->volumes);
  *stiffness = (ContactStiffness){0};
}

// ---- Collecting a clique: nodes once each, with the gradient of w by them.

static Status reserve(ContactStiffness *stiffness, int node_count) {
  size_t n = (size_t)node_count;
  bool fits =
      memory_reserve((void **)&stiffness->nodes, &stiffness->node_capacity, n, sizeof(int)) &&
      memory_reserve((void **)&stiffness->vertices, &stiffness->vertex_capacity, n, sizeof(int)) &&
      memory_reserve((void **)&stiffness->gradient, &stiffness->gradient_capacity, 3 * n, sizeof(double)) &&
      memory_reserve((void **)&stiffness->place, &stiffness->place_capacity, n, sizeof(int));
  return fits ? STATUS_OK : status_no_memory("contact stiffness");
}

static void empty(ContactStiffness *stiffness) {
  for (int k = 0; k < stiffness->count; k++) stiffness->place[stiffness->nodes[k]] = 0;
  stiffness->count = 0;
}

static double *gradient_of(ContactStiffness *stiffness, const ContactPatches *patches, int node) {
  int *place = &stiffness->place[node];
  if (*place == 0) {
    stiffness->nodes[stiffness->count] = node;
    stiffness->vertices[stiffness->count] = patches->nodes[node].vertex;
    for (int c = 0; c < 3; c++) stiffness->gradient[3 * stiffness->count + c] = 0;
    *place = ++stiffness->count;
  }
  return stiffness->gradient + 3 * (*place - 1);
}

// What is being walked: patches of pairs, with ∇V of each pair or, to couple only, without.
typedef struct Walk {
  const ContactLayout *layout;
  const ContactPatches *patches;
  const ContactInterfaceDef *interface; // of the patch that is walked
  const ContactPair *pairs;
  const double *gradients; // NULL: couple only
} Walk;

// w += scale · V of pair k, and its vertices.
static void collect_pair(ContactStiffness *stiffness, const Walk *walk, int k, double scale) {
  for (int side = 0; side < 2; side++) {
    if (!(walk->interface->weight[side] > 0)) continue;
    const ContactElement *element = &walk->patches->elements[walk->patches->pair_elements[k][side]];
    for (int v = 0; v < 4; v++) {
      double *gradient = gradient_of(stiffness, walk->patches, element->nodes[v]);
      if (!walk->gradients) continue;
      for (int c = 0; c < 3; c++)
        gradient[c] += scale * walk->gradients[24 * (size_t)k + (size_t)(12 * side + 3 * v + c)];
    }
  }
}

static void collect_element(ContactStiffness *stiffness, const Walk *walk, int e, double scale) {
  const ContactRows *pairs = &walk->patches->element_pairs;
  for (int r = pairs->begin[e]; r < pairs->begin[e + 1]; r++)
    collect_pair(stiffness, walk, pairs->items[r], scale);
}

static void collect_node(ContactStiffness *stiffness, const Walk *walk, int n) {
  const ContactRows *elements = &walk->patches->node_elements;
  for (int r = elements->begin[n]; r < elements->begin[n + 1]; r++)
    collect_element(stiffness, walk, elements->items[r], 0.25);
}

// ---- The terms c ∇w ∇wᵀ of a patch, each given to `take` once it is collected.

typedef Status (*TakeClique)(void *self, const ContactStiffness *stiffness, double curvature);

static Status walk_nodes(ContactStiffness *stiffness, const Walk *walk, const ContactPatch *patch, void *self,
                         TakeClique take) {
  for (int n = patch->node_begin; n < patch->node_end; n++) {
    const ContactNode *node = &walk->patches->nodes[n];
    if (!(walk->interface->weight[node->side] > 0)) continue;
    empty(stiffness);
    collect_node(stiffness, walk, n);
    TRY(take(self, stiffness, contact_potential_curvature(walk->layout, walk->interface, node)));
  }
  return STATUS_OK;
}

static Status walk_all(ContactStiffness *stiffness, const ContactLayout *layout,
                       const ContactPatches *patches, const ContactPair *pairs, const double *gradients,
                       void *self, TakeClique take) {
  TRY(reserve(stiffness, patches->node_count));
  for (int p = 0; p < patches->patch_count; p++) {
    const ContactPatch *patch = &patches->patches[p];
    Walk walk = {layout, patches, &layout->interfaces[patch->interface], pairs, gradients};
    TRY(walk_nodes(stiffness, &walk, patch, self, take));
  }
  empty(stiffness);
  return STATUS_OK;
}

// ---- The geometric part: p_ij ∇²V_ij.

// Gives the rows and columns of one tetrahedron of a pair's (24, 24) to the sink.
static void add_side(const ContactStiffnessSink *sink, const int vertices[4], const double *hessian,
                     int side) {
  double block[144];
  for (int r = 0; r < 12; r++)
    for (int c = 0; c < 12; c++) block[12 * r + c] = hessian[24 * (12 * side + r) + 12 * side + c];
  sink->add_dense(sink->self, 4, vertices, block);
}

static void add_mesh_pair(const ContactStiffnessSink *sink, const ContactLayout *layout,
                          const ContactPair *pair, double pressure, double *hessian) {
  const double *weight = layout->interfaces[pair->interface].weight;
  const int *a = contact_layout_vertices(layout, pair->cells[0]),
            *b = contact_layout_vertices(layout, pair->cells[1]);
  for (int k = 0; k < 576; k++) hessian[k] *= pressure;
  if (weight[0] > 0 && weight[1] > 0)
    sink->add_dense(sink->self, 8, (int[]){a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]}, hessian);
  else
    add_side(sink, weight[0] > 0 ? a : b, hessian, weight[0] > 0 ? 0 : 1);
}

static Status add_mesh_pairs(ContactStiffness *stiffness, const ContactLayout *layout,
                             const ContactEvaluation *evaluation, const OverlapModel *model,
                             const ContactStiffnessSink *sink) {
  for (int first = 0; first < evaluation->mesh_pair_count; first += PAIRS_AT_ONCE) {
    int left = evaluation->mesh_pair_count - first, count = left < PAIRS_AT_ONCE ? left : PAIRS_AT_ONCE;
    OverlapBatch batch = {.pair_count = count,
                          .pairs = evaluation->coordinates + 24 * (size_t)first,
                          .volume = stiffness->volumes,
                          .hessian = stiffness->hessians};
    TRY(overlap_model_eval(model, &batch));
    for (int k = 0; k < count; k++)
      add_mesh_pair(sink, layout, &evaluation->pairs[first + k], evaluation->pressures[first + k],
                    stiffness->hessians + 576 * (size_t)k);
  }
  return STATUS_OK;
}

static void add_shape_pairs(const ContactLayout *layout, const ContactEvaluation *evaluation,
                            const ContactStiffnessSink *sink) {
  for (int k = evaluation->mesh_pair_count; k < evaluation->pair_count; k++) {
    const ContactPair *pair = &evaluation->pairs[k];
    const ContactShape *shape = &layout->def.shapes[layout->interfaces[pair->interface].shape];
    double x[12], volume, gradient[12], hessian[144];
    contact_layout_gather_whole(layout, pair->cells[0], evaluation->positions, x);
    contact_shape_overlap(shape, evaluation->time, x, &volume, gradient, hessian);
    for (int e = 0; e < 144; e++) hessian[e] *= evaluation->pressures[k];
    sink->add_dense(sink->self, 4, contact_layout_vertices(layout, pair->cells[0]), hessian);
  }
}

static Status give_outer(void *self, const ContactStiffness *stiffness, double curvature) {
  const ContactStiffnessSink *sink = self;
  sink->add_outer(sink->self, stiffness->count, stiffness->vertices, stiffness->gradient, curvature);
  return STATUS_OK;
}

Status contact_stiffness_add(ContactStiffness *stiffness, const ContactLayout *layout,
                             ContactEvaluation *evaluation, const OverlapModel *model,
                             const ContactStiffnessSink *sink) {
  if (layout->mesh.has_field)
    return contact_field_stiffness_add(&stiffness->field, layout, evaluation, sink->self, sink->add_dense);
  ContactStiffnessSink borrowed = *sink;
  TRY(contact_patches_index(&evaluation->patches));
  TRY(walk_all(stiffness, layout, &evaluation->patches, evaluation->pairs, evaluation->gradients, &borrowed,
               give_outer));
  if (!layout->def.use_full_hessian) return STATUS_OK;
  add_shape_pairs(layout, evaluation, sink);
  // Newton's matrix may be another model's: that changes how fast the method converges, not what it finds
  static const OverlapModel lender = {.ops = &overlap_clip_ops};
  return add_mesh_pairs(stiffness, layout, evaluation, overlap_model_has_hessian(model) ? model : &lender,
                        sink);
}

Status contact_stiffness_add_nodes(ContactStiffness *stiffness, const ContactLayout *layout,
                                   ContactEvaluation *evaluation, const double *coefficients,
                                   const ContactStiffnessSink *sink) {
  const ContactPatches *patches = &evaluation->patches;
  TRY(contact_patches_index(&evaluation->patches));
  TRY(reserve(stiffness, patches->node_count));
  for (int p = 0; p < patches->patch_count; p++) {
    const ContactPatch *patch = &patches->patches[p];
    const ContactInterfaceDef *interface = &layout->interfaces[patch->interface];
    Walk walk = {layout, patches, interface, evaluation->pairs, evaluation->gradients};
    for (int n = patch->node_begin; n < patch->node_end; n++) {
      if (!(interface->weight[patches->nodes[n].side] > 0)) continue;
      empty(stiffness);
      collect_node(stiffness, &walk, n);
      sink->add_outer(sink->self, stiffness->count, stiffness->vertices, stiffness->gradient,
                      coefficients[n]);
    }
  }
  empty(stiffness);
  return STATUS_OK;
}

// ---- What may couple.

static bool is_within(const ContactLayout *layout, const ContactPair *pair, double time,
                      const double *positions, double reach) {
  if (pair->cells[1] >= 0) {
    double box_a[6], box_b[6];
    contact_bounds_of_tet(layout->mesh.cells[pair->cells[0]], positions, box_a);
    contact_bounds_of_tet(layout->mesh.cells[pair->cells[1]], positions, box_b);
    return contact_bounds_distance(box_a, box_b) <= reach + 3 * layout->nudge;
  }
  double x[12];
  contact_layout_gather_whole(layout, pair->cells[0], positions, x);
  const ContactShape *shape = &layout->def.shapes[layout->interfaces[pair->interface].shape];
  return contact_shape_separation(shape, time, x, reach) <= reach;
}

typedef struct Visit {
  void *visitor;
  Status (*visit)(void *visitor, int count, const int *vertices);
} Visit;

static Status give_vertices(void *self, const ContactStiffness *stiffness, double curvature) {
  (void)curvature;
  const Visit *visit = self;
  return visit->visit(visit->visitor, stiffness->count, stiffness->vertices);
}

Status contact_stiffness_couple(ContactStiffness *stiffness, const ContactLayout *layout,
                                const ContactCandidateList *candidates, double time, const double *positions,
                                double reach, void *visitor,
                                Status (*visit)(void *visitor, int count, const int *vertices)) {
  if (!memory_reserve((void **)&stiffness->near_pairs, &stiffness->near_capacity, (size_t)candidates->count,
                      sizeof(ContactPair)))
    return status_no_memory("contact couplings");
  int count = 0;
  for (int k = 0; k < candidates->count; k++)
    if (is_within(layout, &candidates->pairs[k], time, positions, reach))
      stiffness->near_pairs[count++] = candidates->pairs[k];
  if (layout->mesh.has_field)
    return contact_field_stiffness_couple(&stiffness->field, layout, count, stiffness->near_pairs, visitor,
                                          visit);
  TRY(contact_patches_build(&stiffness->near, layout, count, stiffness->near_pairs));
  TRY(contact_patches_index(&stiffness->near));
  Visit self = {visitor, visit};
  return walk_all(stiffness, layout, &stiffness->near, stiffness->near_pairs, NULL, &self, give_vertices);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/evaluation.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "contact/pressure/field_pull.h"
#include "contact/pressure/patch/imprint.h"
#include "contact/rest.h"
#include "contact/search/bounds.h"
#include "contact/shape/shape.h"
#include "contact/volume/volume.h"
#include "overlap/separation.h"
#include "overlap/slopes.h"

// Pairs that are looked at together. Two portions take less time than to tell other ranks of them.
enum { PORTION_SIZE = 64, FEW_TO_SHARE = 2 * PORTION_SIZE };

Status contact_evaluation_create(ContactEvaluation *evaluation, const ContactLayout *layout) {
  *evaluation = (ContactEvaluation){.blamed = -1};
  evaluation->positions = memory_zeroed((size_t)layout->mesh.position_count, 3 * sizeof(double));
  evaluation->forces = memory_zeroed((size_t)layout->def.vertex_count, 3 * sizeof(double));
  evaluation->covered = memory_zeroed((size_t)layout->def.tet_count, sizeof(double));
  evaluation->interfaces = memory_zeroed((size_t)layout->interface_count, sizeof(ContactInterface));
  evaluation->boxes = memory_zeroed((size_t)layout->mesh.cell_count, sizeof *evaluation->boxes);
  if (!evaluation->boxes || !evaluation->positions || !evaluation->forces || !evaluation->covered ||
      !evaluation->interfaces)
    return status_no_memory("contact forces");
  for (int f = 0; f < layout->interface_count; f++)
    evaluation->interfaces[f] =
        (ContactInterface){.a = layout->interfaces[f].a, .b = layout->interfaces[f].b};
  evaluation->given_forces = evaluation->forces;
  evaluation->given_covered = evaluation->covered;
  return contact_patches_create(&evaluation->patches, layout);
}

void contact_evaluation_destroy(ContactEvaluation *evaluation) {
  contact_patches_destroy(&evaluation->patches);
  memory_free(evaluation->positions);
  memory_free(evaluation->pairs);
  memory_free(evaluation->coordinates);
  memory_free(evaluation->volumes);
  memory_free(evaluation->slopes);
  memory_free(evaluation->gradients);
  memory_free(evaluation->pair_forces);
  memory_free(evaluation->nodes);
  memory_free(evaluation->forces);
  memory_free(evaluation->covered);
  memory_free(evaluation->interfaces);
  memory_free(evaluation->is_kept);
  memory_free(evaluation->boxes);
  memory_free(evaluation->flags);
  memory_free(evaluation->centroids);
  memory_free(evaluation->fields);
  memory_free(evaluation->elements), memory_free(evaluation->bodies);
  memory_free(evaluation->rest_volumes);
  *evaluation = (ContactEvaluation){0};
}

static Status reserve(ContactEvaluation *evaluation, const ContactLayout *layout, int count) {
  size_t n = (size_t)count, size = sizeof(double);
  bool fits =
      memory_reserve((void **)&evaluation->coordinates, &evaluation->coordinate_capacity, 24 * n, size) &&
      memory_reserve((void **)&evaluation->volumes, &evaluation->volume_capacity, n, size) &&
      memory_reserve((void **)&evaluation->pair_forces, &evaluation->force_capacity, 24 * n, size) &&
      memory_reserve((void **)&evaluation->fields, &evaluation->field_capacity, n,
                     sizeof(ContactFieldPair)) &&
      memory_reserve((void **)&evaluation->flags, &evaluation->flag_capacity, n, sizeof(unsigned));
  if (!contact_layout_has_field(layout))
    fits = fits && memory_reserve((void **)&evaluation->nodes, &evaluation->node_capacity, 8 * n, size);
  return fits ? STATUS_OK : status_no_memory("overlapping pairs");
}

// Room for what the model is asked besides volumes.
static Status reserve_answers(ContactEvaluation *evaluation, bool wants_gradient, bool wants_centroid) {
  size_t n = (size_t)evaluation->pair_count, size = sizeof(double);
  bool fits = true;
  if (wants_gradient)
    fits = memory_reserve((void **)&evaluation->gradients, &evaluation->gradient_capacity, 24 * n, size);
  if (wants_centroid)
    fits =
        fits && memory_reserve((void **)&evaluation->centroids, &evaluation->centroid_capacity, 3 * n, size);
  return fits ? STATUS_OK : status_no_memory("overlapping pairs");
}

// What stands at rest of an array; 0 without.
static double resting(const double *values, size_t place) {
  return values ? values[place] : 0;
}

// Forgets the last result at a cost of its own size.
static void clear(ContactEvaluation *evaluation) {
  evaluation->blamed = -1;
  const ContactPatches *patches = &evaluation->patches;
  const ContactRest *rest = evaluation->rest;
  const double *forces = rest ? rest->forces : NULL, *covered = rest ? rest->covered : NULL;
  evaluation->has_slopes = false;
  for (int n = 0; n < patches->node_count; n++)
    for (size_t c = 0; c < 3; c++) {
      size_t place = 3 * (size_t)patches->nodes[n].vertex + c;
      evaluation->forces[place] = resting(forces, place);
    }
  for (int e = 0; e < patches->element_count; e++) {
    size_t place = (size_t)patches->elements[e].tet;
    evaluation->covered[place] = resting(covered, place);
  }
  evaluation->version = 0;
  evaluation->energy = rest ? rest->energy : 0;
  evaluation->counts = (ContactPairCounts){0};
}

void contact_evaluation_start_over(ContactEvaluation *evaluation, const ContactLayout *layout) {
  const ContactRest *rest = evaluation->rest;
  ContactPatches *patches = &evaluation->patches;
  size_t forces = 3 * (size_t)layout->def.vertex_count * sizeof(double);
  size_t covered = (size_t)layout->def.tet_count * sizeof(double);
  patches->patch_count = patches->element_count = patches->node_count = patches->pair_count = 0;
  evaluation->pair_count = evaluation->mesh_pair_count = 0;
  if (rest) {
    memcpy(evaluation->forces, rest->forces, forces);
    memcpy(evaluation->covered, rest->covered, covered);
  } else {
    memset(evaluation->forces, 0, forces);
    memset(evaluation->covered, 0, covered);
  }
  evaluation->version = 0;
}

// Lists the candidates whose boxes meet, nudges allowed for.
static Status sift_by_boxes(ContactEvaluation *evaluation, const ContactLayout *layout,
                            const ContactCandidateList *candidates, bool with_shapes,
                            const double *positions) {
  int count = candidates->count, kept = 0;
  double apart = 3 * layout->nudge;
  if (!memory_reserve((void **)&evaluation->is_kept, &evaluation->kept_capacity, (size_t)count, 1))
    return status_no_memory("candidate pairs");
  contact_candidates_bound(candidates, layout, positions, evaluation->boxes);
#pragma omp parallel for schedule(static) reduction(+ : kept) if (count > 16384)
  for (int k = 0; k < count; k++) {
    const int *cells = candidates->pairs[k].cells;
    evaluation->is_kept[k] =
        cells[1] < 0
            ? with_shapes
            : !(contact_bounds_distance(evaluation->boxes[cells[0]], evaluation->boxes[cells[1]]) > apart);
    kept += evaluation->is_kept[k];
  }
  if (!memory_reserve((void **)&evaluation->pairs, &evaluation->pair_capacity, (size_t)kept + 1,
                      sizeof(ContactPair)))
    return status_no_memory("candidate pairs");
  evaluation->pair_count = 0;
  for (int k = 0; k < count; k++) { // copies each, one too many at the end: a branch is mispredicted
    evaluation->pairs[evaluation->pair_count] = candidates->pairs[k];
    evaluation->pair_count += evaluation->is_kept[k];
  }
  return STATUS_OK;
}

// Moves pair `from` and its overlap to the earlier place `to`. By the depth field the forces of shapes are
// known already, those of two bodies are found later from the centroid.
static void move_overlap(ContactEvaluation *evaluation, bool has_field, int from, int to) {
  bool is_of_shape = evaluation->pairs[from].cells[1] < 0;
  size_t source = (size_t)from, place = (size_t)to;
  if (from == to) return;
  evaluation->pairs[to] = evaluation->pairs[from];
  memcpy(evaluation->coordinates + 24 * place, evaluation->coordinates + 24 * source, 24 * sizeof(double));
  evaluation->volumes[to] = evaluation->volumes[from];
  if (!has_field) {
    memcpy(evaluation->gradients + 24 * place, evaluation->gradients + 24 * source, 24 * sizeof(double));
  } else if (!is_of_shape) {
    memcpy(evaluation->centroids + 3 * place, evaluation->centroids + 3 * source, 3 * sizeof(double));
  } else {
    memcpy(evaluation->pair_forces + 24 * place, evaluation->pair_forces + 24 * source, 24 * sizeof(double));
    evaluation->fields[to] = evaluation->fields[from];
  }
}

// Marks the listed pairs but those that a face separates for certain, `mesh_count` of them of two meshes.
static void find_faces_apart(ContactEvaluation *evaluation, const ContactLayout *layout, int mesh_count,
                             const double *positions) {
#pragma omp parallel for schedule(dynamic) if (mesh_count > 2048)
  for (int begin = 0; begin < mesh_count; begin += PORTION_SIZE) {
    bool is_apart[PORTION_SIZE];
    double coordinates[24 * PORTION_SIZE]; // most are not asked for again
    int count = begin + PORTION_SIZE < mesh_count ? PORTION_SIZE : mesh_count - begin;
    for (int k = 0; k < count; k++)
      contact_layout_gather_pair(layout, &evaluation->pairs[begin + k], positions,
                                 coordinates + 24 * (size_t)k);
    overlap_separation_find(count, coordinates, is_apart);
    for (int k = 0; k < count; k++) evaluation->is_kept[begin + k] = !is_apart[k];
  }
}

// Drops of the listed pairs those that a face separates for certain, unless the model sees ghosts, and
// gathers the others.
static Status sift_by_faces(ContactEvaluation *evaluation, const ContactLayout *layout, bool keeps_all,
                            const double *positions) {
  int count = evaluation->pair_count, mesh_count = count, kept = 0;
  while (mesh_count > 0 && evaluation->pairs[mesh_count - 1].cells[1] < 0) mesh_count--;
  if (!keeps_all) find_faces_apart(evaluation, layout, mesh_count, positions);
  evaluation->mesh_pair_count = 0;
  for (int k = 0; k < count; k++) {
    bool is_kept = keeps_all || k >= mesh_count || evaluation->is_kept[k];
    evaluation->pairs[kept] = evaluation->pairs[k];
    evaluation->mesh_pair_count += is_kept && k < mesh_count;
    kept += is_kept;
  }
  evaluation->pair_count = kept;
  TRY(reserve(evaluation, layout, kept));
#pragma omp parallel for schedule(static) if (kept > 8192)
  for (int k = 0; k < kept; k++)
    contact_layout_gather_pair(layout, &evaluation->pairs[k], positions,
                               evaluation->coordinates + 24 * (size_t)k);
  return STATUS_OK;
}

// Names the tetrahedra, as the frames number them, of a pair that the model refused or answered badly.
static Status blame(const ContactLayout *layout, const ContactPair *pair, Status status, const char *why) {
  const ContactInterfaceDef *interface = &layout->interfaces[pair->interface];
  int element = contact_layout_origin(layout, pair->cells[0]);
  const char *name = layout->def.bodies[interface->a].name;
  if (interface->shape >= 0)
    return status_fail(status, "contact of element %d of '%s' and '%s': %s", element, name,
                       layout->def.shapes[interface->shape].name, why);
  return status_fail(status, "contact of element %d of '%s' and element %d of '%s': %s", element, name,
                     contact_layout_origin(layout, pair->cells[1]), layout->def.bodies[interface->b].name,
                     why);
}

static Status blame_volume(const ContactLayout *layout, const ContactPair *pair, double volume) {
  char why[64];
  snprintf(why, sizeof why, "the overlap model gave the volume %g", volume);
  return blame(layout, pair, STATUS_SOLVER, why);
}

// Of a batch that failed, whose first pair is `first`, finds the pair for which the model fails again. A
// model that is no longer there, or was interrupted, is no pair's fault.
static Status blame_failure(ContactEvaluation *evaluation, const ContactLayout *layout,
                            const OverlapModel *model, const OverlapBatch *batch, int first, Status failure) {
  char why[1024];
  if (failure == STATUS_DEVICE || failure == STATUS_INTERRUPTED) return status_prefix(failure, "contact");
  snprintf(why, sizeof why, "%s", status_message());
  for (int k = 0; k < batch->pair_count; k++) {
    OverlapBatch one = overlap_ops_part(batch, k, 1);
    Status status = overlap_model_eval(model, &one);
    if (status) {
      snprintf(why, sizeof why, "%s", status_message());
      evaluation->blamed = first + k;
      return blame(layout, &evaluation->pairs[first + k], status, why);
    }
  }
  return status_fail(failure, "contact: %s", why);
}

static void count_pair(ContactPairCounts *counts, unsigned flags) {
  counts->enclosed += (flags & OVERLAP_ENCLOSED) != 0;
  counts->fallbacks += (flags & OVERLAP_FALLBACK) != 0;
  counts->blended += (flags & OVERLAP_BLENDED) != 0;
  counts->by_net += (flags & OVERLAP_NET) != 0;
  counts->beyond += (flags & OVERLAP_BEYOND) != 0;
  counts->unsound += (flags & OVERLAP_UNSOUND) != 0;
}

// On all ranks the pair that one of them blames.
static Status share_blame(ContactEvaluation *evaluation, Status status) {
  double blamed = evaluation->blamed;
  ranks()->most(&blamed, 1);
  evaluation->blamed = (int)blamed;
  return status;
}

// Each rank evaluates the model for an equal share of the batch, and all receive all results.
static Status ask_model(ContactEvaluation *evaluation, const ContactLayout *layout, const OverlapModel *model,
                        const OverlapBatch *batch) {
  const int *begin = ranks_split(batch->pair_count), first = begin[ranks()->number];
  OverlapBatch own = overlap_ops_part(batch, first, begin[ranks()->number + 1] - first);
  Status status = own.pair_count > 0 ? overlap_model_eval(model, &own) : STATUS_OK;
  if (status) status = blame_failure(evaluation, layout, model, &own, first, status);
  status = ranks()->worst(status);
  if (status) return share_blame(evaluation, status);
  ranks()->join(batch->volume, sizeof *batch->volume, begin);
  if (batch->gradient) ranks()->join(batch->gradient, 24 * sizeof *batch->gradient, begin);
  if (batch->centroid) ranks()->join(batch->centroid, 3 * sizeof *batch->centroid, begin);
  ranks()->join(batch->flags, sizeof *batch->flags, begin);
  return STATUS_OK;
}

// Where the pairs of meshes are from.
static Status find_origins(ContactEvaluation *evaluation, const ContactLayout *layout,
                           OverlapOrigins *origins) {
  const size_t size = 2 * (size_t)evaluation->mesh_pair_count;
  if (!memory_reserve((void **)&evaluation->elements, &evaluation->element_capacity, size, sizeof(int32_t)) ||
      !memory_reserve((void **)&evaluation->bodies, &evaluation->body_capacity, size, sizeof(int32_t)) ||
      !memory_reserve((void **)&evaluation->rest_volumes, &evaluation->rest_capacity, size, sizeof(double)))
    return status_no_memory("overlapping pairs");
  for (size_t k = 0; k < size; k++) {
    const ContactPair *pair = &evaluation->pairs[k / 2];
    const ContactInterfaceDef *interface = &layout->interfaces[pair->interface];
    evaluation->elements[k] = contact_layout_origin(layout, pair->cells[k % 2]);
    evaluation->bodies[k] = k % 2 == 0 ? interface->a : interface->b;
    evaluation->rest_volumes[k] = layout->cell_volumes[pair->cells[k % 2]];
  }
  *origins = (OverlapOrigins){evaluation->elements, evaluation->bodies, evaluation->rest_volumes};
  return STATUS_OK;
}

static Status overlap_meshes(ContactEvaluation *evaluation, const ContactLayout *layout,
                             const OverlapModel *model) {
  int count = evaluation->mesh_pair_count;
  bool wants_centroid = contact_layout_has_field(layout);
  bool wants_gradient = !wants_centroid || !overlap_model_has_own_centroid(model);
  TRY(reserve_answers(evaluation, wants_gradient, wants_centroid));
  if (count == 0) return STATUS_OK;
  OverlapBatch batch = {.pair_count = count,
                        .pairs = evaluation->coordinates,
                        .volume = evaluation->volumes,
                        .gradient = wants_gradient ? evaluation->gradients : NULL,
                        .centroid = wants_centroid ? evaluation->centroids : NULL,
                        .flags = evaluation->flags};
  if (overlap_model_wants_origins(model)) TRY(find_origins(evaluation, layout, &batch.origins));
  if (count < FEW_TO_SHARE) {
    Status status = overlap_model_eval(model, &batch);
    if (status) return blame_failure(evaluation, layout, model, &batch, 0, status);
  } else
    TRY(ask_model(evaluation, layout, model, &batch));
  evaluation->counts.tried = count;
  for (int k = 0; k < count; k++) {
    if (!(evaluation->volumes[k] >= 0 && evaluation->volumes[k] < INFINITY)) {
      evaluation->blamed = k;
      return blame_volume(layout, &evaluation->pairs[k], evaluation->volumes[k]);
    }
    count_pair(&evaluation->counts, evaluation->flags[k]);
  }
  return STATUS_OK;
}

static void overlap_shapes(ContactEvaluation *evaluation, const ContactLayout *layout, double time) {
#pragma omp parallel for schedule(dynamic, 64) if (evaluation->pair_count - evaluation->mesh_pair_count > 512)
  for (int k = evaluation->mesh_pair_count; k < evaluation->pair_count; k++) {
    const ContactShape *shape = &layout->def.shapes[layout->interfaces[evaluation->pairs[k].interface].shape];
    const double *tet = evaluation->coordinates + 24 * (size_t)k;
    if (!contact_layout_has_field(layout)) {
      double *gradient = evaluation->gradients + 24 * (size_t)k;
      contact_shape_overlap(shape, time, tet, &evaluation->volumes[k], gradient);
      memset(gradient + 12, 0, 12 * sizeof(double));
      continue;
    }
    ContactFieldPair *field = &evaluation->fields[k];
    contact_field_press_shape(layout, &evaluation->pairs[k], time, tet, field,
                              evaluation->pair_forces + 24 * (size_t)k);
    evaluation->volumes[k] = field->volume;
  }
}

// Drops the pairs without overlap, keeping the order.
static void keep_overlapping(ContactEvaluation *evaluation, bool has_field) {
  int kept = 0, mesh_kept = 0;
  for (int k = 0; k < evaluation->pair_count; k++) {
    if (!(evaluation->volumes[k] > 0)) continue;
    mesh_kept += k < evaluation->mesh_pair_count;
    move_overlap(evaluation, has_field, k, kept++);
  }
  evaluation->pair_count = kept;
  evaluation->mesh_pair_count = mesh_kept;
}

// W_i = Σ_j V_ij.
static void cover(ContactEvaluation *evaluation) {
  ContactPatches *patches = &evaluation->patches;
  for (int k = 0; k < evaluation->pair_count; k++)
    for (int side = 0; side < 2; side++) {
      int e = patches->pair_elements[k][side];
      if (e >= 0) patches->elements[e].covered += evaluation->volumes[k];
    }
  for (int e = 0; e < patches->element_count; e++) {
    const ContactElement *element = &patches->elements[e];
    evaluation->covered[element->tet] += element->covered;
  }
}

// The pairs' forces onto the nodes.
static void push_apart(ContactEvaluation *evaluation) {
  ContactPatches *patches = &evaluation->patches;
  for (int k = 0; k < evaluation->pair_count; k++)
    for (int side = 0; side < 2; side++) {
      int e = patches->pair_elements[k][side];
      if (e < 0) continue;
      const double *own = evaluation->pair_forces + 24 * (size_t)k + 12 * side;
      for (int v = 0; v < 4; v++) {
        double *force = patches->nodes[patches->elements[e].nodes[v]].force;
        for (int c = 0; c < 3; c++) force[c] += own[3 * v + c];
      }
    }
  for (int n = 0; n < patches->node_count; n++) {
    const ContactNode *node = &patches->nodes[n];
    for (size_t c = 0; c < 3; c++) evaluation->forces[3 * (size_t)node->vertex + c] += node->force[c];
  }
}

// The force on cells[0] of each pair of a patch.
static void sum_lower(const ContactEvaluation *evaluation, const ContactPatch *patch, double force[3]) {
  for (int k = patch->pair_begin; k < patch->pair_end; k++)
    for (int v = 0; v < 12; v++) force[v % 3] += evaluation->pair_forces[24 * (size_t)k + (size_t)v];
}

static void summarise(ContactEvaluation *evaluation, const ContactLayout *layout) {
  const ContactPatches *patches = &evaluation->patches;
  const ContactRest *rest = evaluation->rest;
  for (int f = 0; f < layout->interface_count; f++)
    evaluation->interfaces[f] = rest && rest->is_resting[f] ? rest->interfaces[f]
                                                            : (ContactInterface){.a = layout->interfaces[f].a,
                                                                                 .b = layout->interfaces[f].b,
                                                                                 .centre = {NAN, NAN, NAN}};
  for (int p = 0; p < patches->patch_count; p++) {
    const ContactPatch *patch = &patches->patches[p];
    ContactInterface *interface = &evaluation->interfaces[patch->interface];
    interface->active_count = patch->pair_end - patch->pair_begin;
    for (int k = patch->pair_begin; k < patch->pair_end; k++) interface->volume += evaluation->volumes[k];
    contact_imprint_find(evaluation->fields, patch, interface);
    if (interface->a == interface->b) {
      sum_lower(evaluation, patch, interface->force);
      continue;
    }
    for (int n = patch->node_begin; n < patch->node_end; n++)
      for (int c = 0; c < 3 && patches->nodes[n].side == 0; c++)
        interface->force[c] += patches->nodes[n].force[c];
  }
}

// By the depth field: energies, and the forces on the pairs' own vertices.
static Status press_by_field(ContactEvaluation *evaluation, const ContactLayout *layout) {
  int bad = INT_MAX;
#pragma omp parallel for schedule(dynamic, 32) reduction(min : bad) if (evaluation->mesh_pair_count > 4096)
  for (int k = 0; k < evaluation->pair_count; k++) {
    size_t at = (size_t)k;
    if (k < evaluation->mesh_pair_count)
      contact_field_press(layout, &evaluation->pairs[k], evaluation->coordinates + 24 * at,
                          evaluation->volumes[k], evaluation->centroids + 3 * at, &evaluation->fields[k],
                          evaluation->pair_forces + 24 * at);
    const double *force = evaluation->fields[k].force;
    if (!isfinite(evaluation->fields[k].energy + force[0] + force[1] + force[2]) && k < bad) bad = k;
  }
  if (bad == INT_MAX) return STATUS_OK;
  return blame(layout, &evaluation->pairs[bad], STATUS_RETRY,
               "a tetrahedron is so flat that its depth has no slope");
}

static double sum_energies(const ContactEvaluation *evaluation, const ContactPatch *patch) {
  double energy = 0;
  for (int k = patch->pair_begin; k < patch->pair_end; k++) energy += evaluation->fields[k].energy;
  return energy;
}

static void press_by_volume(ContactEvaluation *evaluation, const ContactLayout *layout) {
  contact_volume_press(layout, &(ContactVolumePairs){.patches = &evaluation->patches,
                                                     .coordinates = evaluation->coordinates,
                                                     .volumes = evaluation->volumes,
                                                     .gradients = evaluation->gradients,
                                                     .nodes = evaluation->nodes,
                                                     .fields = evaluation->fields,
                                                     .forces = evaluation->pair_forces});
}

static Status press(ContactEvaluation *evaluation, const ContactLayout *layout) {
  ContactPatches *patches = &evaluation->patches;
  TRY(contact_patches_build(patches, layout, evaluation->pair_count, evaluation->pairs));
  cover(evaluation);
  if (contact_layout_has_field(layout))
    TRY(press_by_field(evaluation, layout));
  else
    press_by_volume(evaluation, layout);
  for (int p = 0; p < patches->patch_count; p++) {
    ContactPatch *patch = &patches->patches[p];
    patch->energy = sum_energies(evaluation, patch);
    evaluation->energy += patch->energy;
  }
  push_apart(evaluation);
  summarise(evaluation, layout);
  return STATUS_OK;
}

Status contact_evaluation_run(ContactEvaluation *evaluation, const ContactLayout *layout,
                              const ContactCandidateList *candidates, const OverlapModel *model,
                              bool with_shapes, double time, const double *positions) {
  double start = clock_wall_s();
  clear(evaluation);
  TRY(sift_by_boxes(evaluation, layout, candidates, with_shapes, positions));
  TRY(sift_by_faces(evaluation, layout, overlap_model_has_ghosts(model), positions));
  TRY(overlap_meshes(evaluation, layout, model));
  overlap_shapes(evaluation, layout, time);
  keep_overlapping(evaluation, contact_layout_has_field(layout));
  double overlapped = clock_wall_s();
  memcpy(evaluation->positions, positions, 3 * (size_t)layout->mesh.position_count * sizeof(double));
  TRY(press(evaluation, layout));
  evaluation->time = time;
  evaluation->overlap_s = overlapped - start;
  evaluation->force_s = clock_wall_s() - overlapped;
  return STATUS_OK;
}

// Row by row behind each other, what the model gives apart.
static void join_slopes(const double *gradients, const double *rows, size_t count, double *slopes) {
  for (size_t k = 0; k < count; k++) {
    memcpy(slopes + 96 * k, gradients + 24 * k, 24 * sizeof *slopes);
    memcpy(slopes + 96 * k + 24, rows + 72 * k, 72 * sizeof *slopes);
  }
}

static void find_slopes_by_clipping(ContactEvaluation *evaluation, const ContactLayout *layout) {
#pragma omp parallel for schedule(dynamic, 8) if (evaluation->mesh_pair_count > 64)
  for (int k = 0; k < evaluation->mesh_pair_count; k++)
    contact_field_slopes(layout, &evaluation->pairs[k], evaluation->coordinates + 24 * (size_t)k,
                         &evaluation->fields[k], evaluation->slopes + 96 * (size_t)k);
}

static Status find_slopes_by_model(ContactEvaluation *evaluation, const ContactLayout *layout,
                                   const OverlapModel *model) {
  size_t count = (size_t)evaluation->mesh_pair_count;
  double *told = memory_zeroed(97 * count + 1, sizeof *told), *volumes = told, *gradients = told + count,
         *rows = told + 25 * count;
  OverlapBatch batch = {
      .pair_count = (int)count, .pairs = evaluation->coordinates, .volume = volumes, .gradient = gradients};
  Status status = told ? STATUS_OK : status_no_memory("derivatives of overlaps");
  if (!status && overlap_model_wants_origins(model))
    status = find_origins(evaluation, layout, &batch.origins);
  if (!status) status = overlap_slopes_eval(model, &batch, rows);
  if (!status) join_slopes(gradients, rows, count, evaluation->slopes);
  memory_free(told);
  return status;
}

Status contact_evaluation_find_slopes(ContactEvaluation *evaluation, const ContactLayout *layout,
                                      const OverlapModel *model) {
  if (evaluation->has_slopes) return STATUS_OK;
  if (!memory_reserve((void **)&evaluation->slopes, &evaluation->slope_capacity,
                      96 * (size_t)evaluation->mesh_pair_count + 1, sizeof *evaluation->slopes))
    return status_no_memory("derivatives of overlaps");
  if (overlap_slopes_are_there(model))
    TRY(find_slopes_by_model(evaluation, layout, model));
  else
    find_slopes_by_clipping(evaluation, layout);
  evaluation->has_slopes = true;
  return STATUS_OK;
}

Status contact_evaluation_list(ContactEvaluation *evaluation, const ContactLayout *layout,
                               const ContactCandidateList *candidates, const double *positions) {
  clear(evaluation);
  TRY(sift_by_boxes(evaluation, layout, candidates, false, positions));
  return sift_by_faces(evaluation, layout, true, positions);
}

int contact_evaluation_active_count(const ContactEvaluation *evaluation) {
  return evaluation->pair_count + (evaluation->rest ? (int)evaluation->rest->pair_count : 0);
}

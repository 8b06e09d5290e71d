// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/search/candidates.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "contact/limits.h"
#include "contact/search/bounds.h"
#include "contact/shape/shape.h"

// Where the boxes of two bodies meet but the bodies may not, a margin of several steps of free motion is
// tried, bounded so that the trial costs little more than a search.
enum { WIDEST_TRIAL = CONTACT_STEPS_AHEAD };

// The margin of self-contact as a share of the usual one: second neighbours in a mesh are always near, so a
// wide margin would list them all.
static const double SELF_MARGIN = 0.5;

// The step by which speeds are measured where the next one is not known [s].
static const double NO_STEP = 1e-9; // not chosen: any short time does

static Status create_list(ContactCandidateList *list, const ContactLayout *layout) {
  list->begin = memory_zeroed((size_t)layout->interface_count + 1, sizeof(int));
  list->margins = memory_zeroed((size_t)layout->interface_count, sizeof(double));
  list->cells = memory_zeroed((size_t)layout->mesh.cell_count, sizeof(int));
  return list->begin && list->margins && list->cells ? STATUS_OK : status_no_memory("the candidate lists");
}

static void destroy_list(ContactCandidateList *list) {
  memory_free(list->pairs);
  memory_free(list->begin);
  memory_free(list->margins);
  memory_free(list->cells);
}

Status contact_candidates_create(ContactCandidates *candidates, const ContactLayout *layout) {
  *candidates = (ContactCandidates){0};
  TRY(create_list(&candidates->list, layout));
  TRY(create_list(&candidates->next, layout));
  candidates->reference = memory_zeroed(3 * (size_t)layout->mesh.position_count, sizeof(double));
  candidates->is_listed = memory_zeroed((size_t)layout->mesh.cell_count, 1);
  candidates->boxes = memory_zeroed((size_t)layout->def.body_count, sizeof *candidates->boxes);
  size_t parties = (size_t)layout->party_count;
  candidates->is_left_out = memory_zeroed((size_t)layout->interface_count, sizeof *candidates->is_left_out);
  candidates->motions = memory_zeroed(parties, sizeof(ContactMotion));
  candidates->expected = memory_zeroed(parties, sizeof(ContactMotion));
  bool fits = candidates->reference && candidates->is_listed && candidates->boxes && candidates->motions &&
              candidates->expected && candidates->is_left_out;
  return fits ? STATUS_OK : status_no_memory("the candidate lists");
}

void contact_candidates_destroy(ContactCandidates *candidates) {
  destroy_list(&candidates->list);
  destroy_list(&candidates->next);
  contact_broad_destroy(&candidates->found);
  memory_free(candidates->reference);
  memory_free(candidates->is_listed);
  memory_free(candidates->boxes);
  memory_free(candidates->motions);
  memory_free(candidates->is_left_out);
  memory_free(candidates->expected);
  *candidates = (ContactCandidates){0};
}

static void measure(ContactCandidates *candidates, const ContactLayout *layout, double time,
                    const double *positions) {
  contact_motion_measure(layout, candidates->reference_time, candidates->reference, time, positions,
                         candidates->motions);
}

static void expect_motions(ContactCandidates *candidates, const ContactLayout *layout, double time,
                           const double *velocities, double step) {
  const ContactSystemDef *def = &layout->def;
  for (int b = 0; b < def->body_count; b++) {
    ContactMotion *motion = &candidates->expected[b];
    *motion = contact_motion_of(velocities, NULL, def->bodies[b].vertex_begin, def->bodies[b].vertex_end);
    motion->mean = vec3_scale(step, motion->mean);
    motion->spread *= step, motion->longest *= step;
  }
  for (int h = 0; h < def->shape_count; h++)
    candidates->expected[def->body_count + h] =
        contact_motion_of_shape(step * contact_shape_speed(&def->shapes[h], time));
}

void contact_candidates_bound(const ContactCandidateList *list, const ContactLayout *layout,
                              const double *positions, double (*boxes)[6]) {
#pragma omp parallel for schedule(static) if (list->cell_count > 512)
  for (int k = 0; k < list->cell_count; k++)
    contact_bounds_of_tet(layout->mesh.cells[list->cells[k]], positions, boxes[list->cells[k]]);
}

bool contact_candidates_cover(ContactCandidates *candidates, const ContactLayout *layout, double time,
                              const double *positions) {
  if (!candidates->is_made) return false;
  measure(candidates, layout, time, positions);
  for (int f = 0; f < layout->interface_count; f++)
    if (!candidates->is_left_out[f] &&
        !(contact_motion_approach(candidates->motions, &layout->interfaces[f]) <=
          candidates->list.margins[f]))
      return false;
  return true;
}

// Half of the margin is used up, or the next step might use up the rest. The latter cannot be helped by a
// search right after the last one, unless nothing was near and the margin may grow.
static bool wants_search(const ContactCandidates *candidates, const ContactLayout *layout) {
  if (!candidates->is_made) return true;
  for (int f = 0; f < layout->interface_count; f++) {
    if (candidates->is_left_out[f]) continue;
    const ContactInterfaceDef *interface = &layout->interfaces[f];
    double margin = candidates->list.margins[f],
           moved = contact_motion_approach(candidates->motions, interface);
    bool is_empty =
        candidates->list.begin[f] == candidates->list.begin[f + 1] && interface->a != interface->b;
    bool may_leave = moved + contact_motion_approach(candidates->expected, interface) > margin;
    if (!(moved <= margin / 2) || (may_leave && (is_empty || moved > margin / 4))) return true;
  }
  return false;
}

static void bound_bodies(ContactCandidates *candidates, const ContactLayout *layout,
                         const double *positions) {
  for (int b = 0; b < layout->def.body_count; b++) {
    double *box = candidates->boxes[b];
    for (int c = 0; c < 3; c++) box[c] = INFINITY, box[c + 3] = -INFINITY;
    for (int v = layout->def.bodies[b].vertex_begin; v < layout->def.bodies[b].vertex_end; v++)
      for (int c = 0; c < 3; c++) {
        double x = positions[3 * (size_t)v + (size_t)c];
        box[c] = fmin(box[c], x), box[c + 3] = fmax(box[c + 3], x);
      }
  }
}

// A lower bound of the distance of the two parties: nothing meets until they have moved that far.
static double clearance(const ContactCandidates *candidates, const ContactLayout *layout,
                        const ContactInterfaceDef *interface, double time, const double *positions) {
  const ContactBody *a = &layout->def.bodies[interface->a];
  if (interface->shape >= 0)
    return contact_shape_clearance(&layout->def.shapes[interface->shape], time, positions, a->vertex_begin,
                                   a->vertex_end);
  return contact_bounds_distance(candidates->boxes[interface->a], candidates->boxes[interface->b]);
}

static Status push(ContactCandidateList *list, ContactPair pair) {
  if (!memory_reserve((void **)&list->pairs, &list->capacity, (size_t)list->count + 1, sizeof *list->pairs))
    return status_no_memory("candidate pairs");
  list->pairs[list->count++] = pair;
  return STATUS_OK;
}

static ContactBroadSide side_of(const ContactLayout *layout, int body) {
  const ContactMesh *mesh = &layout->mesh;
  int begin = mesh->cell_begin[body], end = mesh->cell_begin[body + 1];
  return (ContactBroadSide){mesh->cells + begin, end - begin, begin};
}

static Status search_bodies(ContactCandidates *candidates, const ContactLayout *layout, int f,
                            const double *positions, double margin) {
  const ContactInterfaceDef *interface = &layout->interfaces[f];
  ContactBroadSide a = side_of(layout, interface->a), b = side_of(layout, interface->b);
  candidates->found.count = 0;
  if (interface->a == interface->b)
    TRY(contact_self_append(&layout->self, &layout->def, &layout->mesh, interface->a, positions, margin,
                            &candidates->found));
  else
    TRY(contact_broad_append(&candidates->found, &a, &b, positions, margin));
  for (int k = 0; k < candidates->found.count; k++) {
    const int *cells = candidates->found.pairs[k];
    TRY(push(&candidates->next, (ContactPair){f, {cells[0], cells[1]}}));
  }
  return STATUS_OK;
}

static Status search_shape(ContactCandidates *candidates, const ContactLayout *layout, int f, double time,
                           const double *positions, double margin) {
  const ContactInterfaceDef *interface = &layout->interfaces[f];
  const ContactShape *shape = &layout->def.shapes[interface->shape];
  const int *begin = layout->mesh.cell_begin;
  for (int i = begin[interface->a]; i < begin[interface->a + 1]; i++) {
    double x[12];
    if (!contact_mesh_leads(&layout->mesh, i)) continue;
    contact_layout_gather_whole(layout, i, positions, x);
    if (contact_shape_separation(shape, time, x, margin) <= margin)
      TRY(push(&candidates->next, (ContactPair){f, {i, -1}}));
  }
  return STATUS_OK;
}

static Status search_with(ContactCandidates *candidates, const ContactLayout *layout, int f, double time,
                          const double *positions, double margin) {
  candidates->next.margins[f] = margin;
  if (layout->interfaces[f].shape < 0) return search_bodies(candidates, layout, f, positions, margin);
  return search_shape(candidates, layout, f, time, positions, margin);
}

// A margin wider than the layout's is kept only where it holds no pair.
static Status search_interface(ContactCandidates *candidates, const ContactLayout *layout, int f, double time,
                               const double *positions) {
  const ContactInterfaceDef *interface = &layout->interfaces[f];
  ContactCandidateList *next = &candidates->next;
  int begin = next->begin[f] = next->count;
  if (candidates->is_left_out[f]) return STATUS_OK;
  if (interface->a == interface->b)
    return search_with(candidates, layout, f, time, positions, SELF_MARGIN * layout->margin);
  double distance = clearance(candidates, layout, interface, time, positions);
  if (distance > layout->margin && isfinite(distance)) {
    next->margins[f] = distance;
    return STATUS_OK;
  }
  double wide = fmin(CONTACT_STEPS_AHEAD * contact_motion_approach(candidates->expected, interface),
                     WIDEST_TRIAL * layout->margin);
  if (wide > layout->margin) {
    TRY(search_with(candidates, layout, f, time, positions, wide));
    if (next->count == begin) return STATUS_OK;
    next->count = begin;
  }
  return search_with(candidates, layout, f, time, positions, layout->margin);
}

void contact_candidates_list_cells(ContactCandidateList *list, unsigned char *is_listed) {
  list->cell_count = 0;
  for (int k = 0; k < list->count; k++)
    for (int side = 0; side < 2 && list->pairs[k].cells[1] >= 0; side++) {
      int cell = list->pairs[k].cells[side];
      if (!is_listed[cell]) list->cells[list->cell_count++] = cell;
      is_listed[cell] = 1;
    }
  for (int k = 0; k < list->cell_count; k++) is_listed[list->cells[k]] = 0;
}

// Fills `next`.
static Status search_all(ContactCandidates *candidates, const ContactLayout *layout, double time,
                         const double *positions) {
  candidates->next.count = 0;
  bound_bodies(candidates, layout, positions);
  for (int f = 0; f < layout->interface_count; f++)
    TRY(search_interface(candidates, layout, f, time, positions));
  candidates->next.begin[layout->interface_count] = candidates->next.count;
  contact_candidates_list_cells(&candidates->next, candidates->is_listed);
  return STATUS_OK;
}

void contact_candidates_leave_out(ContactCandidates *candidates, const ContactLayout *layout,
                                  const bool *is_left_out) {
  ContactCandidateList *list = &candidates->list;
  int kept = 0;
  for (int f = 0; f < layout->interface_count; f++) {
    int begin = list->begin[f], end = list->begin[f + 1];
    candidates->is_left_out[f] = is_left_out && is_left_out[f];
    list->begin[f] = kept;
    for (int k = begin; k < end && !candidates->is_left_out[f]; k++) list->pairs[kept++] = list->pairs[k];
  }
  list->begin[layout->interface_count] = list->count = kept;
}

static bool lists_are_equal(const ContactCandidateList *a, const ContactCandidateList *b) {
  return a->count == b->count &&
         (a->count == 0 || memcmp(a->pairs, b->pairs, (size_t)a->count * sizeof *a->pairs) == 0);
}

// At the speeds with which motions were expected in `step`, the list holds for so long, less a reserve for
// what accelerates; a new list, for longer.
static double time_left(const ContactCandidates *candidates, const ContactLayout *layout, double step) {
  double left = INFINITY;
  for (int f = 0; f < layout->interface_count && step > 0; f++) {
    const ContactInterfaceDef *interface = &layout->interfaces[f];
    if (candidates->is_left_out[f]) continue;
    double expected = contact_motion_approach(candidates->expected, interface),
           free = candidates->list.margins[f] - contact_motion_approach(candidates->motions, interface);
    if (expected > 0) left = fmin(left, CONTACT_MARGIN_USED * free / expected * step);
  }
  return left;
}

Status contact_candidates_update(ContactCandidates *candidates, const ContactLayout *layout, double time,
                                 const double *positions, const double *velocities, double step,
                                 bool *has_changed) {
  *has_changed = false;
  measure(candidates, layout, time, positions);
  step = step > 0 ? step : NO_STEP;
  expect_motions(candidates, layout, time, velocities, step);
  candidates->time_left = time_left(candidates, layout, step);
  if (!wants_search(candidates, layout)) return STATUS_OK;

  double start = clock_wall_s();
  TRY(search_all(candidates, layout, time, positions));
  *has_changed = !candidates->is_made || !lists_are_equal(&candidates->list, &candidates->next);
  ContactCandidateList previous = candidates->list;
  candidates->list = candidates->next;
  candidates->next = previous;
  memcpy(candidates->reference, positions, 3 * (size_t)layout->mesh.position_count * sizeof(double));
  candidates->reference_time = time;
  candidates->is_made = true;
  measure(candidates, layout, time, positions);
  candidates->time_left = time_left(candidates, layout, step);
  candidates->searches++;
  candidates->search_s += clock_wall_s() - start;
  return STATUS_OK;
}

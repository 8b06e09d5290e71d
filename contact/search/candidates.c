// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/search/candidates.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "contact/limits.h"
#include "contact/search/bounds.h"
#include "contact/shape/shape.h"

// Where the boxes of two bodies meet but the bodies may not, a margin of several steps of free motion is
// tried, bounded so that the trial costs little more than a search.
enum { WIDEST_TRIAL = CONTACT_STEPS_AHEAD };

// Fewer are searched one after the other, each by all threads where it can be divided.
enum { FEW_INTERFACES_COUNT = 4 };

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

static Status copy_list(const ContactCandidateList *from, const ContactLayout *layout,
                        ContactCandidateList *to) {
  const size_t interfaces = (size_t)layout->interface_count;
  if (!memory_reserve((void **)&to->pairs, &to->capacity, (size_t)from->count, sizeof *to->pairs))
    return status_no_memory("the candidate lists");
  if (from->count > 0) memcpy(to->pairs, from->pairs, (size_t)from->count * sizeof *to->pairs);
  if (from->cell_count > 0) memcpy(to->cells, from->cells, (size_t)from->cell_count * sizeof *to->cells);
  memcpy(to->begin, from->begin, (interfaces + 1) * sizeof *to->begin);
  if (interfaces > 0) memcpy(to->margins, from->margins, interfaces * sizeof *to->margins);
  to->count = from->count, to->cell_count = from->cell_count;
  return STATUS_OK;
}

Status contact_candidates_create(ContactCandidates *candidates, const ContactLayout *layout) {
  *candidates = (ContactCandidates){0};
  TRY(create_list(&candidates->list, layout));
  candidates->reference = memory_zeroed(3 * (size_t)layout->mesh.position_count, sizeof(double));
  candidates->is_listed = memory_zeroed((size_t)layout->mesh.cell_count, 1);
  candidates->boxes = memory_zeroed((size_t)layout->def.body_count, sizeof *candidates->boxes);
  size_t parties = (size_t)layout->party_count;
  candidates->found_count = layout->interface_count;
  candidates->found = memory_zeroed((size_t)layout->interface_count, sizeof *candidates->found);
  candidates->is_left_out = memory_zeroed((size_t)layout->interface_count, sizeof *candidates->is_left_out);
  candidates->motions = memory_zeroed(parties, sizeof(ContactMotion));
  candidates->expected = memory_zeroed(parties, sizeof(ContactMotion));
  bool fits = candidates->reference && candidates->is_listed && candidates->boxes && candidates->motions &&
              candidates->expected && candidates->is_left_out && candidates->found;
  return fits ? STATUS_OK : status_no_memory("the candidate lists");
}

static void drop_kept(ContactCandidates *candidates) {
  ContactKeptCandidates *kept = &candidates->kept;
  destroy_list(&kept->list);
  memory_free(kept->positions);
  memory_free(kept->shapes);
  memory_free(kept->expected);
  memory_free(kept->is_left_out);
  *kept = (ContactKeptCandidates){0};
}

void contact_candidates_destroy(ContactCandidates *candidates) {
  destroy_list(&candidates->list);
  drop_kept(candidates);
  for (int f = 0; candidates->found && f < candidates->found_count; f++)
    contact_broad_destroy(&candidates->found[f].pairs);
  memory_free(candidates->found);
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
#pragma omp parallel for schedule(static) if (def->vertex_count > 8192)
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
#pragma omp parallel for schedule(static) if (list->cell_count > 4096)
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

double contact_candidates_reach(const ContactCandidates *candidates, const ContactLayout *layout,
                                int interface) {
  return candidates->list.margins[interface] -
         contact_motion_approach(candidates->motions, &layout->interfaces[interface]);
}

double contact_candidates_least_reach(const ContactLayout *layout) {
  double least = INFINITY;
  for (int f = 0; f < layout->interface_count; f++) {
    const ContactInterfaceDef *interface = &layout->interfaces[f];
    double margin = interface->a == interface->b ? SELF_MARGIN * layout->margin : layout->margin;
    least = fmin(least, margin - margin / CONTACT_STEPS_AHEAD);
  }
  return least;
}

// One of the steps that the margin is made for is used up, or the next step might use up the rest. The latter
// cannot be helped by a search before half of that is used up, unless nothing was near and the margin may
// grow.
static bool wants_search(const ContactCandidates *candidates, const ContactLayout *layout) {
  if (!candidates->is_made) return true;
  for (int f = 0; f < layout->interface_count; f++) {
    if (candidates->is_left_out[f]) continue;
    const ContactInterfaceDef *interface = &layout->interfaces[f];
    double margin = candidates->list.margins[f], share = margin / CONTACT_STEPS_AHEAD,
           moved = contact_motion_approach(candidates->motions, interface);
    bool is_empty =
        candidates->list.begin[f] == candidates->list.begin[f + 1] && interface->a != interface->b;
    bool may_leave = moved + contact_motion_approach(candidates->expected, interface) > margin;
    if (!(moved <= share) || (may_leave && (is_empty || moved > share / 2))) return true;
  }
  return false;
}

static void bound_bodies(ContactCandidates *candidates, const ContactLayout *layout,
                         const double *positions) {
#pragma omp parallel for schedule(static) if (layout->def.vertex_count > 8192)
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

static ContactBroadSide side_of(const ContactLayout *layout, int body) {
  const ContactMesh *mesh = &layout->mesh;
  int begin = mesh->cell_begin[body], end = mesh->cell_begin[body + 1];
  return (ContactBroadSide){mesh->cells + begin, end - begin, begin};
}

// A search at one place and time.
typedef struct Search {
  const ContactCandidates *candidates;
  const ContactLayout *layout;
  double time;
  const double *positions;
} Search;

static Status search_bodies(const Search *search, const ContactInterfaceDef *interface, double margin,
                            ContactPairList *pairs) {
  const ContactLayout *layout = search->layout;
  ContactBroadSide a = side_of(layout, interface->a), b = side_of(layout, interface->b);
  if (interface->a == interface->b)
    return contact_self_append(&layout->self, &layout->def, &layout->mesh, interface->a, search->positions,
                               margin, pairs);
  return contact_broad_append(pairs, &a, &b, search->positions, margin);
}

// The second cell of a pair is −1.
static Status search_shape(const Search *search, const ContactInterfaceDef *interface, double margin,
                           ContactPairList *pairs) {
  const ContactLayout *layout = search->layout;
  const ContactShape shape = contact_shape_stand(&layout->def.shapes[interface->shape], search->time);
  const int *begin = layout->mesh.cell_begin;
  for (int i = begin[interface->a]; i < begin[interface->a + 1]; i++) {
    double x[12];
    if (!contact_mesh_leads(&layout->mesh, i)) continue;
    contact_layout_gather_whole(layout, i, search->positions, x);
    if (!(contact_shape_separation(&shape, search->time, x, margin) <= margin)) continue;
    if (!memory_reserve((void **)&pairs->pairs, &pairs->capacity, (size_t)pairs->count + 1,
                        sizeof *pairs->pairs))
      return status_no_memory("candidate pairs");
    int *pair = pairs->pairs[pairs->count++];
    pair[0] = i, pair[1] = -1;
  }
  return STATUS_OK;
}

static Status search_with(const Search *search, int f, double margin, ContactFound *found) {
  const ContactInterfaceDef *interface = &search->layout->interfaces[f];
  found->margin = margin;
  found->pairs.count = 0;
  return interface->shape < 0 ? search_bodies(search, interface, margin, &found->pairs)
                              : search_shape(search, interface, margin, &found->pairs);
}

// A margin wider than the layout's is kept only where it holds no pair.
static Status search_interface(const Search *search, int f, ContactFound *found) {
  const ContactLayout *layout = search->layout;
  const ContactInterfaceDef *interface = &layout->interfaces[f];
  found->pairs.count = 0;
  if (search->candidates->is_left_out[f]) return STATUS_OK;
  if (interface->a == interface->b) return search_with(search, f, SELF_MARGIN * layout->margin, found);
  double distance = clearance(search->candidates, layout, interface, search->time, search->positions);
  if (distance > layout->margin && isfinite(distance)) {
    found->margin = distance;
    return STATUS_OK;
  }
  double wide = fmin(CONTACT_STEPS_AHEAD * contact_motion_approach(search->candidates->expected, interface),
                     WIDEST_TRIAL * layout->margin);
  if (wide > layout->margin) {
    TRY(search_with(search, f, wide, found));
    if (found->pairs.count == 0) return STATUS_OK;
  }
  return search_with(search, f, layout->margin, found);
}

static bool find(ContactCandidates *candidates, const Search *search, int f) {
  candidates->found[f].status = search_interface(search, f, &candidates->found[f]);
  return candidates->found[f].status == STATUS_OK;
}

// Interfaces are searched side by side, a few one by one on all threads; no region encloses these, as libgomp
// makes new threads for each region within another. A message belongs to the thread that failed: this one
// searches the first that failed again to have it.
static Status search_interfaces(ContactCandidates *candidates, const Search *search) {
  int count = search->layout->interface_count, first_failed = count;
  if (count <= FEW_INTERFACES_COUNT) {
    for (int f = count - 1; f >= 0; f--)
      if (!find(candidates, search, f)) first_failed = f;
  } else {
#pragma omp parallel for schedule(dynamic) reduction(min : first_failed)
    for (int f = 0; f < count; f++)
      if (!find(candidates, search, f) && f < first_failed) first_failed = f;
  }
  if (first_failed == count) return STATUS_OK;
  ContactFound *found = &candidates->found[first_failed];
  if (found->status == STATUS_MEMORY) return status_no_memory("candidate pairs");
  TRY(search_interface(search, first_failed, found));
  return status_fail(found->status, "the search for pairs in contact failed once and not again");
}

// The pairs of all interfaces, in their order.
static Status collect_found(ContactCandidates *candidates, int interface_count) {
  ContactCandidateList *list = &candidates->list;
  size_t wanted = 0;
  for (int f = 0; f < interface_count; f++) wanted += (size_t)candidates->found[f].pairs.count;
  if (wanted > INT_MAX ||
      !memory_reserve((void **)&list->pairs, &list->capacity, wanted, sizeof *list->pairs))
    return status_no_memory("candidate pairs");
  list->count = 0;
  for (int f = 0; f < interface_count; f++) {
    const ContactFound *found = &candidates->found[f];
    list->begin[f] = list->count;
    list->margins[f] = found->margin;
    for (int k = 0; k < found->pairs.count; k++)
      list->pairs[list->count++] = (ContactPair){f, {found->pairs.pairs[k][0], found->pairs.pairs[k][1]}};
  }
  list->begin[interface_count] = list->count;
  return STATUS_OK;
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

static Status search_all(ContactCandidates *candidates, const ContactLayout *layout, double time,
                         const double *positions) {
  Search search = {candidates, layout, time, positions};
  candidates->searches++;
  bound_bodies(candidates, layout, positions);
  TRY(search_interfaces(candidates, &search));
  TRY(collect_found(candidates, layout->interface_count));
  contact_candidates_list_cells(&candidates->list, candidates->is_listed);
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
  if (is_left_out) candidates->is_fresh = false;
}

// ---- A list that is kept.

Status contact_candidates_keep(ContactCandidates *candidates, const ContactLayout *layout) {
  const ContactCandidateList *list = &candidates->list;
  ContactKeptCandidates *kept = &candidates->kept;
  drop_kept(candidates);
  if (!candidates->is_fresh) return STATUS_OK;
  TRY(create_list(&kept->list, layout));
  kept->positions =
      memory_copy(candidates->reference, 3 * (size_t)layout->mesh.position_count, sizeof *kept->positions);
  kept->expected = memory_copy(candidates->expected, (size_t)layout->party_count, sizeof *kept->expected);
  kept->shapes = memory_zeroed((size_t)layout->def.shape_count, sizeof *kept->shapes);
  kept->is_left_out =
      memory_copy(candidates->is_left_out, (size_t)layout->interface_count, sizeof *kept->is_left_out);
  if (!kept->positions || !kept->expected || !kept->is_left_out || !kept->shapes ||
      copy_list(list, layout, &kept->list)) {
    drop_kept(candidates);
    return status_no_memory("the candidate lists");
  }
  for (int s = 0; s < layout->def.shape_count; s++)
    kept->shapes[s] = contact_shape_stand(&layout->def.shapes[s], candidates->reference_time);
  kept->time = candidates->reference_time;
  return STATUS_OK;
}

static bool shapes_stand(const ContactKeptCandidates *kept, const ContactLayout *layout, double time) {
  for (int s = 0; s < layout->def.shape_count; s++) {
    const ContactShape shape = contact_shape_stand(&layout->def.shapes[s], time);
    if (memcmp(shape.point, kept->shapes[s].point, sizeof shape.point) != 0 ||
        memcmp(shape.axes, kept->shapes[s].axes, sizeof shape.axes) != 0)
      return false;
  }
  return true;
}

// Whether a search would find the list that is kept: all that it depends on is the same, to the last bit.
static bool is_kept(const ContactCandidates *candidates, const ContactLayout *layout, double time,
                    const double *positions) {
  const ContactKeptCandidates *kept = &candidates->kept;
  return kept->positions && time == kept->time && shapes_stand(kept, layout, time) &&
         memcmp(kept->is_left_out, candidates->is_left_out,
                (size_t)layout->interface_count * sizeof *kept->is_left_out) == 0 &&
         memcmp(kept->expected, candidates->expected, (size_t)layout->party_count * sizeof *kept->expected) ==
             0 &&
         memcmp(kept->positions, positions, 3 * (size_t)layout->mesh.position_count * sizeof *positions) == 0;
}

static Status find_all(ContactCandidates *candidates, const ContactLayout *layout, double time,
                       const double *positions) {
  if (candidates->is_made || !is_kept(candidates, layout, time, positions))
    return search_all(candidates, layout, time, positions);
  return copy_list(&candidates->kept.list, layout, &candidates->list);
}

// At the speeds with which motions were expected in `step`, the list holds for so long; a new list, for
// longer.
static double time_left(const ContactCandidates *candidates, const ContactLayout *layout, double step) {
  double left = INFINITY;
  for (int f = 0; f < layout->interface_count && step > 0; f++) {
    const ContactInterfaceDef *interface = &layout->interfaces[f];
    if (candidates->is_left_out[f]) continue;
    double expected = contact_motion_approach(candidates->expected, interface),
           free = candidates->list.margins[f] - contact_motion_approach(candidates->motions, interface);
    if (expected > 0) left = fmin(left, free / expected * step);
  }
  return left;
}

Status contact_candidates_update(ContactCandidates *candidates, const ContactLayout *layout, double time,
                                 const double *positions, const double *velocities, double step) {
  candidates->is_fresh = false;
  measure(candidates, layout, time, positions);
  step = step > 0 ? step : NO_STEP;
  expect_motions(candidates, layout, time, velocities, step);
  candidates->time_left = time_left(candidates, layout, step);
  if (!wants_search(candidates, layout)) return STATUS_OK;

  double start = clock_wall_s();
  TRY(find_all(candidates, layout, time, positions));
  memcpy(candidates->reference, positions, 3 * (size_t)layout->mesh.position_count * sizeof(double));
  candidates->reference_time = time;
  candidates->is_made = candidates->is_fresh = true;
  measure(candidates, layout, time, positions);
  candidates->time_left = time_left(candidates, layout, step);
  candidates->search_s += clock_wall_s() - start;
  return STATUS_OK;
}

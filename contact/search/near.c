// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/search/near.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "contact/limits.h"
#include "contact/search/bounds.h"
#include "overlap/separation.h"

// The least skin, of the margin.
static const double THINNEST = 1.0 / 64;

Status contact_near_create(ContactNear *near, const ContactLayout *layout) {
  size_t cells = (size_t)layout->mesh.cell_count;
  *near = (ContactNear){0};
  near->list.begin = memory_zeroed((size_t)layout->interface_count + 1, sizeof(int));
  near->list.cells = memory_zeroed(cells, sizeof(int));
  near->reference = memory_zeroed(3 * (size_t)layout->mesh.position_count, sizeof(double));
  near->motions = memory_zeroed((size_t)layout->party_count, sizeof *near->motions);
  near->blown = memory_zeroed(cells, sizeof *near->blown);
  near->boxes = memory_zeroed(cells, sizeof *near->boxes);
  near->is_listed = memory_zeroed(cells, 1);
  bool fits = near->list.begin && near->list.cells && near->reference && near->motions && near->blown &&
              near->boxes && near->is_listed;
  return fits ? STATUS_OK : status_no_memory("the candidate lists");
}

void contact_near_destroy(ContactNear *near) {
  memory_free(near->list.pairs);
  memory_free(near->list.begin);
  memory_free(near->list.cells);
  memory_free(near->reference);
  memory_free(near->motions);
  memory_free(near->blown);
  memory_free(near->boxes);
  memory_free(near->is_listed);
  memory_free(near->is_kept);
  *near = (ContactNear){0};
}

void contact_near_forget(ContactNear *near) {
  near->is_made = false;
}

// The longest way by which two parties with candidates come nearer.
static double longest_approach(const ContactLayout *layout, const ContactCandidates *candidates,
                               const ContactMotion *motions) {
  const int *begin = candidates->list.begin;
  double longest = 0;
  for (int f = 0; f < layout->interface_count; f++)
    if (begin[f + 1] > begin[f])
      longest = fmax(longest, contact_motion_approach(motions, &layout->interfaces[f]));
  return longest;
}

static double used(ContactNear *near, const ContactLayout *layout, const ContactCandidates *candidates,
                   double time, const double *positions) {
  contact_motion_measure(layout, near->reference_time, near->reference, time, positions, near->motions);
  return longest_approach(layout, candidates, near->motions);
}

// Scaled about the middle of the inscribed sphere, of radius r = 3 V / Σ areas, by 1 + d/r. Infinite or no
// numbers where a cell is flat: nothing then separates it.
static void blow_up(const ContactLayout *layout, int cell, const double *positions, double d,
                    double blown[12]) {
  double x[12], areas[4], area = 0;
  Vec3 v[4], middle = {0, 0, 0};
  contact_layout_gather(layout, cell, positions, x);
  for (int k = 0; k < 4; k++) v[k] = vec3_at(x + 3 * k);
  for (int k = 0; k < 4; k++) {
    Vec3 a = v[(k + 1) % 4], b = vec3_sub(v[(k + 2) % 4], a), c = vec3_sub(v[(k + 3) % 4], a);
    areas[k] = vec3_length(vec3_cross(b, c)) / 2;
    area += areas[k];
  }
  for (int k = 0; k < 4; k++) middle = vec3_add(middle, vec3_scale(areas[k] / area, v[k]));
  double radius = fabs(vec3_det4(v[0], v[1], v[2], v[3])) / (2 * area);
  for (int k = 0; k < 4; k++)
    vec3_store(blown + 3 * k, vec3_add(middle, vec3_scale(1 + d / radius, vec3_sub(v[k], middle))));
}

static void bound(const double x[12], double box[6]) {
  static const int corners[4] = {0, 1, 2, 3};
  contact_bounds_of_tet(corners, x, box);
}

static void blow_up_cells(ContactNear *near, const ContactLayout *layout,
                          const ContactCandidateList *candidates, const double *positions) {
#pragma omp parallel for schedule(static) if (candidates->cell_count > 1024)
  for (int k = 0; k < candidates->cell_count; k++) {
    int cell = candidates->cells[k];
    blow_up(layout, cell, positions, near->skin / 2, near->blown[cell]);
    bound(near->blown[cell], near->boxes[cell]);
  }
}

enum { PORTION_SIZE = 64 };

// Marks the pairs of a portion that nothing separates.
static void mark_portion(ContactNear *near, const ContactPair *pairs, int begin, int end) {
  double coordinates[24 * PORTION_SIZE];
  bool is_apart[PORTION_SIZE];
  int asked = 0, from[PORTION_SIZE];
  for (int k = begin; k < end; k++) {
    const int *cells = pairs[k].cells;
    bool is_of_shape = cells[1] < 0; // never apart
    near->is_kept[k] = is_of_shape;
    if (is_of_shape || contact_bounds_distance(near->boxes[cells[0]], near->boxes[cells[1]]) > 0) continue;
    for (int side = 0; side < 2; side++)
      memcpy(coordinates + 24 * (size_t)asked + 12 * side, near->blown[cells[side]], sizeof *near->blown);
    from[asked++] = k;
  }
  if (asked == 0) return;
  overlap_separation_find(asked, coordinates, is_apart);
  for (int k = 0; k < asked; k++) near->is_kept[from[k]] = !is_apart[k];
}

static void mark(ContactNear *near, const ContactCandidateList *candidates) {
#pragma omp parallel for schedule(dynamic) if (candidates->count > 16384)
  for (int begin = 0; begin < candidates->count; begin += PORTION_SIZE) {
    int left = candidates->count - begin;
    mark_portion(near, candidates->pairs, begin, begin + (left < PORTION_SIZE ? left : PORTION_SIZE));
  }
}

static Status make(ContactNear *near, const ContactLayout *layout, const ContactCandidateList *candidates,
                   double time, const double *positions) {
  ContactCandidateList *list = &near->list;
  if (!memory_reserve((void **)&near->is_kept, &near->kept_capacity, (size_t)candidates->count,
                      sizeof *near->is_kept))
    return status_no_memory("candidate pairs");
  blow_up_cells(near, layout, candidates, positions);
  mark(near, candidates);
  size_t kept = 0;
  for (int k = 0; k < candidates->count; k++) kept += near->is_kept[k];
  if (!memory_reserve((void **)&list->pairs, &list->capacity, kept, sizeof *list->pairs))
    return status_no_memory("candidate pairs");
  list->count = 0;
  for (int f = 0; f < layout->interface_count; f++) {
    list->begin[f] = list->count;
    for (int k = candidates->begin[f]; k < candidates->begin[f + 1]; k++)
      if (near->is_kept[k]) list->pairs[list->count++] = candidates->pairs[k];
  }
  list->begin[layout->interface_count] = list->count;
  contact_candidates_list_cells(list, near->is_listed);
  memcpy(near->reference, positions, 3 * (size_t)layout->mesh.position_count * sizeof(double));
  near->reference_time = time;
  near->is_made = true;
  return STATUS_OK;
}

Status contact_near_update(ContactNear *near, const ContactLayout *layout,
                           const ContactCandidates *candidates, double time, const double *positions) {
  double next = longest_approach(layout, candidates, candidates->expected);
  if (near->searches != candidates->searches) near->is_made = false;
  double skin = fmax(CONTACT_STEPS_AHEAD * next, THINNEST * layout->margin);
  bool is_thick = near->skin > CONTACT_STEPS_AHEAD * skin;
  if (near->is_made && !is_thick && used(near, layout, candidates, time, positions) + next <= near->skin)
    return STATUS_OK;
  near->is_made = false;
  near->searches = candidates->searches;
  if (!(skin < layout->margin) || candidates->list.count == 0) return STATUS_OK;
  near->skin = skin;
  return make(near, layout, &candidates->list, time, positions);
}

const ContactCandidateList *contact_near_choose(ContactNear *near, const ContactLayout *layout,
                                                const ContactCandidates *candidates, double time,
                                                const double *positions) {
  bool holds = near->is_made && near->searches == candidates->searches &&
               used(near, layout, candidates, time, positions) <= (1 - CONTACT_ROUNDING) * near->skin;
  return holds ? &near->list : &candidates->list;
}

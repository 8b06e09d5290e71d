// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/onset.h"

#include <math.h>

#include "base/memory.h"
#include "contact/search/bounds.h"
#include "contact/shape/shape.h"
#include "overlap/separation.h"

Status contact_onset_create(ContactOnset *onset, const ContactLayout *layout) {
  *onset = (ContactOnset){0};
  onset->is_marked = memory_zeroed((size_t)layout->mesh.position_count, 1);
  onset->boxes = memory_zeroed((size_t)layout->mesh.cell_count, sizeof *onset->boxes);
  return onset->is_marked && onset->boxes ? STATUS_OK : status_no_memory("watched pairs");
}

void contact_onset_destroy(ContactOnset *onset) {
  memory_free(onset->watched);
  memory_free(onset->is_engaged);
  memory_free(onset->is_marked);
  memory_free(onset->boxes);
  *onset = (ContactOnset){0};
}

static double separation_of(const ContactLayout *layout, const ContactPair *pair, double time,
                            const double *positions, double enough) {
  double x[24];
  if (pair->cells[1] >= 0) {
    contact_layout_gather(layout, pair->cells[0], positions, x);
    contact_layout_gather(layout, pair->cells[1], positions, x + 12);
    return overlap_separation_pair(x, enough);
  }
  contact_layout_gather_whole(layout, pair->cells[0], positions, x);
  return contact_shape_separation(&layout->def.shapes[layout->interfaces[pair->interface].shape], time, x,
                                  enough);
}

static bool is_engaged(const ContactOnset *onset, const ContactLayout *layout, const ContactPair *pair,
                       double time, const double *positions, double touch) {
  if (pair->cells[1] >= 0 &&
      contact_bounds_distance(onset->boxes[pair->cells[0]], onset->boxes[pair->cells[1]]) > touch)
    return false;
  return !(separation_of(layout, pair, time, positions, touch) > touch);
}

static bool are_same(const ContactPair *a, const ContactPair *b) {
  return a->interface == b->interface && a->cells[0] == b->cells[0] && a->cells[1] == b->cells[1];
}

// The candidates that are among the known pairs, and only those, are engaged.
static void mark_known(ContactOnset *onset, const ContactCandidateList *candidates, const ContactPair *known,
                       int known_count) {
  for (int k = 0, next = 0; k < candidates->count; k++) {
    onset->is_engaged[k] = next < known_count && are_same(&candidates->pairs[k], &known[next]);
    next += onset->is_engaged[k];
  }
}

static void find_engaged(ContactOnset *onset, const ContactLayout *layout,
                         const ContactCandidateList *candidates, double time, const double *positions) {
  double touch = 1e-6 * layout->margin;
  contact_candidates_bound(candidates, layout, positions, onset->boxes);
#pragma omp parallel for schedule(static) if (candidates->count > 512)
  for (int k = 0; k < candidates->count; k++)
    if (!onset->is_engaged[k])
      onset->is_engaged[k] = is_engaged(onset, layout, &candidates->pairs[k], time, positions, touch);
}

static void mark(ContactOnset *onset, const ContactLayout *layout, const ContactPair *pair,
                 unsigned char value) {
  for (int side = 0; side < 2 && pair->cells[side] >= 0; side++)
    for (int v = 0; v < 4; v++)
      onset->is_marked[contact_layout_vertices(layout, pair->cells[side])[v]] = value;
}

static bool is_near_patch(const ContactOnset *onset, const ContactLayout *layout, int tet) {
  if (tet < 0) return true;
  const int *v = contact_layout_vertices(layout, tet);
  return onset->is_marked[v[0]] || onset->is_marked[v[1]] || onset->is_marked[v[2]] || onset->is_marked[v[3]];
}

// Rule 2 for the candidates begin … end of one interface.
static void watch_interface(ContactOnset *onset, const ContactLayout *layout, const ContactPair *pairs,
                            int begin, int end) {
  for (int k = begin; k < end; k++)
    if (onset->is_engaged[k]) mark(onset, layout, &pairs[k], 1);
  for (int k = begin; k < end; k++) {
    bool widens =
        is_near_patch(onset, layout, pairs[k].cells[0]) && is_near_patch(onset, layout, pairs[k].cells[1]);
    if (!onset->is_engaged[k] && !widens) onset->watched[onset->count++] = pairs[k];
  }
  for (int k = begin; k < end; k++)
    if (onset->is_engaged[k]) mark(onset, layout, &pairs[k], 0);
}

Status contact_onset_choose(ContactOnset *onset, const ContactLayout *layout,
                            const ContactCandidateList *candidates, const ContactPair *known, int known_count,
                            double time, const double *positions) {
  size_t most = (size_t)candidates->count;
  if (!memory_reserve((void **)&onset->watched, &onset->capacity, most, sizeof(ContactPair)) ||
      !memory_reserve((void **)&onset->is_engaged, &onset->engaged_capacity, most, 1))
    return status_no_memory("watched pairs");
  onset->count = 0;
  mark_known(onset, candidates, known, known_count);
  find_engaged(onset, layout, candidates, time, positions);
  for (int f = 0; f < layout->interface_count; f++)
    watch_interface(onset, layout, candidates->pairs, candidates->begin[f], candidates->begin[f + 1]);
  return STATUS_OK;
}

double contact_onset_gap(const ContactOnset *onset, const ContactLayout *layout, double time,
                         const double *positions) {
  double gap = layout->margin;
#pragma omp parallel for schedule(static) reduction(min : gap) if (onset->count > 512)
  for (int k = 0; k < onset->count; k++)
    gap = fmin(gap, separation_of(layout, &onset->watched[k], time, positions, gap));
  return gap;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/search/broad.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "contact/search/bounds.h"
#include "contact/search/boxes.h"

static void grown_box(const int tet[4], const double *positions, double grow, double box[6]) {
  contact_bounds_of_tet(tet, positions, box);
  for (int c = 0; c < 3; c++) box[c] -= grow, box[c + 3] += grow;
}

static void bounds_of_side(const ContactBroadSide *side, const double *positions, double grow,
                           double bounds[6]) {
  for (int c = 0; c < 3; c++) bounds[c] = INFINITY, bounds[c + 3] = -INFINITY;
  for (int i = 0; i < side->tet_count; i++) {
    double box[6];
    grown_box(side->tets[i], positions, grow, box);
    for (int c = 0; c < 3; c++) {
      bounds[c] = fmin(bounds[c], box[c]);
      bounds[c + 3] = fmax(bounds[c + 3], box[c + 3]);
    }
  }
}

// The tetrahedra of one side whose boxes reach into what the other side occupies.
typedef struct Selection {
  int count;
  int *tets;          // index into the side                    (count)
  double (*boxes)[6]; //                                       (count)
} Selection;

static Status select_within(Selection *selection, const ContactBroadSide *side, const double *positions,
                            double grow, const double bounds[6]) {
  selection->tets = memory_zeroed((size_t)side->tet_count, sizeof *selection->tets);
  selection->boxes = memory_zeroed((size_t)side->tet_count, sizeof *selection->boxes);
  if (!selection->tets || !selection->boxes) return status_no_memory("boxes of the broad phase");
  for (int i = 0; i < side->tet_count; i++) {
    double *box = selection->boxes[selection->count];
    grown_box(side->tets[i], positions, grow, box);
    if (contact_bounds_distance(box, bounds) <= 0) selection->tets[selection->count++] = i;
  }
  return STATUS_OK;
}

static void drop(Selection *selection) {
  memory_free(selection->tets);
  memory_free(selection->boxes);
}

// Pairs in the order of pairs[.][side] < count; those that are equal there keep theirs. `begin` (count + 1).
static void order_by(const int (*from)[2], size_t pair_count, int side, int count, size_t *begin,
                     int (*to)[2]) {
  memset(begin, 0, ((size_t)count + 1) * sizeof *begin);
  for (size_t k = 0; k < pair_count; k++) begin[from[k][side] + 1]++;
  for (int i = 0; i < count; i++) begin[i + 1] += begin[i];
  for (size_t k = 0; k < pair_count; k++) {
    int *pair = to[begin[from[k][side]]++];
    pair[0] = from[k][0], pair[1] = from[k][1];
  }
}

// By the first, then by the second: two passes of a counting sort.
static Status sort_found(ContactBoxPairs *found, int count_a, int count_b) {
  size_t most = (size_t)(count_a > count_b ? count_a : count_b) + 1;
  int(*between)[2] = memory_zeroed(found->count, sizeof *between);
  size_t *begin = memory_zeroed(most, sizeof *begin);
  if (between && begin) {
    order_by((const int(*)[2])found->pairs, found->count, 1, count_b, begin, between);
    order_by((const int(*)[2])between, found->count, 0, count_a, begin, found->pairs);
  }
  Status status = between && begin ? STATUS_OK : status_no_memory("candidate pairs");
  memory_free(between);
  memory_free(begin);
  return status;
}

static Status append_selected(ContactPairList *list, ContactBoxPairs *found, const Selection *in_a,
                              const Selection *in_b, int offset_a, int offset_b) {
  size_t wanted = (size_t)list->count + found->count;
  if (found->count == 0) return STATUS_OK;
  if (wanted > INT_MAX ||
      !memory_reserve((void **)&list->pairs, &list->capacity, wanted, sizeof *list->pairs))
    return status_no_memory("candidate pairs");
  TRY(sort_found(found, in_a->count, in_b->count));
  int(*pairs)[2] = list->pairs + list->count;
  for (size_t k = 0; k < found->count; k++) {
    pairs[k][0] = offset_a + in_a->tets[found->pairs[k][0]];
    pairs[k][1] = offset_b + in_b->tets[found->pairs[k][1]];
  }
  list->count += (int)found->count;
  return STATUS_OK;
}

Status contact_broad_append(ContactPairList *list, const ContactBroadSide *a, const ContactBroadSide *b,
                            const double *positions, double margin) {
  double bounds_a[6], bounds_b[6];
  bounds_of_side(a, positions, margin / 2, bounds_a);
  bounds_of_side(b, positions, margin / 2, bounds_b);
  if (!(contact_bounds_distance(bounds_a, bounds_b) <= 0)) return STATUS_OK;

  Selection in_a = {0}, in_b = {0};
  ContactBoxPairs found = {0};
  Status status = select_within(&in_a, a, positions, margin / 2, bounds_b);
  if (!status) status = select_within(&in_b, b, positions, margin / 2, bounds_a);
  if (!status)
    status = contact_boxes_intersect((const double(*)[6])in_a.boxes, in_a.count,
                                     (const double(*)[6])in_b.boxes, in_b.count, &found);
  if (!status) status = append_selected(list, &found, &in_a, &in_b, a->tet_offset, b->tet_offset);
  contact_boxes_destroy(&found);
  drop(&in_a);
  drop(&in_b);
  return status;
}

void contact_broad_destroy(ContactPairList *list) {
  memory_free(list->pairs);
  *list = (ContactPairList){0};
}

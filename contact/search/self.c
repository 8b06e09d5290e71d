// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/search/self.h"

#include <limits.h>
#include <stdlib.h>

#include "base/memory.h"
#include "contact/search/bounds.h"
#include "contact/surface/surface.h"
#include "overlap/separation.h"

// ---- The surface.

// Marks the vertices of the body's surface.
static Status mark_surface(const ContactSystemDef *def, const ContactBody *body, unsigned char *is_surface) {
  ContactSurface surface;
  TRY(contact_surface_find(&surface, def->tets, body->tet_begin, body->tet_end));
  for (int f = 0; f < surface.count; f++)
    for (int v = 0; v < 3; v++) is_surface[surface.faces[f].vertices[v]] = 1;
  contact_surface_destroy(&surface);
  return STATUS_OK;
}

static void list_outer(ContactSelf *self, const ContactDepth *depth, const unsigned char *is_surface) {
  for (int i = 0; i < depth->cell_count; i++) {
    const int *v = depth->cells[i];
    self->is_outer[i] = is_surface[v[0]] || is_surface[v[1]] || is_surface[v[2]] || is_surface[v[3]];
    if (self->is_outer[i]) self->outer[self->outer_count++] = i;
  }
}

static Status find_outer(ContactSelf *self, const ContactSystemDef *def, const ContactDepth *depth) {
  self->outer = memory_zeroed((size_t)depth->cell_count, sizeof *self->outer);
  self->is_outer = memory_zeroed((size_t)depth->cell_count, 1);
  unsigned char *is_surface = memory_zeroed((size_t)depth->position_count, 1);
  Status status = self->outer && self->is_outer && is_surface
                      ? STATUS_OK
                      : status_no_memory("the surface of a body that meets itself");
  for (int b = 0; b < def->body_count && !status; b++)
    if (def->bodies[b].meets_itself) status = mark_surface(def, &def->bodies[b], is_surface);
  if (!status) list_outer(self, depth, is_surface);
  memory_free(is_surface);
  return status;
}

// ---- Pairs.

static bool shares_vertex(const int a[4], const int b[4]) {
  for (int v = 0; v < 4; v++)
    if (a[v] == b[0] || a[v] == b[1] || a[v] == b[2] || a[v] == b[3]) return true;
  return false;
}

static int compare_pairs(const void *left, const void *right) {
  const int *a = left, *b = right;
  if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
  return (a[1] > b[1]) - (a[1] < b[1]);
}

static bool is_left_out(const ContactSelf *self, const int pair[2]) {
  const ContactPairList *list = &self->left_out;
  return list->count > 0 &&
         bsearch(pair, list->pairs, (size_t)list->count, sizeof *list->pairs, compare_pairs) != NULL;
}

// The boxes of the body's outer tetrahedra, and those of all of them.
typedef struct Boxes {
  const int *outer;
  int outer_count, cell_begin, cell_count;
  double (*of_outer)[6], (*of_all)[6];
} Boxes;

static Status bound(Boxes *boxes, const ContactSelf *self, const ContactDepth *depth, int body,
                    const double *positions, double grow) {
  int begin = depth->cell_begin[body], end = depth->cell_begin[body + 1];
  int first = 0, last = self->outer_count;
  while (first < last && self->outer[first] < begin) first++;
  while (last > first && self->outer[last - 1] >= end) last--;
  *boxes = (Boxes){.outer = self->outer + first,
                   .outer_count = last - first,
                   .cell_begin = begin,
                   .cell_count = end - begin};
  boxes->of_outer = memory_zeroed((size_t)boxes->outer_count, sizeof *boxes->of_outer);
  boxes->of_all = memory_zeroed((size_t)boxes->cell_count, sizeof *boxes->of_all);
  if (!boxes->of_outer || !boxes->of_all) return status_no_memory("boxes of a body that meets itself");
  for (int k = 0; k < boxes->cell_count; k++) {
    double *box = boxes->of_all[k];
    contact_bounds_of_tet(depth->cells[begin + k], positions, box);
    for (int c = 0; c < 3; c++) box[c] -= grow, box[c + 3] += grow;
  }
  for (int k = 0; k < boxes->outer_count; k++)
    for (int c = 0; c < 6; c++) boxes->of_outer[k][c] = boxes->of_all[boxes->outer[k] - begin][c];
  return STATUS_OK;
}

static double separation_of(const ContactDepth *depth, const int pair[2], const double *positions,
                            double enough) {
  double x[24];
  for (int side = 0; side < 2; side++)
    for (int v = 0; v < 4; v++)
      for (int c = 0; c < 3; c++)
        x[12 * side + 3 * v + c] = positions[3 * (size_t)depth->cells[pair[side]][v] + (size_t)c];
  return overlap_separation_pair(x, enough);
}

// Turns pairs of boxes into pairs i < j of tetrahedra; j = −1 where they may not meet or are too far apart.
static void keep_separated(const ContactSelf *self, const ContactSystemDef *def, const ContactDepth *depth,
                           const Boxes *boxes, const double *positions, double margin,
                           ContactBoxPairs *found) {
  long long count = (long long)found->count;
#pragma omp parallel for schedule(static) if (count > 512)
  for (long long k = 0; k < count; k++) {
    int *pair = found->pairs[k], i = boxes->outer[pair[0]], j = boxes->cell_begin + pair[1];
    bool comes_twice = self->is_outer[j] && j < i;
    pair[0] = i < j ? i : j, pair[1] = i < j ? j : i;
    if (comes_twice ||
        shares_vertex(def->tets[contact_depth_tet(depth, i)], def->tets[contact_depth_tet(depth, j)]) ||
        is_left_out(self, pair) || separation_of(depth, pair, positions, margin) > margin)
      pair[1] = -1;
  }
}

static Status append_found(ContactPairList *list, const ContactBoxPairs *found) {
  size_t kept = 0, before = (size_t)list->count;
  for (size_t k = 0; k < found->count; k++) kept += found->pairs[k][1] >= 0;
  if (before + kept > INT_MAX ||
      !memory_reserve((void **)&list->pairs, &list->capacity, before + kept, sizeof *list->pairs))
    return status_no_memory("candidate pairs of a body with itself");
  for (size_t k = 0; k < found->count; k++) {
    if (found->pairs[k][1] < 0) continue;
    int *pair = list->pairs[list->count++];
    pair[0] = found->pairs[k][0], pair[1] = found->pairs[k][1];
  }
  if (kept > 1) qsort(list->pairs + before, kept, sizeof *list->pairs, compare_pairs);
  return STATUS_OK;
}

Status contact_self_append(const ContactSelf *self, const ContactSystemDef *def, const ContactDepth *depth,
                           int body, const double *positions, double margin, ContactPairList *list) {
  Boxes boxes;
  ContactBoxPairs found = {0};
  Status status = bound(&boxes, self, depth, body, positions, margin / 2);
  if (!status)
    status = contact_boxes_intersect((const double(*)[6])boxes.of_outer, boxes.outer_count,
                                     (const double(*)[6])boxes.of_all, boxes.cell_count, &found);
  if (!status) {
    keep_separated(self, def, depth, &boxes, positions, margin, &found);
    status = append_found(list, &found);
  }
  contact_boxes_destroy(&found);
  memory_free(boxes.of_outer);
  memory_free(boxes.of_all);
  return status;
}

// ---- Pairs that overlap at rest.

Status contact_self_create(ContactSelf *self, const ContactSystemDef *def, const ContactDepth *depth,
                           double rest_depth) {
  *self = (ContactSelf){0};
  bool is_wanted = false;
  for (int b = 0; b < def->body_count; b++) is_wanted = is_wanted || def->bodies[b].meets_itself;
  if (!is_wanted) return STATUS_OK;
  TRY(find_outer(self, def, depth));
  ContactPairList touching = {0};
  Status status = STATUS_OK;
  for (int b = 0; b < def->body_count && !status; b++)
    if (def->bodies[b].meets_itself)
      status = contact_self_append(self, def, depth, b, def->rest, 0, &touching);
  int kept = 0;
  for (int k = 0; k < touching.count; k++) {
    int *pair = touching.pairs[k];
    if (separation_of(depth, pair, def->rest, 0) > -rest_depth) continue;
    touching.pairs[kept][0] = pair[0], touching.pairs[kept][1] = pair[1];
    kept++;
  }
  touching.count = kept;
  self->left_out = touching;
  return status;
}

void contact_self_destroy(ContactSelf *self) {
  memory_free(self->outer);
  memory_free(self->is_outer);
  contact_broad_destroy(&self->left_out);
  *self = (ContactSelf){0};
}

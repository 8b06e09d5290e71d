// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/self.h"

#include <limits.h>
#include <stdlib.h>

#include "base/memory.h"
#include "contact/bounds.h"
#include "overlap/separation.h"

// ---- The surface: faces that only one tetrahedron has.

typedef struct Face {
  int vertices[3]; // increasing
} Face;

static void swap_if_greater(int *a, int *b) {
  if (*a <= *b) return;
  int kept = *a;
  *a = *b, *b = kept;
}

static Face face_of(const int tet[4], int opposite) {
  Face face;
  for (int v = 0, n = 0; v < 4; v++)
    if (v != opposite) face.vertices[n++] = tet[v];
  swap_if_greater(&face.vertices[0], &face.vertices[1]);
  swap_if_greater(&face.vertices[1], &face.vertices[2]);
  swap_if_greater(&face.vertices[0], &face.vertices[1]);
  return face;
}

static int compare_faces(const void *left, const void *right) {
  const int *a = ((const Face *)left)->vertices, *b = ((const Face *)right)->vertices;
  for (int k = 0; k < 3; k++)
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  return 0;
}

// Marks the vertices of the body's surface.
static Status mark_surface(const ContactSystemDef *def, const ContactBody *body, unsigned char *is_surface) {
  size_t count = 0;
  Face *faces = memory_zeroed(4 * (size_t)(body->tet_end - body->tet_begin), sizeof *faces);
  if (!faces) return status_no_memory("the surface of a body that meets itself");
  for (int i = body->tet_begin; i < body->tet_end; i++)
    for (int f = 0; f < 4; f++) faces[count++] = face_of(def->tets[i], f);
  qsort(faces, count, sizeof *faces, compare_faces);
  for (size_t f = 0; f < count; f++) {
    bool is_shared = (f > 0 && compare_faces(&faces[f - 1], &faces[f]) == 0) ||
                     (f + 1 < count && compare_faces(&faces[f], &faces[f + 1]) == 0);
    for (int v = 0; !is_shared && v < 3; v++) is_surface[faces[f].vertices[v]] = 1;
  }
  memory_free(faces);
  return STATUS_OK;
}

static void list_outer(ContactSelf *self, const ContactSystemDef *def, const unsigned char *is_surface) {
  for (int i = 0; i < def->tet_count; i++) {
    const int *v = def->tets[i];
    self->is_outer[i] = is_surface[v[0]] || is_surface[v[1]] || is_surface[v[2]] || is_surface[v[3]];
    if (self->is_outer[i]) self->outer[self->outer_count++] = i;
  }
}

static Status find_outer(ContactSelf *self, const ContactSystemDef *def) {
  self->outer = memory_zeroed((size_t)def->tet_count, sizeof *self->outer);
  self->is_outer = memory_zeroed((size_t)def->tet_count, 1);
  unsigned char *is_surface = memory_zeroed((size_t)def->vertex_count, 1);
  Status status = self->outer && self->is_outer && is_surface
                      ? STATUS_OK
                      : status_no_memory("the surface of a body that meets itself");
  for (int b = 0; b < def->body_count && !status; b++)
    if (def->bodies[b].meets_itself) status = mark_surface(def, &def->bodies[b], is_surface);
  if (!status) list_outer(self, def, is_surface);
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
  int outer_count, tet_begin, tet_count;
  double (*of_outer)[6], (*of_all)[6];
} Boxes;

static Status bound(Boxes *boxes, const ContactSelf *self, const ContactSystemDef *def, int body,
                    const double *positions, double grow) {
  const ContactBody *b = &def->bodies[body];
  int first = 0, last = self->outer_count;
  while (first < last && self->outer[first] < b->tet_begin) first++;
  while (last > first && self->outer[last - 1] >= b->tet_end) last--;
  *boxes = (Boxes){.outer = self->outer + first,
                   .outer_count = last - first,
                   .tet_begin = b->tet_begin,
                   .tet_count = b->tet_end - b->tet_begin};
  boxes->of_outer = memory_zeroed((size_t)boxes->outer_count, sizeof *boxes->of_outer);
  boxes->of_all = memory_zeroed((size_t)boxes->tet_count, sizeof *boxes->of_all);
  if (!boxes->of_outer || !boxes->of_all) return status_no_memory("boxes of a body that meets itself");
  for (int k = 0; k < boxes->tet_count; k++) {
    double *box = boxes->of_all[k];
    contact_bounds_of_tet(def->tets[b->tet_begin + k], positions, box);
    for (int c = 0; c < 3; c++) box[c] -= grow, box[c + 3] += grow;
  }
  for (int k = 0; k < boxes->outer_count; k++)
    for (int c = 0; c < 6; c++) boxes->of_outer[k][c] = boxes->of_all[boxes->outer[k] - b->tet_begin][c];
  return STATUS_OK;
}

static double separation_of(const ContactSystemDef *def, const int pair[2], const double *positions,
                            double enough) {
  double x[24];
  for (int side = 0; side < 2; side++)
    for (int v = 0; v < 4; v++)
      for (int c = 0; c < 3; c++)
        x[12 * side + 3 * v + c] = positions[3 * (size_t)def->tets[pair[side]][v] + (size_t)c];
  return overlap_separation_pair(x, enough);
}

// Turns pairs of boxes into pairs i < j of tetrahedra; j = −1 where they may not meet or are too far apart.
static void judge(const ContactSelf *self, const ContactSystemDef *def, const Boxes *boxes,
                  const double *positions, double margin, ContactBoxPairs *found) {
  long long count = (long long)found->count;
#pragma omp parallel for schedule(static) if (count > 512)
  for (long long k = 0; k < count; k++) {
    int *pair = found->pairs[k], i = boxes->outer[pair[0]], j = boxes->tet_begin + pair[1];
    bool comes_twice = self->is_outer[j] && j < i;
    pair[0] = i < j ? i : j, pair[1] = i < j ? j : i;
    if (comes_twice || shares_vertex(def->tets[i], def->tets[j]) || is_left_out(self, pair) ||
        separation_of(def, pair, positions, margin) > margin)
      pair[1] = -1;
  }
}

static Status take(ContactPairList *list, const ContactBoxPairs *found) {
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

Status contact_self_append(const ContactSelf *self, const ContactSystemDef *def, int body,
                           const double *positions, double margin, ContactPairList *list) {
  Boxes boxes;
  ContactBoxPairs found = {0};
  Status status = bound(&boxes, self, def, body, positions, margin / 2);
  if (!status)
    status = contact_boxes_intersect((const double(*)[6])boxes.of_outer, boxes.outer_count,
                                     (const double(*)[6])boxes.of_all, boxes.tet_count, &found);
  if (!status) {
    judge(self, def, &boxes, positions, margin, &found);
    status = take(list, &found);
  }
  contact_boxes_destroy(&found);
  memory_free(boxes.of_outer);
  memory_free(boxes.of_all);
  return status;
}

// ---- Pairs that overlap at rest.

Status contact_self_create(ContactSelf *self, const ContactSystemDef *def, double rest_depth) {
  *self = (ContactSelf){0};
  bool is_wanted = false;
  for (int b = 0; b < def->body_count; b++) is_wanted = is_wanted || def->bodies[b].meets_itself;
  if (!is_wanted) return STATUS_OK;
  TRY(find_outer(self, def));
  ContactPairList touching = {0};
  Status status = STATUS_OK;
  for (int b = 0; b < def->body_count && !status; b++)
    if (def->bodies[b].meets_itself) status = contact_self_append(self, def, b, def->rest, 0, &touching);
  int kept = 0;
  for (int k = 0; k < touching.count; k++) {
    int *pair = touching.pairs[k];
    if (separation_of(def, pair, def->rest, 0) > -rest_depth) continue;
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

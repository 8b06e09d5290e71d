// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/search/self.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

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

static void list_outer(ContactSelf *self, const ContactMesh *mesh, const unsigned char *is_surface) {
  for (int i = 0; i < mesh->cell_count; i++) {
    const int *v = mesh->cells[i];
    self->is_outer[i] = is_surface[v[0]] || is_surface[v[1]] || is_surface[v[2]] || is_surface[v[3]];
    int tet = contact_mesh_tet(mesh, i);
    if (self->is_outer[i] && (self->outer_count == 0 || self->outer[self->outer_count - 1] != tet))
      self->outer[self->outer_count++] = tet;
  }
}

static void list_cells(ContactSelf *self, const ContactMesh *mesh, int tet_count) {
  int cell = 0;
  for (int tet = 0; tet <= tet_count; tet++) {
    while (cell < mesh->cell_count && contact_mesh_tet(mesh, cell) < tet) cell++;
    self->cell_begin[tet] = cell;
  }
}

static Status find_outer(ContactSelf *self, const ContactSystemDef *def, const ContactMesh *mesh) {
  self->outer = memory_zeroed((size_t)def->tet_count, sizeof *self->outer);
  self->cell_begin = memory_zeroed((size_t)def->tet_count + 1, sizeof *self->cell_begin);
  self->is_outer = memory_zeroed((size_t)mesh->cell_count, 1);
  unsigned char *is_surface = memory_zeroed((size_t)mesh->position_count, 1);
  Status status = self->outer && self->cell_begin && self->is_outer && is_surface
                      ? STATUS_OK
                      : status_no_memory("the surface of a body that meets itself");
  for (int b = 0; b < def->body_count && !status; b++)
    if (def->bodies[b].meets_itself) status = mark_surface(def, &def->bodies[b], is_surface);
  if (!status) list_outer(self, mesh, is_surface);
  if (!status) list_cells(self, mesh, def->tet_count);
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

// What a search works with. Cells lie in their tetrahedra, so those are searched first.
typedef struct Search {
  const ContactSelf *self;
  const ContactSystemDef *def;
  const ContactMesh *mesh;
  const double *positions;
  double margin;
  const int *outer; // the body's tetrahedra with a vertex on the surface                  (outer_count)
  int outer_count, tet_begin, tet_count;
  unsigned char *is_outer;             // of the body's tetrahedra; owned                (tet_count)
  double (*of_outer)[6], (*of_all)[6]; // boxes, grown by half the margin; owned
  ContactBoxPairs found;               // boxes, then tetrahedra, then cells that are near; owned
} Search;

static Status begin_search(Search *search, int body) {
  const ContactSelf *self = search->self;
  int begin = search->def->bodies[body].tet_begin, end = search->def->bodies[body].tet_end;
  int first = 0, last = self->outer_count;
  while (first < last && self->outer[first] < begin) first++;
  while (last > first && self->outer[last - 1] >= end) last--;
  search->outer = self->outer + first, search->outer_count = last - first;
  search->tet_begin = begin, search->tet_count = end - begin;
  search->is_outer = memory_zeroed((size_t)search->tet_count, 1);
  search->of_outer = memory_zeroed((size_t)search->outer_count, sizeof *search->of_outer);
  search->of_all = memory_zeroed((size_t)search->tet_count, sizeof *search->of_all);
  bool fits = search->is_outer && search->of_outer && search->of_all;
  return fits ? STATUS_OK : status_no_memory("boxes of a body that meets itself");
}

static void end_search(Search *search) {
  contact_boxes_destroy(&search->found);
  memory_free(search->is_outer);
  memory_free(search->of_outer);
  memory_free(search->of_all);
}

static void bound(Search *search) {
  for (int k = 0; k < search->tet_count; k++) {
    double *box = search->of_all[k];
    contact_bounds_of_tet(search->def->tets[search->tet_begin + k], search->positions, box);
    for (int c = 0; c < 3; c++) box[c] -= search->margin / 2, box[c + 3] += search->margin / 2;
  }
  for (int k = 0; k < search->outer_count; k++) {
    int tet = search->outer[k] - search->tet_begin;
    search->is_outer[tet] = 1;
    for (int c = 0; c < 6; c++) search->of_outer[k][c] = search->of_all[tet][c];
  }
}

static bool are_near(const Search *search, const int a[4], const int b[4]) {
  double x[24];
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++) {
      x[3 * v + c] = search->positions[3 * (size_t)a[v] + (size_t)c];
      x[12 + 3 * v + c] = search->positions[3 * (size_t)b[v] + (size_t)c];
    }
  return !(overlap_separation_pair(x, search->margin) > search->margin);
}

// Drops what is marked by a second index of −1.
static void compact(ContactBoxPairs *found) {
  size_t kept = 0;
  for (size_t k = 0; k < found->count; k++) {
    if (found->pairs[k][1] < 0) continue;
    int i = found->pairs[k][0], j = found->pairs[k][1];
    found->pairs[kept][0] = i, found->pairs[kept][1] = j;
    kept++;
  }
  found->count = kept;
}

// Turns pairs of boxes into pairs i < j of tetrahedra that may meet.
static void keep_tets(Search *search) {
  long long count = (long long)search->found.count;
#pragma omp parallel for schedule(dynamic, 128) if (count > 512)
  for (long long k = 0; k < count; k++) {
    int *pair = search->found.pairs[k], i = search->outer[pair[0]], j = search->tet_begin + pair[1];
    const int *a = search->def->tets[i], *b = search->def->tets[j];
    bool comes_twice = j < i && search->is_outer[pair[1]];
    pair[0] = i < j ? i : j, pair[1] = i < j ? j : i;
    if (comes_twice || shares_vertex(a, b) || !are_near(search, a, b)) pair[1] = -1;
  }
  compact(&search->found);
}

// Turns pairs of tetrahedra into those of their cells, of which one at least is outer.
static Status cut(Search *search) {
  const int *begin = search->self->cell_begin;
  const unsigned char *is_outer = search->self->is_outer;
  ContactBoxPairs cells = {0};
  for (size_t k = 0; k < search->found.count; k++) {
    const int *tets = search->found.pairs[k];
    int counts[2] = {begin[tets[0] + 1] - begin[tets[0]], begin[tets[1] + 1] - begin[tets[1]]};
    size_t most = cells.count + (size_t)counts[0] * (size_t)counts[1];
    if (!memory_reserve((void **)&cells.pairs, &cells.capacity, most, sizeof *cells.pairs)) {
      contact_boxes_destroy(&cells);
      return status_no_memory("candidate pairs of a body with itself");
    }
    for (int i = begin[tets[0]]; i < begin[tets[0]] + counts[0]; i++)
      for (int j = begin[tets[1]]; j < begin[tets[1]] + counts[1]; j++)
        if (is_outer[i] || is_outer[j]) {
          int *pair = cells.pairs[cells.count++];
          pair[0] = i, pair[1] = j;
        }
  }
  contact_boxes_destroy(&search->found);
  search->found = cells;
  return STATUS_OK;
}

static bool is_whole(const ContactMesh *mesh, int cell) {
  return !mesh->replaced || mesh->replaced[cell] < 0;
}

static void keep_cells(Search *search) {
  const ContactMesh *mesh = search->mesh;
  long long count = (long long)search->found.count;
#pragma omp parallel for schedule(dynamic, 128) if (count > 512)
  for (long long k = 0; k < count; k++) {
    int *pair = search->found.pairs[k], i = pair[0], j = pair[1];
    bool is_known = is_whole(mesh, i) && is_whole(mesh, j);
    if (is_left_out(search->self, pair) || (!is_known && !are_near(search, mesh->cells[i], mesh->cells[j])))
      pair[1] = -1;
  }
  compact(&search->found);
}

static Status append_found(ContactPairList *list, const ContactBoxPairs *found) {
  size_t before = (size_t)list->count, count = found->count;
  if (before + count > INT_MAX ||
      !memory_reserve((void **)&list->pairs, &list->capacity, before + count, sizeof *list->pairs))
    return status_no_memory("candidate pairs of a body with itself");
  if (count > 0) memcpy(list->pairs + before, found->pairs, count * sizeof *list->pairs);
  list->count += (int)count;
  if (count > 1) qsort(list->pairs + before, count, sizeof *list->pairs, compare_pairs);
  return STATUS_OK;
}

Status contact_self_append(const ContactSelf *self, const ContactSystemDef *def, const ContactMesh *mesh,
                           int body, const double *positions, double margin, ContactPairList *list) {
  Search search = {.self = self, .def = def, .mesh = mesh, .positions = positions, .margin = margin};
  Status status = begin_search(&search, body);
  if (!status) {
    bound(&search);
    status = contact_boxes_intersect((const double(*)[6])search.of_outer, search.outer_count,
                                     (const double(*)[6])search.of_all, search.tet_count, &search.found);
  }
  if (!status) {
    keep_tets(&search);
    status = cut(&search);
  }
  if (!status) {
    keep_cells(&search);
    status = append_found(list, &search.found);
  }
  end_search(&search);
  return status;
}

// ---- Pairs that overlap at rest.

static double separation_at_rest(const ContactMesh *mesh, const ContactSystemDef *def, const int pair[2]) {
  double x[24];
  for (int side = 0; side < 2; side++)
    for (int v = 0; v < 4; v++)
      for (int c = 0; c < 3; c++)
        x[12 * side + 3 * v + c] = def->rest[3 * (size_t)mesh->cells[pair[side]][v] + (size_t)c];
  return overlap_separation_pair(x, 0);
}

Status contact_self_create(ContactSelf *self, const ContactSystemDef *def, const ContactMesh *mesh,
                           double rest_depth) {
  *self = (ContactSelf){0};
  bool is_wanted = false;
  for (int b = 0; b < def->body_count; b++) is_wanted = is_wanted || def->bodies[b].meets_itself;
  if (!is_wanted) return STATUS_OK;
  TRY(find_outer(self, def, mesh));
  ContactPairList touching = {0};
  Status status = STATUS_OK;
  for (int b = 0; b < def->body_count && !status; b++)
    if (def->bodies[b].meets_itself)
      status = contact_self_append(self, def, mesh, b, def->rest, 0, &touching);
  int kept = 0;
  for (int k = 0; k < touching.count; k++) {
    int *pair = touching.pairs[k];
    if (separation_at_rest(mesh, def, pair) > -rest_depth) continue;
    touching.pairs[kept][0] = pair[0], touching.pairs[kept][1] = pair[1];
    kept++;
  }
  touching.count = kept;
  self->left_out = touching;
  return status;
}

void contact_self_destroy(ContactSelf *self) {
  memory_free(self->outer);
  memory_free(self->cell_begin);
  memory_free(self->is_outer);
  contact_broad_destroy(&self->left_out);
  *self = (ContactSelf){0};
}

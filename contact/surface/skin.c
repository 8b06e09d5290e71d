// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/skin.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "contact/surface/surface.h"

static Vec3 rest_of(const ContactSkin *skin, int vertex) {
  return vec3_at(skin->rest + 3 * (size_t)vertex);
}

static Status no_memory(void) {
  return status_no_memory("the smooth surface of a body");
}

// ---- Faces.

// Twice the area vector.
static Vec3 doubled_of(const ContactSkin *skin, const ContactSkinFace *face) {
  Vec3 a = rest_of(skin, face->vertices[0]);
  return vec3_cross(vec3_sub(rest_of(skin, face->vertices[1]), a),
                    vec3_sub(rest_of(skin, face->vertices[2]), a));
}

static void orient_face(const ContactSkin *skin, const ContactSystemDef *def, ContactSkinFace *face) {
  Vec3 doubled = doubled_of(skin, face);
  Vec3 arm = vec3_sub(rest_of(skin, def->tets[face->tet][face->corner]), rest_of(skin, face->vertices[0]));
  double outward = -vec3_dot(doubled, arm);
  face->area = vec3_length(doubled) / 2;
  face->height = fabs(outward) / vec3_length(doubled);
  if (outward > 0) return;
  int kept = face->vertices[1];
  face->vertices[1] = face->vertices[2], face->vertices[2] = kept;
}

static Status list_faces(ContactSkin *skin, const ContactSystemDef *def, const ContactBody *body) {
  ContactSurface surface;
  Status status = contact_surface_find(&surface, def->tets, body->tet_begin, body->tet_end);
  if (!status) {
    skin->faces = memory_zeroed((size_t)surface.count, sizeof *skin->faces);
    if (!skin->faces) status = no_memory();
  }
  for (int f = 0; f < surface.count && !status; f++) {
    const ContactSurfaceFace *from = &surface.faces[f];
    const int *v = from->vertices;
    if (def->inner && (def->inner[v[0]] & def->inner[v[1]] & def->inner[v[2]])) continue;
    ContactSkinFace *face = &skin->faces[skin->face_count++];
    *face = (ContactSkinFace){.vertices = {v[0], v[1], v[2]}, .tet = from->tet, .corner = from->corner};
    orient_face(skin, def, face);
  }
  contact_surface_destroy(&surface);
  return status;
}

// ---- Edges.

typedef struct Side {
  int vertices[2], face, place; // ascending; which edge of the face
} Side;

static int compare_ends(const int *a, const int *b) {
  if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
  return (a[1] > b[1]) - (a[1] < b[1]);
}

static int compare_sides(const void *left, const void *right) {
  const Side *a = left, *b = right;
  int order = compare_ends(a->vertices, b->vertices);
  return order ? order : (a->face > b->face) - (a->face < b->face);
}

static bool turns(const ContactSkin *skin, const int faces[2], double crease) {
  Vec3 a = doubled_of(skin, &skin->faces[faces[0]]), b = doubled_of(skin, &skin->faces[faces[1]]);
  return !(vec3_dot(a, b) > cos(crease) * vec3_length(a) * vec3_length(b));
}

static Status list_edges(ContactSkin *skin, double crease) {
  size_t count = 3 * (size_t)skin->face_count;
  Side *sides = memory_zeroed(count, sizeof *sides);
  skin->edges = memory_zeroed(count, sizeof *skin->edges);
  for (size_t s = 0; sides && s < count; s++) {
    int face = (int)(s / 3), place = (int)(s % 3);
    const int *v = skin->faces[face].vertices;
    int a = v[place], b = v[(place + 1) % 3];
    sides[s] = (Side){.vertices = {a < b ? a : b, a < b ? b : a}, .face = face, .place = place};
  }
  if (!sides || !skin->edges) {
    memory_free(sides);
    return no_memory();
  }
  qsort(sides, count, sizeof *sides, compare_sides);
  for (size_t s = 0, end; s < count; s = end) {
    for (end = s + 1; end < count && compare_ends(sides[end].vertices, sides[s].vertices) == 0;) end++;
    int number = skin->edge_count++;
    ContactSkinEdge *edge = &skin->edges[number];
    *edge = (ContactSkinEdge){.vertices = {sides[s].vertices[0], sides[s].vertices[1]}, .faces = {-1, -1}};
    for (size_t k = s; k < end; k++) {
      skin->faces[sides[k].face].edges[sides[k].place] = number;
      if (k - s < 2) edge->faces[k - s] = sides[k].face;
    }
    edge->is_crease = end - s != 2 || turns(skin, edge->faces, crease);
  }
  memory_free(sides);
  return STATUS_OK;
}

// ---- Round a vertex.

static Status index_vertices(ContactSkin *skin) {
  skin->begin = memory_zeroed((size_t)skin->vertex_count + 2, sizeof(int));
  skin->list = memory_zeroed(3 * (size_t)skin->face_count, sizeof(int));
  skin->creases = memory_zeroed((size_t)skin->vertex_count, sizeof(int));
  if (!skin->begin || !skin->list || !skin->creases) return no_memory();
  int *begin = skin->begin + 2; // moves down by one as the list is filled
  for (int f = 0; f < skin->face_count; f++)
    for (int v = 0; v < 3; v++) begin[skin->faces[f].vertices[v] - skin->vertex_begin]++;
  for (int v = 1; v < skin->vertex_count; v++) begin[v] += begin[v - 1];
  for (int f = 0; f < skin->face_count; f++)
    for (int v = 0; v < 3; v++)
      skin->list[skin->begin[skin->faces[f].vertices[v] - skin->vertex_begin + 1]++] = f;
  for (int e = 0; e < skin->edge_count; e++)
    for (int v = 0; v < 2 && skin->edges[e].is_crease; v++)
      skin->creases[skin->edges[e].vertices[v] - skin->vertex_begin]++;
  return STATUS_OK;
}

Status contact_skin_create(ContactSkin *skin, const ContactSystemDef *def, const ContactBody *body,
                           double crease) {
  *skin = (ContactSkin){.rest = def->rest,
                        .vertex_begin = body->vertex_begin,
                        .vertex_count = body->vertex_end - body->vertex_begin};
  TRY(list_faces(skin, def, body));
  TRY(list_edges(skin, crease));
  return index_vertices(skin);
}

void contact_skin_destroy(ContactSkin *skin) {
  memory_free(skin->faces);
  memory_free(skin->edges);
  memory_free(skin->begin);
  memory_free(skin->list);
  memory_free(skin->creases);
  *skin = (ContactSkin){0};
}

int contact_skin_edge(const ContactSkin *skin, int a, int b) {
  int ends[2] = {a < b ? a : b, a < b ? b : a}, low = 0, high = skin->edge_count;
  while (low < high) {
    int middle = low + (high - low) / 2, order = compare_ends(skin->edges[middle].vertices, ends);
    if (order == 0) return middle;
    if (order < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return -1;
}

static int place_of(const ContactSkinFace *face, int vertex) {
  return face->vertices[0] == vertex ? 0 : face->vertices[1] == vertex ? 1 : 2;
}

int contact_skin_sector(const ContactSkin *skin, int vertex, int face, int most, int *faces) {
  int count = 0;
  faces[count++] = face;
  for (int k = 0; k < count; k++) {
    const ContactSkinFace *from = &skin->faces[faces[k]];
    int place = place_of(from, vertex), around[2] = {from->edges[place], from->edges[(place + 2) % 3]};
    for (int side = 0; side < 2; side++) {
      const ContactSkinEdge *edge = &skin->edges[around[side]];
      if (edge->is_crease) continue;
      int next = edge->faces[edge->faces[0] == faces[k]], known = 0;
      for (int j = 0; j < count; j++) known += faces[j] == next;
      if (!known && count < most) faces[count++] = next;
    }
  }
  return count;
}

Vec3 contact_skin_normal(const ContactSkin *skin, int vertex, int count, const int *faces) {
  Vec3 sum = {0, 0, 0}, x = rest_of(skin, vertex);
  for (int k = 0; k < count; k++) {
    const ContactSkinFace *face = &skin->faces[faces[k]];
    int place = place_of(face, vertex);
    Vec3 a = vec3_sub(rest_of(skin, face->vertices[(place + 1) % 3]), x);
    Vec3 b = vec3_sub(rest_of(skin, face->vertices[(place + 2) % 3]), x);
    sum = vec3_add(sum, vec3_scale(1 / (vec3_dot(a, a) * vec3_dot(b, b)), vec3_cross(a, b)));
  }
  return sum;
}

static Vec3 away_from(const ContactSkin *skin, int vertex, const ContactSkinEdge *edge) {
  int other = edge->vertices[edge->vertices[0] == vertex];
  return vec3_sub(rest_of(skin, other), rest_of(skin, vertex));
}

int contact_skin_next(const ContactSkin *skin, int vertex, int edge, double crease) {
  int local = vertex - skin->vertex_begin;
  if (skin->creases[local] != 2) return -1;
  for (int k = skin->begin[local]; k < skin->begin[local + 1]; k++)
    for (int s = 0; s < 3; s++) {
      int other = skin->faces[skin->list[k]].edges[s];
      const ContactSkinEdge *to = &skin->edges[other];
      if (other == edge || !to->is_crease || (to->vertices[0] != vertex && to->vertices[1] != vertex))
        continue;
      Vec3 a = away_from(skin, vertex, &skin->edges[edge]), b = away_from(skin, vertex, to);
      bool runs_on = vec3_dot(a, b) < -cos(crease) * vec3_length(a) * vec3_length(b);
      return runs_on ? other : -1;
    }
  return -1;
}

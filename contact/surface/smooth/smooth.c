// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/smooth/smooth.h"

#include <math.h>
#include <string.h>

#include "base/tet.h"
#include "contact/limits.h"
#include "contact/surface/smooth/smooth_face.h"

static Vec3 rest_of(const ContactSmooth *smooth, int vertex) {
  return vec3_at(smooth->def->rest + 3 * (size_t)vertex);
}

// What is known of a tetrahedron: its faces in triangles, seen from outside.
typedef struct Tet {
  int corners[4];
  ContactSmoothFace faces[4]; // opposite to each corner
  unsigned outer;             // bit f: face f is on the surface
  unsigned bent;              // ... and no longer flat
  unsigned on_divided;        // bit v: corner v ends a divided edge
} Tet;

static Vec3 normal_of(const ContactSmooth *smooth, const int triangle[3]) {
  Vec3 a = contact_smooth_points_place(smooth, triangle[0]);
  return vec3_cross(vec3_sub(contact_smooth_points_place(smooth, triangle[1]), a),
                    vec3_sub(contact_smooth_points_place(smooth, triangle[2]), a));
}

static bool is_bent(const ContactSmooth *smooth, const ContactSmoothFace *face) {
  Vec3 first = normal_of(smooth, face->corners[0]);
  for (int t = 1; t < face->count; t++) {
    Vec3 other = normal_of(smooth, face->corners[t]);
    if (!(vec3_dot(first, other) > (1 - CONTACT_FLAT) * vec3_length(first) * vec3_length(other))) return true;
  }
  return false;
}

// The face of the skin with these corners; −1: it is within the body.
static int find_face(const ContactSmooth *smooth, const int corners[3]) {
  int e = contact_skin_edge(&smooth->skin, corners[0], corners[1]);
  for (int side = 0; side < 2 && e >= 0; side++) {
    int f = smooth->skin.edges[e].faces[side];
    if (f < 0) continue;
    const int *v = smooth->skin.faces[f].vertices;
    if (v[0] == corners[2] || v[1] == corners[2] || v[2] == corners[2]) return f;
  }
  return -1;
}

// The three points within a face are numbered by its first three corners; here from this one on.
static void cut_tet_face(const ContactSmooth *smooth, Tet *tet, int f, bool is_mirrored) {
  int corners[3];
  for (int k = 0; k < 3; k++) corners[k] = tet->corners[tet_faces[f][is_mirrored ? 2 - k : k]];
  int face = find_face(smooth, corners);
  if (face >= 0) {
    memcpy(corners, smooth->skin.faces[face].vertices, sizeof corners);
    tet->outer |= 1u << f;
  }
  int inner = face >= 0 ? contact_smooth_face_inner(smooth, face) : -1;
  contact_smooth_face_cut(smooth, corners, inner, &tet->faces[f]);
  if (face >= 0 && is_bent(smooth, &tet->faces[f])) tet->bent |= 1u << f;
}

static bool look_at(const ContactSmooth *smooth, int number, Tet *tet) {
  int near = 0;
  memcpy(tet->corners, smooth->def->tets[number], sizeof tet->corners);
  for (int v = 0; v < 4; v++) near += smooth->is_near[tet->corners[v] - smooth->skin.vertex_begin];
  if (near < 2) return false;
  tet->outer = tet->bent = tet->on_divided = 0;
  for (int v = 0; v < 4; v++)
    for (int w = 0; w < v; w++) {
      int e = contact_skin_edge(&smooth->skin, tet->corners[v], tet->corners[w]);
      if (e >= 0 && smooth->is_curved[e]) tet->on_divided |= 1u << v | 1u << w;
    }
  if (!tet->on_divided) return false;
  const int *c = tet->corners;
  bool is_mirrored = vec3_det4(rest_of(smooth, c[0]), rest_of(smooth, c[1]), rest_of(smooth, c[2]),
                               rest_of(smooth, c[3])) < 0;
  for (int f = 0; f < 4; f++) cut_tet_face(smooth, tet, f, is_mirrored);
  return true;
}

// The corner that cells may be made from; −1: they need a point inside.
static int apex_of(const Tet *tet) {
  if (tet->bent) return -1;
  for (int v = 0; v < 4; v++)
    if (!(tet->on_divided >> v & 1) && !(tet->outer & ~(1u << v))) return v;
  return -1;
}

static void add_cell(ContactSmoothCut *cut, const int triangle[3], int apex) {
  int *cell = cut->cells[cut->count++];
  cell[0] = triangle[1], cell[1] = triangle[0], cell[2] = triangle[2], cell[3] = apex;
}

static Vec3 inside_of(const ContactSmooth *smooth, const Tet *tet, const ContactSmoothCut *cut) {
  Vec3 sum = {0, 0, 0};
  for (int v = 0; v < 4; v++)
    sum = vec3_add(sum, vec3_scale(cut->inside[v], rest_of(smooth, tet->corners[v])));
  return sum;
}

// o as deep below each of the faces on the surface, were they flat; its depth is the mean of its heights over
// their triangles, by area.
static void place_inside(const ContactSmooth *smooth, const Tet *tet, ContactSmoothCut *cut) {
  double inverse[4] = {0}, sum = 0, area = 0, volume = 0;
  int count = 0;
  Vec3 x[4];
  for (int v = 0; v < 4; v++) x[v] = rest_of(smooth, tet->corners[v]), cut->inside[v] = 0.25;
  double six = fabs(vec3_det4(x[0], x[1], x[2], x[3]));
  cut->has_inside = true, cut->depth = INFINITY;
  for (int f = 0; f < 4; f++) {
    if (!(tet->outer >> f & 1)) continue;
    inverse[f] =
        vec3_length(normal_of(smooth, (int[]){tet->corners[tet_faces[f][0]], tet->corners[tet_faces[f][1]],
                                              tet->corners[tet_faces[f][2]]})) /
        six;
    sum += inverse[f], count++;
  }
  if (count == 0) return;
  for (int f = 0; f < 4; f++)
    if (tet->outer >> f & 1) cut->inside[f] = count / (4 * sum) * inverse[f];
  Vec3 o = inside_of(smooth, tet, cut);
  for (int f = 0; f < 4; f++)
    for (int t = 0; t < tet->faces[f].count && tet->outer >> f & 1; t++) {
      const int *corners = tet->faces[f].corners[t];
      Vec3 normal = normal_of(smooth, corners);
      area += vec3_length(normal);
      volume += vec3_dot(normal, vec3_sub(contact_smooth_points_place(smooth, corners[0]), o));
    }
  cut->depth = volume / area;
}

static bool make_cut(const ContactSmooth *smooth, int number, Tet *tet, ContactSmoothCut *cut) {
  cut->count = 0, cut->has_inside = false;
  if (!look_at(smooth, number, tet)) return false;
  int apex = apex_of(tet);
  if (apex < 0) place_inside(smooth, tet, cut);
  for (int f = 0; f < 4; f++)
    for (int t = 0; t < tet->faces[f].count && (apex < 0 || f == apex); t++)
      add_cell(cut, tet->faces[f].corners[t], apex < 0 ? CONTACT_SMOOTH_INSIDE : tet->corners[apex]);
  return true;
}

bool contact_smooth_cut(const ContactSmooth *smooth, int tet, ContactSmoothCut *cut) {
  Tet own;
  return make_cut(smooth, tet, &own, cut);
}

static bool is_sound(const ContactSmooth *smooth, const Tet *tet, const ContactSmoothCut *cut) {
  Vec3 x[4];
  for (int v = 0; v < 4; v++) x[v] = rest_of(smooth, tet->corners[v]);
  double least = CONTACT_FLAT * fabs(vec3_det4(x[0], x[1], x[2], x[3]));
  Vec3 o = cut->has_inside ? inside_of(smooth, tet, cut) : x[0];
  for (int c = 0; c < cut->count; c++) {
    const int *cell = cut->cells[c];
    for (int v = 0; v < 4; v++)
      x[v] = cell[v] == CONTACT_SMOOTH_INSIDE ? o : contact_smooth_points_place(smooth, cell[v]);
    if (!(vec3_det4(x[0], x[1], x[2], x[3]) > least)) return false;
  }
  return !cut->has_inside || cut->depth > 0;
}

// Halves the shares of its edges, those below a half to 0. False: there is nothing left to draw back.
static bool draw_back(ContactSmooth *smooth, const Tet *tet) {
  bool has_changed = false;
  for (int v = 0; v < 4; v++)
    for (int w = 0; w < v; w++) {
      int e = contact_skin_edge(&smooth->skin, tet->corners[v], tet->corners[w]);
      if (e < 0 || !smooth->is_curved[e] || smooth->shares[e] == 0) continue;
      contact_smooth_points_draw(smooth, e, smooth->shares[e] > 0.5 ? smooth->shares[e] / 2 : 0);
      has_changed = true;
    }
  return has_changed;
}

static void keep_sound(ContactSmooth *smooth, const ContactBody *body) {
  Tet tet;
  ContactSmoothCut cut;
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (int i = body->tet_begin; i < body->tet_end; i++)
      if (make_cut(smooth, i, &tet, &cut) && !is_sound(smooth, &tet, &cut) && draw_back(smooth, &tet))
        has_changed = true;
    contact_smooth_points_follow(smooth);
  }
}

Status contact_smooth_create(ContactSmooth *smooth, const ContactSystemDef *def, const ContactBody *body,
                             int level, double crease) {
  TRY(contact_smooth_points_create(smooth, def, body, level, crease));
  keep_sound(smooth, body);
  return STATUS_OK;
}

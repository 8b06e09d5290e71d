// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/smooth/smooth_face.h"

enum { MOST_PARTS = 1 << CONTACT_SMOOTH_MOST_LEVEL };

static void add_triangle(ContactSmoothFace *to, int a, int b, int c) {
  int *corners = to->corners[to->count++];
  corners[0] = a, corners[1] = b, corners[2] = c;
}

// The vertices from a to b along an edge, both included; returns how many parts.
static int walk(const ContactSmooth *smooth, int a, int b, int path[MOST_PARTS + 1]) {
  int e = contact_skin_edge(&smooth->skin, a, b);
  bool is_divided = e >= 0 && smooth->is_curved[e];
  int parts = is_divided ? smooth->parts : 1;
  path[0] = a, path[parts] = b;
  for (int k = 1; k < parts; k++) {
    int point = smooth->def->vertex_count + smooth->edge_points[e];
    path[k] = point + (a < b ? k : parts - k) - 1;
  }
  return parts;
}

// Between two paths from one vertex, `parts` each; the diagonals begin on that which ends at the lower
// vertex.
static void add_strip(ContactSmoothFace *to, const int *p, const int *q, int parts) {
  bool from_p = p[parts] < q[parts];
  add_triangle(to, p[0], p[1], q[1]);
  for (int i = 1; i < parts; i++) {
    if (from_p) {
      add_triangle(to, p[i], p[i + 1], q[i + 1]);
      add_triangle(to, p[i], q[i + 1], q[i]);
    } else {
      add_triangle(to, p[i], p[i + 1], q[i]);
      add_triangle(to, p[i + 1], q[i + 1], q[i]);
    }
  }
}

// Three divided edges: a strip at each corner up to the middles, and the triangle of these.
static void add_corners(ContactSmoothFace *to, int paths[3][MOST_PARTS + 1], int parts) {
  int half = parts / 2;
  for (int k = 0; k < 3; k++) {
    int back[MOST_PARTS + 1];
    for (int i = 0; i <= half; i++) back[i] = paths[(k + 2) % 3][parts - i];
    add_strip(to, paths[k], back, half);
  }
  add_triangle(to, paths[0][half], paths[1][half], paths[2][half]);
}

// In sixteen, about the three points within.
static void add_lattice(ContactSmoothFace *to, int paths[3][MOST_PARTS + 1], int inner) {
  int in[3] = {inner, inner + 1, inner + 2}; // nearest to the corners where the paths begin
  for (int k = 0; k < 3; k++) {
    const int *out = paths[k], *before = paths[(k + 2) % 3];
    int next = in[(k + 1) % 3];
    add_triangle(to, out[0], out[1], before[3]);
    add_triangle(to, out[1], in[k], before[3]);
    add_triangle(to, out[1], out[2], in[k]);
    add_triangle(to, out[2], next, in[k]);
    add_triangle(to, out[2], out[3], next);
  }
  add_triangle(to, in[0], in[1], in[2]);
}

void contact_smooth_face_cut(const ContactSmooth *smooth, const int corners[3], int inner,
                             ContactSmoothFace *to) {
  int paths[3][MOST_PARTS + 1], divided = 0, odd = 0;
  bool is_divided[3];
  to->count = 0;
  for (int k = 0; k < 3; k++) {
    is_divided[k] = walk(smooth, corners[k], corners[(k + 1) % 3], paths[k]) > 1;
    divided += is_divided[k];
  }
  if (divided == 0) add_triangle(to, corners[0], corners[1], corners[2]);
  for (int k = 0; k < 3; k++)
    if (is_divided[k] == (divided == 1)) odd = k;
  if (divided == 1)
    for (int i = 0; i < smooth->parts; i++)
      add_triangle(to, paths[odd][i], paths[odd][i + 1], corners[(odd + 2) % 3]);
  if (divided == 2) {
    int back[MOST_PARTS + 1];
    for (int i = 0; i <= smooth->parts; i++) back[i] = paths[(odd + 1) % 3][smooth->parts - i];
    add_strip(to, paths[(odd + 2) % 3], back, smooth->parts);
  }
  if (divided == 3 && inner >= 0) add_lattice(to, paths, inner);
  if (divided == 3 && inner < 0) add_corners(to, paths, smooth->parts);
}

int contact_smooth_face_inner(const ContactSmooth *smooth, int face) {
  return smooth->face_points[face] < 0 ? -1 : smooth->def->vertex_count + smooth->face_points[face];
}

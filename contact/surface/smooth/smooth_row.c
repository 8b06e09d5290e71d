// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/smooth/smooth_row.h"

#include "contact/surface/smooth/fit.h"
#include "contact/surface/smooth/smooth_face.h"

static Vec3 rest_of(const ContactSmooth *smooth, int vertex) {
  return vec3_at(smooth->def->rest + 3 * (size_t)vertex);
}

void contact_smooth_row_add(ContactSmoothRow *row, int vertex, double weight) {
  for (int k = 0; k < row->count; k++)
    if (row->nodes[k] == vertex) {
      row->weights[k] += weight;
      return;
    }
  if (row->count == CONTACT_SMOOTH_ROW_COUNT) {
    row->is_full = true;
    return;
  }
  row->nodes[row->count] = vertex;
  row->weights[row->count++] = weight;
}

// Adds scale times a point's way off its chord.
static void add_way(const ContactSmooth *smooth, int point, double scale, ContactSmoothRow *row) {
  const int *nodes;
  double weights[CONTACT_FIT_MOST_COUNT];
  int count = contact_smooth_points_carry(smooth, point, &nodes, weights);
  for (int k = 0; k < count; k++) {
    double prior = k < smooth->owns[point] ? smooth->priors[point][k] : 0;
    contact_smooth_row_add(row, nodes[k], scale * (weights[k] - prior));
  }
}

static Vec3 chord_of(const ContactSmooth *smooth, int vertex) {
  int point = vertex - smooth->def->vertex_count;
  Vec3 sum = {0, 0, 0};
  if (point < 0) return rest_of(smooth, vertex);
  for (int k = 0; k < smooth->owns[point]; k++)
    sum = vec3_add(
        sum, vec3_scale(smooth->priors[point][k], rest_of(smooth, smooth->nodes[smooth->begin[point] + k])));
  return sum;
}

static double area_of(Vec3 a, Vec3 b, Vec3 c) {
  return vec3_length(vec3_cross(vec3_sub(b, a), vec3_sub(c, a))) / 2;
}

// ∫_f (x − chord) dA of a face, times scale.
static void add_face_way(const ContactSmooth *smooth, int f, double scale, ContactSmoothRow *row) {
  ContactSmoothFace triangles;
  contact_smooth_face_cut(smooth, smooth->skin.faces[f].vertices, contact_smooth_face_inner(smooth, f),
                          &triangles);
  for (int t = 0; t < triangles.count; t++) {
    const int *c = triangles.corners[t];
    double area = area_of(chord_of(smooth, c[0]), chord_of(smooth, c[1]), chord_of(smooth, c[2]));
    for (int v = 0; v < 3; v++)
      if (c[v] >= smooth->def->vertex_count)
        add_way(smooth, c[v] - smooth->def->vertex_count, scale * area / 3, row);
  }
}

static Vec3 place_of_row(const ContactSmooth *smooth, const ContactSmoothRow *row) {
  Vec3 sum = {0, 0, 0};
  for (int k = 0; k < row->count; k++)
    sum = vec3_add(sum, vec3_scale(row->weights[k], rest_of(smooth, row->nodes[k])));
  return sum;
}

// A vector at rest, as a tetrahedron carries it: ∇λ_k · vector of its corners k.
static void add_carried(const ContactSmooth *smooth, int tet, Vec3 vector, ContactSmoothRow *row) {
  const int *v = smooth->def->tets[tet];
  Vec3 x[4];
  for (int k = 0; k < 4; k++) x[k] = rest_of(smooth, v[k]);
  double six = vec3_det4(x[0], x[1], x[2], x[3]), last = 0;
  for (int k = 1; k < 4; k++) {
    Vec3 a = vec3_sub(x[k % 3 + 1], x[0]), b = vec3_sub(x[(k + 1) % 3 + 1], x[0]);
    double share = vec3_dot(vec3_cross(a, b), vector) / six;
    contact_smooth_row_add(row, v[k], share);
    last -= share;
  }
  contact_smooth_row_add(row, v[0], last);
}

void contact_smooth_row_settle(const ContactSmooth *smooth, int vertex, double share, ContactSmoothRow *row) {
  const ContactSkin *skin = &smooth->skin;
  int local = vertex - skin->vertex_begin, begin = skin->begin[local], end = skin->begin[local + 1];
  ContactSmoothRow mean;
  mean.count = 0, mean.is_full = false;
  double area = 0;
  if (!smooth->is_near[local]) return;
  for (int r = begin; r < end; r++) area += skin->faces[skin->list[r]].area;
  for (int r = begin; r < end; r++) add_face_way(smooth, skin->list[r], 1 / area, &mean);
  row->is_full = row->is_full || mean.is_full;
  Vec3 at_rest = place_of_row(smooth, &mean);
  for (int k = 0; k < mean.count; k++) contact_smooth_row_add(row, mean.nodes[k], -share * mean.weights[k]);
  for (int r = begin; r < end; r++) {
    const ContactSkinFace *face = &skin->faces[skin->list[r]];
    add_carried(smooth, face->tet, vec3_scale(share * face->area / area, at_rest), row);
  }
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/search/gap.h"

#include <math.h>

#include "base/vec3.h"
#include "contact/search/bounds.h"
#include "contact/shape/shape.h"

typedef struct Gaps {
  const ContactLayout *layout;
  const ContactStars *stars;
  double time;
  const double *positions;
  double *values;
} Gaps;

// The given vertex that one on the surface is; −1: none.
static int given_of(const Gaps *gaps, int vertex) {
  if (vertex >= gaps->layout->def.vertex_count || gaps->layout->mesh.depths[vertex] > 0) return -1;
  return contact_stars_given(gaps->stars, vertex);
}

static Vec3 place_of(const Gaps *gaps, int vertex) {
  return vec3_at(gaps->positions + 3 * (size_t)vertex);
}

// Where in [0, 1] the segment from a along e is nearest to p, squared distance.
static double squared_to_edge(Vec3 p, Vec3 a, Vec3 e) {
  double length = vec3_dot(e, e);
  double t = length > 0 ? fmin(fmax(vec3_dot(vec3_sub(p, a), e) / length, 0), 1) : 0;
  Vec3 d = vec3_sub(p, vec3_add(a, vec3_scale(t, e)));
  return vec3_dot(d, d);
}

static double squared_to_triangle(Vec3 p, const Vec3 c[3]) {
  Vec3 e[3], normal;
  for (int k = 0; k < 3; k++) e[k] = vec3_sub(c[(k + 1) % 3], c[k]);
  normal = vec3_cross(e[0], e[1]);
  bool is_above = true;
  double least = INFINITY;
  for (int k = 0; k < 3; k++) {
    is_above = is_above && vec3_dot(vec3_cross(e[k], vec3_sub(p, c[k])), normal) >= 0;
    least = fmin(least, squared_to_edge(p, c[k], e[k]));
  }
  double across = vec3_dot(vec3_sub(p, c[0]), normal), size = vec3_dot(normal, normal);
  return is_above && size > 0 ? across * across / size : least;
}

static bool is_inside(Vec3 p, const Vec3 c[4]) {
  double whole = vec3_det4(c[0], c[1], c[2], c[3]);
  for (int v = 0; v < 4; v++) {
    Vec3 corners[4] = {c[0], c[1], c[2], c[3]};
    corners[v] = p;
    if (!(vec3_det4(corners[0], corners[1], corners[2], corners[3]) / whole >= 0)) return false;
  }
  return true;
}

// Of a point from a cell: 0 inside, else from its faces on the surface; INFINITY: it has none.
static double gap_to_cell(const Gaps *gaps, int cell, Vec3 p) {
  Vec3 c[4];
  double least = INFINITY;
  for (int v = 0; v < 4; v++) c[v] = place_of(gaps, gaps->layout->mesh.cells[cell][v]);
  if (is_inside(p, c)) return 0;
  for (int f = 0; f < 4; f++) {
    if (!(gaps->layout->mesh.outer[cell] >> f & 1)) continue;
    const Vec3 face[3] = {c[(f + 1) % 4], c[(f + 2) % 4], c[(f + 3) % 4]};
    least = fmin(least, squared_to_triangle(p, face));
  }
  return sqrt(least);
}

static void find_to_cell(const Gaps *gaps, int cell, int other, double reach) {
  double box[6];
  contact_bounds_of_tet(gaps->layout->mesh.cells[other], gaps->positions, box);
  for (int v = 0; v < 4; v++) {
    int vertex = gaps->layout->mesh.cells[cell][v], given = given_of(gaps, vertex);
    if (given < 0) continue;
    const double *x = gaps->positions + 3 * (size_t)vertex, point[6] = {x[0], x[1], x[2], x[0], x[1], x[2]};
    if (contact_bounds_distance(point, box) > fmin(reach, gaps->values[given])) continue;
    double gap = gap_to_cell(gaps, other, vec3_at(x));
    if (gap <= reach) gaps->values[given] = fmin(gaps->values[given], gap);
  }
}

static void find_to_shape(const Gaps *gaps, int cell, const ContactShape *shape, double reach) {
  const int *vertices = contact_layout_vertices(gaps->layout, cell);
  for (int v = 0; v < 4; v++) {
    int given = given_of(gaps, vertices[v]);
    if (given < 0) continue;
    double gap = fmax(contact_shape_gap(shape, gaps->time, place_of(gaps, vertices[v])), 0);
    if (gap <= reach) gaps->values[given] = fmin(gaps->values[given], gap);
  }
}

void contact_gap_find(ContactCandidates *candidates, const ContactLayout *layout, const ContactStars *stars,
                      double time, const double *positions, double *values) {
  const Gaps gaps = {layout, stars, time, positions, values};
  const ContactCandidateList *list = &candidates->list;
  if (!contact_candidates_cover(candidates, layout, time, positions)) return;
  for (int f = 0; f < layout->interface_count; f++) {
    double reach = contact_candidates_reach(candidates, layout, f);
    int shape = layout->interfaces[f].shape;
    for (int k = list->begin[f]; k < list->begin[f + 1]; k++) {
      const int *cells = list->pairs[k].cells;
      if (shape >= 0) {
        find_to_shape(&gaps, cells[0], &layout->def.shapes[shape], reach);
        continue;
      }
      find_to_cell(&gaps, cells[0], cells[1], reach);
      find_to_cell(&gaps, cells[1], cells[0], reach);
    }
  }
}

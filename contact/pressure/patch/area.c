// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/patch/area.h"

#include <math.h>

#include "base/vec3.h"
#include "contact/limits.h"
#include "contact/pressure/clipped.h"
#include "contact/shape/shape.h"

// ---- Of a shape.

typedef struct Triangle {
  Vec3 x[3];
  double gaps[3]; // of its corners from the shape [m]
} Triangle;

static double area_of(const Triangle *triangle) {
  Vec3 a = vec3_sub(triangle->x[1], triangle->x[0]), b = vec3_sub(triangle->x[2], triangle->x[0]);
  return 0.5 * vec3_length(vec3_cross(a, b));
}

// The share of a triangle in which a linear gap of these values at the corners is negative.
static double share_below(const double gaps[3]) {
  int below = 0, single = 0;
  for (int v = 0; v < 3; v++) below += gaps[v] < 0;
  if (below % 3 == 0) return below / 3;
  for (int v = 0; v < 3; v++)
    if ((gaps[v] < 0) == (below == 1)) single = v;
  double own = gaps[single],
         corner = own / (own - gaps[(single + 1) % 3]) * own / (own - gaps[(single + 2) % 3]);
  return below == 1 ? corner : 1 - corner;
}

// How far the linear gap of a triangle's corners is above a quadratic one on average, over that at the
// middle.
static const double MEAN_BULGE = 0.75; // not chosen: with q along each edge, Σ q/24 over Σ q/18

// Whether the gap at the middle says how much of a triangle lies in the shape, up to `least`. All shapes are
// convex, and so are their gaps along any line. Then corners in the shape have all between them there, and
// none is less than three times that of the middle without twice the largest. What the linear gap of the
// corners is above the true one is concave, so nowhere more than three times that at the middle, its bulge. A
// linear gap of the range r has no more than 2 δ/r of a triangle between 0 and δ.
static bool is_told(const ContactShape *shape, const Triangle *triangle, double area, double least,
                    double *inside) {
  const double *gaps = triangle->gaps;
  Vec3 middle = vec3_scale(1.0 / 3, vec3_add(triangle->x[0], vec3_add(triangle->x[1], triangle->x[2])));
  double most = fmax(gaps[0], fmax(gaps[1], gaps[2])), range = most - fmin(gaps[0], fmin(gaps[1], gaps[2]));
  double gap = contact_shape_gap(shape, 0, middle), bulge = (gaps[0] + gaps[1] + gaps[2]) / 3 - gap;
  double shift = most > 0 ? MEAN_BULGE * bulge : 0;
  *inside = area * share_below((double[3]){gaps[0] - shift, gaps[1] - shift, gaps[2] - shift});
  if (!(most > 0) || bulge <= CONTACT_ROUNDING * sqrt(area)) return true;
  if (2 * (3 - MEAN_BULGE) * bulge * area <= least * range) return true;
  if (!(3 * gap - 2 * most > 0)) return false;
  *inside = 0;
  return true;
}

// `shape` stands. What is smaller than `least` is not quartered.
static double area_in_shape(const ContactShape *shape, const Triangle *triangle, double least) {
  double area = area_of(triangle), inside;
  if (is_told(shape, triangle, area, least, &inside) || !(area > least)) return inside;
  Triangle middle, corner;
  double sum = 0;
  for (int v = 0; v < 3; v++) {
    middle.x[v] = vec3_scale(0.5, vec3_add(triangle->x[(v + 1) % 3], triangle->x[(v + 2) % 3]));
    middle.gaps[v] = contact_shape_gap(shape, 0, middle.x[v]);
  }
  for (int v = 0; v < 3; v++) {
    corner = middle;
    corner.x[v] = triangle->x[v], corner.gaps[v] = triangle->gaps[v];
    sum += area_in_shape(shape, &corner, least);
  }
  return sum + area_in_shape(shape, &middle, least);
}

// How much of a face with this outward normal looks in a direction, which need not be a unit vector.
static double looking(Vec3 normal, Vec3 direction) {
  double length = vec3_length(normal) * vec3_length(direction);
  return length > 0 ? fmax(0, vec3_dot(normal, direction)) / length : 0;
}

// The face of a cell opposite to a vertex.
static double face_in_shape(const ContactShape *shape, const double cell[12], int face, Vec3 direction) {
  Triangle triangle;
  for (int k = 0; k < 3; k++) {
    triangle.x[k] = vec3_at(cell + 3 * ((face + 1 + k) % 4));
    triangle.gaps[k] = contact_shape_gap(shape, 0, triangle.x[k]);
  }
  Vec3 normal = vec3_cross(vec3_sub(triangle.x[1], triangle.x[0]), vec3_sub(triangle.x[2], triangle.x[0]));
  if (vec3_dot(normal, vec3_sub(vec3_at(cell + 3 * face), triangle.x[0])) > 0)
    normal = vec3_scale(-1, normal);
  double share = looking(normal, direction);
  if (!(share > 0)) return 0;
  return share * area_in_shape(shape, &triangle, CONTACT_FLAT * area_of(&triangle));
}

// Of all cells of the tetrahedron that the pair's first one stands for.
static double area_with_shape(const ContactLayout *layout, const ContactEvaluation *evaluation, int k) {
  const ContactPair *pair = &evaluation->pairs[k];
  ContactShape shape =
      contact_shape_stand(&layout->def.shapes[layout->interfaces[pair->interface].shape], evaluation->time);
  Vec3 direction = vec3_at(evaluation->fields[k].slopes[1]);
  int tet = contact_mesh_tet(&layout->mesh, pair->cells[0]);
  double sum = 0, x[12];
  for (int cell = pair->cells[0];
       cell < layout->mesh.cell_count && contact_mesh_tet(&layout->mesh, cell) == tet; cell++) {
    contact_layout_gather(layout, cell, evaluation->positions, x);
    for (int face = 0; face < 4; face++)
      if (layout->mesh.outer[cell] >> face & 1) sum += face_in_shape(&shape, x, face, direction);
  }
  return sum;
}

// ---- Of two bodies.

// Of the surfaces of both sides.
static void add_cells(const ContactLayout *layout, const ContactEvaluation *evaluation, int k,
                      double areas[2]) {
  const ContactPair *pair = &evaluation->pairs[k];
  ContactClipped clipped;
  if (!(layout->mesh.outer[pair->cells[0]] | layout->mesh.outer[pair->cells[1]])) return;
  if (!contact_clipped_make(&clipped, layout, pair, evaluation->coordinates + 24 * (size_t)k)) return;
  for (int i = 0; i < clipped.triangle_count; i++) {
    const ContactTriangle *triangle = &clipped.triangles[i];
    int side = triangle->face / 4, face = triangle->face % 4;
    if (!(layout->mesh.outer[pair->cells[side]] >> face & 1)) continue;
    const OverlapClipFrame *frame = &clipped.polytope.frame[side];
    Vec3 area = vec3_scale(frame->det < 0 ? 0.5 : -0.5, frame->normal[face]);
    areas[side] +=
        triangle->share * vec3_length(area) * looking(area, vec3_at(evaluation->fields[k].slopes[1 - side]));
  }
}

double contact_area_find(const ContactLayout *layout, const ContactEvaluation *evaluation,
                         const ContactPatch *patch) {
  double areas[2] = {0, 0};
  for (int k = patch->pair_begin; k < patch->pair_end; k++) {
    if (!contact_layout_has_field(layout))
      areas[0] += contact_field_area(&evaluation->fields[k]);
    else if (evaluation->pairs[k].cells[1] < 0)
      areas[0] += area_with_shape(layout, evaluation, k);
    else
      add_cells(layout, evaluation, k, areas);
  }
  return fmax(areas[0], areas[1]);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/surface.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/memory.h"
#include "contact/limits.h"
#include "contact/shape/triangle.h"

// ---- The faces.

static void swap_if_greater(int *a, int *b) {
  if (*a <= *b) return;
  int kept = *a;
  *a = *b, *b = kept;
}

static ContactSurfaceFace face_of(const int vertices[4], int tet, int corner) {
  ContactSurfaceFace face = {.tet = tet, .corner = corner};
  for (int v = 0, n = 0; v < 4; v++)
    if (v != corner) face.vertices[n++] = vertices[v];
  swap_if_greater(&face.vertices[0], &face.vertices[1]);
  swap_if_greater(&face.vertices[1], &face.vertices[2]);
  swap_if_greater(&face.vertices[0], &face.vertices[1]);
  return face;
}

static int compare_vertices(const ContactSurfaceFace *a, const ContactSurfaceFace *b) {
  for (int k = 0; k < 3; k++)
    if (a->vertices[k] != b->vertices[k]) return a->vertices[k] < b->vertices[k] ? -1 : 1;
  return 0;
}

static int compare_faces(const void *left, const void *right) {
  const ContactSurfaceFace *a = left, *b = right;
  int order = compare_vertices(a, b);
  return order ? order : (a->tet > b->tet) - (a->tet < b->tet);
}

Status contact_surface_find(ContactSurface *surface, const int (*tets)[4], int begin, int end) {
  *surface = (ContactSurface){0};
  size_t count = 0, kept = 0;
  ContactSurfaceFace *faces = memory_zeroed(4 * (size_t)(end - begin), sizeof *faces);
  if (!faces) return status_no_memory("the surface of a body");
  for (int i = begin; i < end; i++)
    for (int f = 0; f < 4; f++) faces[count++] = face_of(tets[i], i, f);
  qsort(faces, count, sizeof *faces, compare_faces);
  for (size_t f = 0; f < count; f++) {
    size_t last = f;
    while (last + 1 < count && compare_vertices(&faces[last + 1], &faces[f]) == 0) last++;
    if (last == f) faces[kept++] = faces[f];
    f = last;
  }
  surface->faces = faces;
  surface->count = (int)kept;
  return STATUS_OK;
}

void contact_surface_destroy(ContactSurface *surface) {
  memory_free(surface->faces);
  memory_free(surface->boxes);
  memory_free(surface->ranges);
  memory_free(surface->children);
  *surface = (ContactSurface){0};
}

// ---- The tree: faces halved at the middle of the longest side of their box, until few are left.

enum { LEAF_SIZE = 4, STACK_SIZE = 64 };

static void bound(const ContactSurface *surface, int begin, int end, double box[6]) {
  for (int c = 0; c < 3; c++) box[c] = INFINITY, box[c + 3] = -INFINITY;
  for (int f = begin; f < end; f++)
    for (int v = 0; v < 3; v++)
      for (int c = 0; c < 3; c++) {
        double x = surface->rest[3 * (size_t)surface->faces[f].vertices[v] + (size_t)c];
        box[c] = fmin(box[c], x), box[c + 3] = fmax(box[c + 3], x);
      }
}

static int longest_side(const double box[6]) {
  int axis = 0;
  for (int c = 1; c < 3; c++)
    if (box[c + 3] - box[c] > box[axis + 3] - box[axis]) axis = c;
  return axis;
}

static double middle_of(const ContactSurface *surface, const ContactSurfaceFace *face, int axis) {
  double sum = 0;
  for (int v = 0; v < 3; v++) sum += surface->rest[3 * (size_t)face->vertices[v] + (size_t)axis];
  return sum / 3;
}

static void swap_faces(ContactSurface *surface, int i, int j) {
  ContactSurfaceFace kept = surface->faces[i];
  surface->faces[i] = surface->faces[j], surface->faces[j] = kept;
}

// Puts the faces whose middles are lowest along the axis first, and the median at its place (quickselect).
static void halve(ContactSurface *surface, int begin, int end, int middle, int axis) {
  while (end - begin > 1) {
    double pivot = middle_of(surface, &surface->faces[begin + (end - begin) / 2], axis);
    int low = begin, high = end - 1;
    while (low <= high) {
      while (middle_of(surface, &surface->faces[low], axis) < pivot) low++;
      while (middle_of(surface, &surface->faces[high], axis) > pivot) high--;
      if (low <= high) swap_faces(surface, low++, high--);
    }
    if (middle <= high)
      end = high + 1;
    else if (middle >= low)
      begin = low;
    else
      return;
  }
}

static int add_node(ContactSurface *surface, int begin, int end) {
  int node = surface->node_count++;
  bound(surface, begin, end, surface->boxes[node]);
  surface->ranges[node][0] = begin, surface->ranges[node][1] = end;
  surface->children[node][0] = surface->children[node][1] = -1;
  if (end - begin <= LEAF_SIZE) return node;
  int middle = begin + (end - begin) / 2;
  halve(surface, begin, end, middle, longest_side(surface->boxes[node]));
  surface->children[node][0] = add_node(surface, begin, middle);
  surface->children[node][1] = add_node(surface, middle, end);
  return node;
}

Status contact_surface_index(ContactSurface *surface, const double *rest) {
  size_t most = 2 * (size_t)surface->count + 1;
  surface->rest = rest;
  surface->boxes = memory_zeroed(most, sizeof *surface->boxes);
  surface->ranges = memory_zeroed(most, sizeof *surface->ranges);
  surface->children = memory_zeroed(most, sizeof *surface->children);
  if (!surface->boxes || !surface->ranges || !surface->children)
    return status_no_memory("the surface of a body");
  if (surface->count > 0) add_node(surface, 0, surface->count);
  return STATUS_OK;
}

// ---- Distances.

static double square_to_box(const double box[6], Vec3 x) {
  const double at[3] = {x.x, x.y, x.z};
  double square = 0;
  for (int c = 0; c < 3; c++) {
    double outside = fmax(fmax(box[c] - at[c], at[c] - box[c + 3]), 0);
    square += outside * outside;
  }
  return square;
}

static double square_to_face(const ContactSurface *surface, const ContactSurfaceFace *face, Vec3 x) {
  Vec3 corners[3];
  for (int v = 0; v < 3; v++)
    corners[v] = vec3_sub(vec3_at(surface->rest + 3 * (size_t)face->vertices[v]), x);
  return contact_triangle_square(corners);
}

double contact_surface_distance(const ContactSurface *surface, Vec3 x) {
  int stack[STACK_SIZE], count = 0;
  double nearest = INFINITY;
  if (surface->count > 0) stack[count++] = 0;
  while (count > 0) {
    int node = stack[--count];
    if (!(square_to_box(surface->boxes[node], x) < nearest)) continue;
    const int *children = surface->children[node], *range = surface->ranges[node];
    if (children[0] < 0) {
      for (int f = range[0]; f < range[1]; f++)
        nearest = fmin(nearest, square_to_face(surface, &surface->faces[f], x));
      continue;
    }
    bool second_is_nearer =
        square_to_box(surface->boxes[children[1]], x) < square_to_box(surface->boxes[children[0]], x);
    stack[count++] = children[!second_is_nearer];
    stack[count++] = children[second_is_nearer];
  }
  return sqrt(nearest);
}

// ---- Rays.

typedef struct Ray {
  Vec3 x, d;
  double slack; // by which boxes are grown, for rounding [m]
} Ray;

// From where on the ray is in the box; INFINITY: nowhere.
static double enter(const double box[6], const Ray *ray) {
  const double x[3] = {ray->x.x, ray->x.y, ray->x.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z};
  double from = 0, to = INFINITY;
  for (int c = 0; c < 3; c++) {
    double low = (box[c] - ray->slack - x[c]) / d[c], high = (box[c + 3] + ray->slack - x[c]) / d[c];
    from = fmax(from, fmin(low, high)), to = fmin(to, fmax(low, high));
  }
  return from <= to ? from : INFINITY;
}

// Where the ray meets the triangle: t, INFINITY: nowhere (Möller and Trumbore 1997).
static double meet_face(const ContactSurface *surface, const ContactSurfaceFace *face, const Ray *ray) {
  Vec3 x[3];
  for (int v = 0; v < 3; v++) x[v] = vec3_at(surface->rest + 3 * (size_t)face->vertices[v]);
  Vec3 ab = vec3_sub(x[1], x[0]), ac = vec3_sub(x[2], x[0]), p = vec3_cross(ray->d, ac),
       arm = vec3_sub(ray->x, x[0]);
  double det = vec3_dot(ab, p);
  if (det == 0) return INFINITY;
  Vec3 q = vec3_cross(arm, ab);
  double u = vec3_dot(arm, p) / det, v = vec3_dot(ray->d, q) / det, t = vec3_dot(ac, q) / det;
  bool is_within = u >= -CONTACT_ROUNDING && v >= -CONTACT_ROUNDING && u + v <= 1 + CONTACT_ROUNDING;
  return is_within && t > 0 ? t : INFINITY;
}

double contact_surface_meet(const ContactSurface *surface, const ContactSurfaceFace *besides, Vec3 x,
                            Vec3 d) {
  int stack[STACK_SIZE], count = 0;
  double first = INFINITY;
  if (!(surface->count > 0)) return first;
  const double *all = surface->boxes[0];
  int side = longest_side(all);
  Ray ray = {.x = x, .d = d, .slack = CONTACT_ROUNDING * (all[side + 3] - all[side])};
  for (stack[count++] = 0; count > 0;) {
    int node = stack[--count];
    if (!(enter(surface->boxes[node], &ray) < first)) continue;
    const int *children = surface->children[node], *range = surface->ranges[node];
    for (int f = range[0]; f < range[1] && children[0] < 0; f++) {
      const ContactSurfaceFace *face = &surface->faces[f];
      if (face->tet != besides->tet || face->corner != besides->corner)
        first = fmin(first, meet_face(surface, face, &ray));
    }
    for (int k = 0; k < 2 && children[0] >= 0; k++) stack[count++] = children[k];
  }
  return first;
}

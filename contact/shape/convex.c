// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/shape/convex.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "base/tet.h"

// ---- The solids.

static void add_corner(ContactConvex *convex, Vec3 corner) {
  convex->corners[convex->corner_count++] = corner;
  convex->reach = fmax(convex->reach, vec3_length(corner));
}

void contact_convex_make_box(ContactConvex *convex, const double half_size[3]) {
  static const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  *convex = (ContactConvex){.plane_count = 6, .edge_count = 3};
  for (int c = 0; c < 3; c++) {
    convex->normals[2 * c] = axes[c], convex->normals[2 * c + 1] = vec3_scale(-1, axes[c]);
    convex->offsets[2 * c] = convex->offsets[2 * c + 1] = half_size[c];
    convex->edges[c] = axes[c];
  }
  for (int k = 0; k < 4; k++)
    add_corner(convex,
               (Vec3){(k & 1 ? -1 : 1) * half_size[0], (k & 2 ? -1 : 1) * half_size[1], half_size[2]});
}

// Of the prism with the area of the unit circle: n/2 sin(2π/n) r² = π.
static double outer_radius(int faces) {
  double turn = 2 * M_PI / faces;
  return sqrt(turn / sin(turn));
}

void contact_convex_make_prism(ContactConvex *convex, double radius, double half_length, int faces) {
  *convex = (ContactConvex){.plane_count = faces + 2, .edge_count = faces / 2 + 1};
  double outer = radius * outer_radius(faces), turn = 2 * M_PI / faces;
  for (int k = 0; k < faces; k++) {
    double middle = turn * k, corner = turn * (k + 0.5);
    convex->normals[k] = (Vec3){cos(middle), sin(middle), 0};
    convex->offsets[k] = outer * cos(turn / 2);
    if (k < faces / 2) convex->edges[k] = (Vec3){-sin(middle), cos(middle), 0};
    add_corner(convex, (Vec3){outer * cos(corner), outer * sin(corner), half_length});
  }
  for (int side = 0; side < 2; side++) {
    convex->normals[faces + side] = (Vec3){0, 0, side ? -1 : 1};
    convex->offsets[faces + side] = half_length;
  }
  convex->edges[faces / 2] = (Vec3){0, 0, 1};
}

// ---- Polygons and clipping.

// Each plane adds one corner to a convex polygon; rounding, where the polygon is thinner than that, more.
enum { CORNER_COUNT = CONTACT_CONVEX_PLANES + 16 };

typedef struct Corner {
  Vec3 x;
  double beta[4]; // barycentric coordinates in the tetrahedron
} Corner;

typedef struct Polygon {
  int count;
  Corner corners[CORNER_COUNT];
} Polygon;

static Corner between(const Corner *p, const Corner *q, double share) {
  Corner corner = {.x = vec3_add(vec3_scale(1 - share, p->x), vec3_scale(share, q->x))};
  for (int v = 0; v < 4; v++) corner.beta[v] = (1 - share) * p->beta[v] + share * q->beta[v];
  return corner;
}

static void push(Polygon *polygon, Corner corner) {
  if (polygon->count < CORNER_COUNT) polygon->corners[polygon->count++] = corner;
}

// Keeps what lies below plane k (Sutherland and Hodgman 1974).
static void cut(Polygon *polygon, const ContactConvex *convex, int k) {
  Polygon kept;
  kept.count = 0;
  for (int i = 0; i < polygon->count; i++) {
    const Corner *p = &polygon->corners[i], *q = &polygon->corners[(i + 1) % polygon->count];
    double from = vec3_dot(convex->normals[k], p->x) - convex->offsets[k];
    double to = vec3_dot(convex->normals[k], q->x) - convex->offsets[k];
    if (!(from > 0)) push(&kept, *p);
    if (!(from > 0) != !(to > 0)) push(&kept, between(p, q, from / (from - to)));
  }
  polygon->count = kept.count;
  memcpy(polygon->corners, kept.corners, (size_t)kept.count * sizeof(Corner));
}

// The planes with a vertex of the tetrahedron outside.
typedef struct Cutting {
  int count;
  int planes[CONTACT_CONVEX_PLANES];
} Cutting;

// False: a plane has them all outside.
static bool find_cutting(const ContactConvex *convex, const Vec3 x[4], Cutting *cutting) {
  cutting->count = 0;
  for (int k = 0; k < convex->plane_count; k++) {
    double low = INFINITY, high = -INFINITY;
    for (int v = 0; v < 4; v++) {
      double height = vec3_dot(convex->normals[k], x[v]) - convex->offsets[k];
      low = fmin(low, height), high = fmax(high, height);
    }
    if (!(low < 0)) return false;
    if (high > 0) cutting->planes[cutting->count++] = k;
  }
  return true;
}

static Corner corner_of(const Vec3 x[4], int vertex) {
  Corner corner = {.x = x[vertex]};
  corner.beta[vertex] = 1;
  return corner;
}

static void make_face(Polygon *polygon, const ContactConvex *convex, const Cutting *cutting, const Vec3 x[4],
                      const int face[3]) {
  polygon->count = 3;
  for (int i = 0; i < 3; i++) polygon->corners[i] = corner_of(x, face[i]);
  for (int i = 0; i < cutting->count && polygon->count > 0; i++) cut(polygon, convex, cutting->planes[i]);
}

// The tetrahedron's section by a plane, either way round, clipped by the others.
static void make_section(Polygon *polygon, const ContactConvex *convex, const Cutting *cutting, int own,
                         const Vec3 x[4]) {
  int k = cutting->planes[own], below[4], above[4], below_count = 0, above_count = 0;
  double height[4];
  for (int v = 0; v < 4; v++) {
    height[v] = vec3_dot(convex->normals[k], x[v]) - convex->offsets[k];
    if (height[v] > 0)
      above[above_count++] = v;
    else
      below[below_count++] = v;
  }
  polygon->count = 0;
  for (int i = 0; i < below_count; i++)
    for (int j = 0; j < above_count; j++) {
      int p = below[i], q = above[below_count == 2 && i == 1 ? 1 - j : j]; // around a quadrilateral
      Corner from = corner_of(x, p), to = corner_of(x, q);
      push(polygon, between(&from, &to, height[p] / (height[p] - height[q])));
    }
  for (int i = 0; i < cutting->count && polygon->count > 0; i++)
    if (i != own) cut(polygon, convex, cutting->planes[i]);
}

// ---- Sums over polygons.

// Twice the area vector of the triangle of the polygon's first corner and edge i.
static Vec3 doubled_triangle(const Polygon *polygon, int i) {
  const Corner *corners = polygon->corners;
  return vec3_cross(vec3_sub(corners[i].x, corners[0].x), vec3_sub(corners[i + 1].x, corners[0].x));
}

// Three times the volume of the pyramid from o over a polygon on a plane with that normal; `orient`: it may
// be walked either way round.
static double pyramid(const Polygon *polygon, Vec3 normal, Vec3 o, bool orient) {
  double area = 0;
  for (int i = 1; i + 1 < polygon->count; i++) area += 0.5 * vec3_dot(normal, doubled_triangle(polygon, i));
  if (polygon->count < 3) return 0;
  return vec3_dot(normal, vec3_sub(polygon->corners[0].x, o)) * (orient ? fabs(area) : area);
}

// ∫ β_a dA of the three corners of a face.
static void add_moments(const Polygon *polygon, Vec3 normal, double moment[4]) {
  const Corner *corners = polygon->corners;
  for (int i = 1; i + 1 < polygon->count; i++) {
    double third = vec3_dot(normal, doubled_triangle(polygon, i)) / 6;
    for (int v = 0; v < 4; v++)
      moment[v] += third * (corners[0].beta[v] + corners[i].beta[v] + corners[i + 1].beta[v]);
  }
}

// ---- All of it.

typedef struct Face {
  int corners[3]; // counter-clockwise from outside
  Vec3 normal;    // outward, unit length
  double area;    // 0: it has none, and takes no part
} Face;

static Face face_of(const Vec3 x[4], int f, bool is_mirrored) {
  Face face = {.corners = {tet_faces[f][0], tet_faces[f][1 + is_mirrored], tet_faces[f][2 - is_mirrored]}};
  const int *c = face.corners;
  Vec3 doubled = vec3_cross(vec3_sub(x[c[1]], x[c[0]]), vec3_sub(x[c[2]], x[c[0]]));
  double length = vec3_length(doubled);
  face.area = length / 2;
  if (length > 0) face.normal = vec3_scale(1 / length, doubled);
  return face;
}

// What a polygon on a face adds to the gradient.
static void add_gradient(const Polygon *polygon, const Face *face, double gradient[12]) {
  double moment[4] = {0};
  add_moments(polygon, face->normal, moment);
  for (int v = 0; v < 4; v++) vec3_accumulate(gradient + 3 * v, vec3_scale(moment[v], face->normal));
}

void contact_convex_overlap(const ContactConvex *convex, const double tet[12], double *volume,
                            double gradient[12]) {
  Vec3 x[4], o = {0, 0, 0};
  Cutting cutting;
  Polygon polygon;
  bool has_origin = false;
  double tripled = 0;
  *volume = 0;
  if (gradient) memset(gradient, 0, 12 * sizeof *gradient);
  for (int v = 0; v < 4; v++) x[v] = vec3_at(tet + 3 * v);
  if (!find_cutting(convex, x, &cutting)) return;
  bool is_mirrored = vec3_det4(x[0], x[1], x[2], x[3]) < 0;
  for (int f = 0; f < 4; f++) {
    Face face = face_of(x, f, is_mirrored);
    if (!(face.area > 0)) continue;
    make_face(&polygon, convex, &cutting, x, face.corners);
    if (polygon.count < 3) continue;
    if (!has_origin) o = polygon.corners[0].x, has_origin = true;
    tripled += pyramid(&polygon, face.normal, o, false);
    if (gradient) add_gradient(&polygon, &face, gradient);
  }
  for (int i = 0; i < cutting.count; i++) {
    make_section(&polygon, convex, &cutting, i, x);
    if (polygon.count < 3) continue;
    if (!has_origin) o = polygon.corners[0].x, has_origin = true;
    tripled += pyramid(&polygon, convex->normals[cutting.planes[i]], o, true);
  }
  *volume = fmax(tripled / 3, 0);
}

// ---- The depth below the nearest plane.

// The part of a tetrahedron to which plane `own` is the nearest, as another solid: below that plane, and
// below the planes halfway to the others; those only that cut the tetrahedron.
typedef struct Piece {
  ContactConvex planes;
  Cutting cutting;
  double ridges[CONTACT_CONVEX_PLANES]; // |n_j − n_own| of a plane halfway to j; 0: the plane itself
} Piece;

// −1: all of the four are below or on 0, 1: all are above, 0: neither.
static int side_of(const double heights[4]) {
  int above = (heights[0] > 0) + (heights[1] > 0) + (heights[2] > 0) + (heights[3] > 0);
  int below = (heights[0] < 0) + (heights[1] < 0) + (heights[2] < 0) + (heights[3] < 0);
  return below == 0 ? 1 : above == 0 ? -1 : 0;
}

static void push_plane(Piece *piece, Vec3 normal, double offset, double length, bool is_ridge) {
  int k = piece->planes.plane_count++;
  piece->planes.normals[k] = vec3_scale(1 / length, normal);
  piece->planes.offsets[k] = offset / length;
  piece->ridges[k] = is_ridge ? length : 0;
  piece->cutting.planes[piece->cutting.count++] = k;
}

// False: it is empty. `depths`: of the vertices below each plane.
static bool make_piece(Piece *piece, const ContactConvex *convex, int own, double depths[][4]) {
  double heights[4];
  piece->planes.plane_count = piece->cutting.count = 0;
  for (int v = 0; v < 4; v++) heights[v] = -depths[own][v];
  int side = side_of(heights);
  if (side > 0) return false;
  if (side == 0) push_plane(piece, convex->normals[own], convex->offsets[own], 1, false);
  for (int j = 0; j < convex->plane_count; j++) {
    if (j == own) continue;
    for (int v = 0; v < 4; v++) heights[v] = depths[own][v] - depths[j][v];
    side = side_of(heights);
    if (side > 0) return false;
    Vec3 normal = vec3_sub(convex->normals[j], convex->normals[own]);
    if (side == 0)
      push_plane(piece, normal, convex->offsets[j] - convex->offsets[own], vec3_length(normal), true);
  }
  return true;
}

// ∫ β_a over the pyramid from o over a polygon, β_a(o) given.
static void add_pyramid(const Polygon *polygon, Vec3 normal, const Corner *o, bool orient, double *volume,
                        double first[4]) {
  const Corner *corners = polygon->corners;
  double height = vec3_dot(normal, vec3_sub(corners[0].x, o->x)), area = 0;
  for (int i = 1; i + 1 < polygon->count; i++) area += vec3_dot(normal, doubled_triangle(polygon, i));
  double sign = orient && area < 0 ? -1 : 1;
  for (int i = 1; i + 1 < polygon->count; i++) {
    double part = sign * height * vec3_dot(normal, doubled_triangle(polygon, i)) / 6;
    *volume += part;
    for (int a = 0; a < 4; a++)
      first[a] += part / 4 * (o->beta[a] + corners[0].beta[a] + corners[i].beta[a] + corners[i + 1].beta[a]);
  }
}

// H += factor ∫ (u·n)² over a polygon, either way round.
static void add_squares(const Polygon *polygon, Vec3 n, double factor, double hessian[144]) {
  const Corner *corners = polygon->corners;
  const double normal[3] = {n.x, n.y, n.z};
  double second[4][4] = {{0}}, area = 0;
  for (int i = 1; i + 1 < polygon->count; i++) {
    double doubled = vec3_dot(n, doubled_triangle(polygon, i));
    const double *p = corners[0].beta, *q = corners[i].beta, *r = corners[i + 1].beta;
    area += doubled;
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < 4; b++)
        second[a][b] +=
            doubled / 24 *
            (p[a] * p[b] + q[a] * q[b] + r[a] * r[b] + (p[a] + q[a] + r[a]) * (p[b] + q[b] + r[b]));
  }
  if (area < 0) factor = -factor;
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < 4; b++)
      for (int e = 0; e < 9; e++)
        hessian[12 * (3 * a + e / 3) + 3 * b + e % 3] +=
            factor * second[a][b] * normal[e / 3] * normal[e % 3];
}

// V and ∫ β_a of a piece; its part of the Hessian. A ridge is in two pieces: half of it in each.
static double measure_piece(const Piece *piece, const Vec3 x[4], bool is_mirrored, double scale,
                            double first[4], double hessian[144]) {
  Polygon polygon;
  Corner o;
  bool has_origin = false;
  double volume = 0;
  for (int f = 0; f < 4; f++) {
    Face face = face_of(x, f, is_mirrored);
    if (!(face.area > 0)) continue;
    make_face(&polygon, &piece->planes, &piece->cutting, x, face.corners);
    if (polygon.count < 3) continue;
    if (!has_origin) o = polygon.corners[0], has_origin = true;
    add_pyramid(&polygon, face.normal, &o, false, &volume, first);
  }
  for (int i = 0; i < piece->cutting.count; i++) {
    Vec3 normal = piece->planes.normals[i];
    make_section(&polygon, &piece->planes, &piece->cutting, i, x);
    if (polygon.count < 3) continue;
    if (!has_origin) o = polygon.corners[0], has_origin = true;
    add_pyramid(&polygon, normal, &o, true, &volume, first);
    if (hessian)
      add_squares(&polygon, normal, piece->ridges[i] > 0 ? -scale * piece->ridges[i] / 2 : scale, hessian);
  }
  return volume;
}

void contact_convex_press(const ContactConvex *convex, const double tet[12], double rest_volume,
                          double *volume, double *energy, double gradient[12], double hessian[144]) {
  Vec3 x[4];
  Piece piece;
  double depths[CONTACT_CONVEX_PLANES][4];
  *volume = *energy = 0;
  memset(gradient, 0, 12 * sizeof *gradient);
  if (hessian) memset(hessian, 0, 144 * sizeof *hessian);
  for (int v = 0; v < 4; v++) x[v] = vec3_at(tet + 3 * v);
  double det = vec3_det4(x[0], x[1], x[2], x[3]), scale = 6 * rest_volume / fabs(det);
  if (det == 0) return;
  for (int k = 0; k < convex->plane_count; k++) {
    double deepest = -INFINITY;
    for (int v = 0; v < 4; v++) {
      depths[k][v] = convex->offsets[k] - vec3_dot(convex->normals[k], x[v]);
      deepest = fmax(deepest, depths[k][v]);
    }
    if (!(deepest > 0)) return;
  }
  for (int k = 0; k < convex->plane_count; k++) {
    double first[4] = {0};
    if (!make_piece(&piece, convex, k, depths)) continue;
    *volume += measure_piece(&piece, x, det < 0, scale, first, hessian);
    for (int a = 0; a < 4; a++) {
      *energy += scale * first[a] * depths[k][a];
      vec3_accumulate(gradient + 3 * a, vec3_scale(-scale * first[a], convex->normals[k]));
    }
  }
  *volume = fmax(*volume, 0);
  *energy = fmax(*energy, 0);
}

// ---- Separation.

// fmin and fmax of numbers, but for the sign of 0; what is no number does not count as `y`.
static inline double lesser(double x, double y) {
  return y < x ? y : x;
}

static inline double greater(double x, double y) {
  return y > x ? y : x;
}

static double extent(const ContactConvex *convex, Vec3 axis) {
  double largest = 0;
  for (int k = 0; k < convex->corner_count; k++)
    largest = greater(largest, fabs(vec3_dot(convex->corners[k], axis)));
  return largest;
}

// Of the projections on an axis of any length; −INFINITY for one of none.
static double gap_along(const ContactConvex *convex, const Vec3 x[4], Vec3 axis) {
  double length = vec3_length(axis), low = INFINITY, high = -INFINITY;
  if (!(length > 0)) return -INFINITY;
  for (int v = 0; v < 4; v++) {
    double height = vec3_dot(axis, x[v]);
    low = lesser(low, height), high = greater(high, height);
  }
  return (fmax(low, -high) - extent(convex, axis)) / length;
}

double contact_convex_separation(const ContactConvex *convex, const double tet[12], double enough) {
  Vec3 x[4];
  double best = -INFINITY;
  for (int v = 0; v < 4; v++) x[v] = vec3_at(tet + 3 * v);
  for (int k = 0; k < convex->plane_count; k++) {
    double low = INFINITY;
    for (int v = 0; v < 4; v++) low = lesser(low, vec3_dot(convex->normals[k], x[v]) - convex->offsets[k]);
    best = greater(best, low);
  }
  if (best > enough) return best;
  for (int f = 0; f < 4; f++) {
    const int *c = tet_faces[f];
    best =
        fmax(best, gap_along(convex, x, vec3_cross(vec3_sub(x[c[1]], x[c[0]]), vec3_sub(x[c[2]], x[c[0]]))));
  }
  if (best > enough) return best;
  for (int e = 0; e < convex->edge_count; e++)
    for (int v = 0; v < 4; v++)
      for (int w = 0; w < v; w++)
        best = fmax(best, gap_along(convex, x, vec3_cross(convex->edges[e], vec3_sub(x[v], x[w]))));
  return best;
}

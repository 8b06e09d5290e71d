// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/draw/touch.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>

#include "base/vec3.h"

// Weights and coordinates of the first tetrahedron are whole multiples of 1/GRID, contact points of 1/GRID².
static const int64_t GRID = (int64_t)1 << 24;
static const double FINE = 0x1p-48;

// Weights beyond this belong to planes so oblique that their projected points are far from the face.
static const double LARGEST_WEIGHT = 16;

static const double BUFFER = 1e-16; // of the angle between a free vertex and the plane [rad]
enum { FREE_VERTEX_ATTEMPTS = 64 };

typedef struct Point {
  int64_t x[3];
} Point;

// The first tetrahedron, in multiples of 1/GRID.
typedef struct GridTet {
  Point vertex[4];
} GridTet;

static GridTet draw_tet(Random *random) {
  GridTet tet;
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++) tet.vertex[v].x[c] = (int64_t)(random_bits(random) >> 40);
  return tet;
}

static Point difference(Point a, Point b) {
  return (Point){{a.x[0] - b.x[0], a.x[1] - b.x[1], a.x[2] - b.x[2]}};
}

// Exact in double: entries of a and b are below 2^25, those of the product below 2^51.
static Vec3 cross(Point a, Point b) {
  return (Vec3){(double)(a.x[1] * b.x[2] - a.x[2] * b.x[1]), (double)(a.x[2] * b.x[0] - a.x[0] * b.x[2]),
                (double)(a.x[0] * b.x[1] - a.x[1] * b.x[0])};
}

static Vec3 to_vector(Point a) {
  return (Vec3){(double)a.x[0], (double)a.x[1], (double)a.x[2]};
}

static Vec3 normalised(Vec3 a) {
  return vec3_scale(1 / vec3_length(a), a);
}

static void face_vertices(int face, int vertices[3]) {
  for (int v = 0, count = 0; v < 4; v++)
    if (v != face) vertices[count++] = v;
}

// Outward unit normal of the face opposite to vertex `face`; NaN for a face without area.
static Vec3 face_normal(const GridTet *tet, int face) {
  int v[3];
  face_vertices(face, v);
  Point a = tet->vertex[v[0]];
  Vec3 n = cross(difference(tet->vertex[v[1]], a), difference(tet->vertex[v[2]], a));
  bool is_inward = vec3_dot(n, to_vector(difference(tet->vertex[face], a))) > 0;
  return normalised(is_inward ? vec3_scale(-1, n) : n);
}

// Σ k_i a_i over the given vertices, in multiples of 1/GRID².
static Point combine(const GridTet *tet, const int *vertices, const int64_t *weights, int count) {
  Point p = {{0, 0, 0}};
  for (int i = 0; i < count; i++)
    for (int c = 0; c < 3; c++) p.x[c] += weights[i] * tet->vertex[vertices[i]].x[c];
  return p;
}

static bool is_in_cube(Point p) {
  for (int c = 0; c < 3; c++)
    if (p.x[c] < 0 || p.x[c] > GRID * GRID) return false;
  return true;
}

static void store(double *position, Point p) {
  for (int c = 0; c < 3; c++) position[c] = (double)p.x[c] * FINE;
}

static void store_tet(double *tet, const GridTet *grid) {
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++) tet[3 * v + c] = (double)grid->vertex[v].x[c] / (double)GRID;
}

// Uniform among 1 … GRID − 1.
static int64_t draw_weight(Random *random) {
  return 1 + random_below(random, (int)GRID - 1);
}

// One free vertex about `centre`, on the side of n, in the cube.
static bool draw_free_vertex(Random *random, Vec3 centre, Vec3 n, double *position) {
  for (int attempt = 0; attempt < FREE_VERTEX_ATTEMPTS; attempt++) {
    double direction[3];
    random_direction(random, direction);
    double height = vec3_dot(n, vec3_at(direction));
    if (!(fabs(height) > BUFFER)) continue;
    double r = copysign(random_uniform(random), height);
    Vec3 p = vec3_add(centre, vec3_scale(r, vec3_at(direction)));
    if (!(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1 && p.z >= 0 && p.z <= 1)) continue;
    vec3_store(position, p);
    return true;
  }
  return false;
}

// Vertices `first` … 3 of the second tetrahedron, about the mean of those before.
static bool fill_beyond(Random *random, double *second, int first, Vec3 n) {
  Vec3 centre = {0, 0, 0};
  for (int v = 0; v < first; v++) centre = vec3_add(centre, vec3_scale(1.0 / first, vec3_at(second + 3 * v)));
  for (int v = first; v < 4; v++)
    if (!draw_free_vertex(random, centre, n, second + 3 * v)) return false;
  return true;
}

// A point of the open face, uniform.
static bool try_vertex_face(const GridTet *tet, Random *random, double *second) {
  int face = random_below(random, 4), v[3];
  face_vertices(face, v);
  int64_t i = draw_weight(random), j = draw_weight(random);
  if (i + j > GRID) i = GRID - i, j = GRID - j;
  if (i + j == GRID) return false;
  store(second, combine(tet, v, (int64_t[]){i, j, GRID - i - j}, 3));
  return fill_beyond(random, second, 1, face_normal(tet, face));
}

// A uniform point of the cube, projected onto the plane of the face and rounded to a combination of its
// vertices, for which the plane holds it exactly; false: it is not in the cube.
static bool draw_plane_point(const GridTet *tet, const int v[3], Random *random, double *position) {
  Vec3 origin = to_vector(tet->vertex[v[0]]);
  double x[3];
  for (int c = 0; c < 3; c++) x[c] = random_uniform(random);
  Vec3 offset = vec3_sub(vec3_scale((double)GRID, vec3_at(x)), origin);
  Vec3 e = to_vector(difference(tet->vertex[v[1]], tet->vertex[v[0]]));
  Vec3 f = to_vector(difference(tet->vertex[v[2]], tet->vertex[v[0]]));
  Vec3 n = vec3_cross(e, f);
  double square = vec3_dot(n, n);
  double s = vec3_dot(n, vec3_cross(offset, f)) / square, t = vec3_dot(n, vec3_cross(e, offset)) / square;
  if (!(fabs(s) < LARGEST_WEIGHT && fabs(t) < LARGEST_WEIGHT)) return false;
  int64_t i = llround(s * (double)GRID), j = llround(t * (double)GRID);
  Point p = combine(tet, v, (int64_t[]){GRID - i - j, i, j}, 3);
  store(position, p);
  return is_in_cube(p);
}

// `count` vertices in the plane of a face: an edge or a face of the second.
static bool try_in_face(const GridTet *tet, Random *random, double *second, int count) {
  int face = random_below(random, 4), v[3];
  face_vertices(face, v);
  for (int k = 0; k < count; k++)
    if (!draw_plane_point(tet, v, random, second + 3 * k)) return false;
  return fill_beyond(random, second, count, face_normal(tet, face));
}

// Outward at a vertex or an edge: a random positive combination of the normals of the faces that meet there,
// which are those opposite to the vertices that are not on it.
static Vec3 outward_at(const GridTet *tet, Random *random, int v, int w) {
  Vec3 n = {0, 0, 0};
  for (int face = 0; face < 4; face++)
    if (face != v && face != w)
      n = vec3_add(n, vec3_scale(1 - random_uniform(random), face_normal(tet, face)));
  return normalised(n);
}

static bool try_vertex_vertex(const GridTet *tet, Random *random, double *second) {
  int v = random_below(random, 4);
  store(second, combine(tet, &v, &GRID, 1));
  return fill_beyond(random, second, 1, outward_at(tet, random, v, v));
}

static void draw_edge(Random *random, int ends[2]) {
  ends[0] = random_below(random, 4);
  ends[1] = (ends[0] + 1 + random_below(random, 3)) % 4;
}

static bool try_vertex_edge(const GridTet *tet, Random *random, double *second) {
  int ends[2];
  draw_edge(random, ends);
  int64_t k = draw_weight(random);
  store(second, combine(tet, ends, (int64_t[]){k, GRID - k}, 2));
  return fill_beyond(random, second, 1, outward_at(tet, random, ends[0], ends[1]));
}

// p ± k d, d about at right angles to the outward direction; the exact separating plane is that of both
// edges.
static bool try_edge_edge(const GridTet *tet, Random *random, double *second) {
  int ends[2];
  draw_edge(random, ends);
  int64_t k = draw_weight(random);
  Point p = combine(tet, ends, (int64_t[]){k, GRID - k}, 2);
  Vec3 n = outward_at(tet, random, ends[0], ends[1]);
  double direction[3];
  random_direction(random, direction);
  Vec3 d = vec3_at(direction);
  d = normalised(vec3_sub(d, vec3_scale(vec3_dot(d, n), n)));
  if (!isfinite(d.x + d.y + d.z)) return false;
  Point step = {{llround(d.x * (double)GRID), llround(d.y * (double)GRID), llround(d.z * (double)GRID)}};
  for (int side = 0; side < 2; side++) {
    int64_t length = (side ? -1 : 1) * draw_weight(random);
    Point end = p;
    for (int c = 0; c < 3; c++) end.x[c] += length * step.x[c];
    if (!is_in_cube(end)) return false;
    store(second + 3 * side, end);
  }
  Vec3 plane = cross(difference(tet->vertex[ends[1]], tet->vertex[ends[0]]), step);
  return fill_beyond(random, second, 2, normalised(vec3_dot(plane, n) < 0 ? vec3_scale(-1, plane) : plane));
}

bool datagen_touch_try(DatagenKind kind, Random *random, double pair[24]) {
  GridTet tet = draw_tet(random);
  store_tet(pair, &tet);
  double *second = pair + 12;
  switch (kind) {
  case DATAGEN_VERTEX_FACE:
    return try_vertex_face(&tet, random, second);
  case DATAGEN_EDGE_FACE:
    return try_in_face(&tet, random, second, 2);
  case DATAGEN_FACE_FACE:
    return try_in_face(&tet, random, second, 3);
  case DATAGEN_VERTEX_VERTEX:
    return try_vertex_vertex(&tet, random, second);
  case DATAGEN_VERTEX_EDGE:
    return try_vertex_edge(&tet, random, second);
  case DATAGEN_EDGE_EDGE:
    return try_edge_edge(&tet, random, second);
  default:
    assert(!"a touching kind");
    return false;
  }
}

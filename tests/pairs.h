// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of tetrahedra that are hard for overlap models, by class, and the invariants that every answer must
// obey. The checks return by how much an invariant is missed, relative to the pair's own size, so that each
// model can have its own tolerance; a NaN stays a NaN.
//
//   PairCase c = pairs_make(class_index, member);   // always the same pair for the same numbers
//
// "On the grid" below: coordinates are small multiples of 2⁻¹², so that points made of them with dyadic
// weights are exact and touching or coplanar means exactly that.
#ifndef TETLAP_TESTS_PAIRS_H
#define TETLAP_TESTS_PAIRS_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/random.h"
#include "base/vec3.h"

typedef struct PairCase {
  double x[24];   // two tetrahedra, four vertices, three coordinates
  double volume;  // what V must be; NaN: only an oracle knows
  double slack;   // by how much rounding of the coordinates may have changed it [same unit]
  bool is_flat;   // a tetrahedron has no volume at all: V = 0 and the flag FLAT
  bool is_smooth; // V has a derivative here: central differences may be compared
} PairCase;

typedef struct PairClass {
  const char *name;
  void (*make)(Random *random, PairCase *pair);
} PairClass;

// --- measures
// -----------------------------------------------------------------------------------------------

// In long double: of a sliver of volume 1e-12 double would leave four digits.
static inline long double pairs_tet_volume_long(const double tet[12]) {
  long double d[9];
  for (int i = 0; i < 9; i++) d[i] = (long double)tet[3 + i] - tet[i % 3];
  return fabsl(d[0] * (d[4] * d[8] - d[5] * d[7]) + d[1] * (d[5] * d[6] - d[3] * d[8]) +
               d[2] * (d[3] * d[7] - d[4] * d[6])) /
         6;
}

static inline double pairs_tet_volume(const double tet[12]) {
  return (double)pairs_tet_volume_long(tet);
}

static inline double pairs_smaller_volume(const double x[24]) {
  return fmin(pairs_tet_volume(x), pairs_tet_volume(x + 12));
}

// The longest distance between two of the eight vertices: the length that residuals are relative to.
static inline double pairs_extent(const double x[24]) {
  double longest = 0;
  for (int i = 0; i < 8; i++)
    for (int j = 0; j < i; j++)
      longest = fmax(longest, vec3_length(vec3_sub(vec3_at(x + 3 * i), vec3_at(x + 3 * j))));
  return longest;
}

// How far V leaves [0, smaller volume], relative to the smaller volume, but for the rounding of that.
static inline double pairs_bounds_residual(const double x[24], double volume) {
  long double a = pairs_tet_volume_long(x), b = pairs_tet_volume_long(x + 12), smaller = a < b ? a : b;
  long double beyond = fabsl((long double)volume - smaller / 2) - smaller / 2;
  long double rounding = 4 * LDBL_EPSILON * powl(pairs_extent(x), 3);
  if (!isfinite(volume)) return NAN;
  return beyond > rounding ? (double)(beyond / smaller) : 0;
}

// |Σ ∇V| / L²: a translation of both changes nothing.
static inline double pairs_translation_residual(const double x[24], const double gradient[24]) {
  Vec3 sum = {0, 0, 0};
  double length = pairs_extent(x);
  for (int i = 0; i < 8; i++) sum = vec3_add(sum, vec3_at(gradient + 3 * i));
  return vec3_length(sum) / (length * length);
}

// |Σ x × ∇V| / L³: nor does a rotation. Positions are taken from the first vertex.
static inline double pairs_rotation_residual(const double x[24], const double gradient[24]) {
  Vec3 sum = {0, 0, 0};
  for (int i = 0; i < 8; i++)
    sum = vec3_add(sum, vec3_cross(vec3_sub(vec3_at(x + 3 * i), vec3_at(x)), vec3_at(gradient + 3 * i)));
  return vec3_length(sum) / pow(pairs_extent(x), 3);
}

// |Σ x·∇V − 3V| / L³: V is homogeneous of degree three.
static inline double pairs_scaling_residual(const double x[24], double volume, const double gradient[24]) {
  double sum = -3 * volume;
  for (int i = 0; i < 8; i++)
    sum += vec3_dot(vec3_sub(vec3_at(x + 3 * i), vec3_at(x)), vec3_at(gradient + 3 * i));
  return fabs(sum) / pow(pairs_extent(x), 3);
}

// How far from the true V a double-precision model may be: 1e-9 of V above a millionth of the smaller volume,
// else 1e-12 of the smaller volume.
static inline double pairs_allowed(const double x[24], double reference) {
  double smaller = pairs_smaller_volume(x);
  return reference > 1e-6 * smaller ? 1e-9 * reference : 1e-12 * smaller;
}

// |V − reference| over what is allowed: ≤ 1 is right.
static inline double pairs_volume_misfit(const double x[24], double volume, double reference) {
  return volume == reference ? 0 : fabs(volume - reference) / pairs_allowed(x, reference);
}

// --- transformations
// ----------------------------------------------------------------------------------------

static inline void pairs_swap(const double x[24], double swapped[24]) {
  memcpy(swapped, x + 12, 12 * sizeof *x);
  memcpy(swapped + 12, x, 12 * sizeof *x);
}

// The k-th (0 … 23) order of a tetrahedron's vertices; every second one turns it inside out.
static inline void pairs_permute(const double tet[12], int k, double permuted[12]) {
  int left[4] = {0, 1, 2, 3};
  for (int i = 0, radix = 24; i < 4; i++) {
    radix /= 4 - i;
    int pick = k / radix % (4 - i);
    memcpy(permuted + 3 * i, tet + 3 * left[pick], 3 * sizeof *tet);
    for (int j = pick; j < 3 - i; j++) left[j] = left[j + 1];
  }
}

// x ← scale · R x + shift for `count` points.
static inline void pairs_transform(double *x, int count, const double rotation[9], double scale, Vec3 shift) {
  for (int i = 0; i < count; i++) {
    double p[3] = {x[3 * i], x[3 * i + 1], x[3 * i + 2]};
    double s[3] = {shift.x, shift.y, shift.z};
    for (int r = 0; r < 3; r++)
      x[3 * i + r] =
          scale * (rotation[3 * r] * p[0] + rotation[3 * r + 1] * p[1] + rotation[3 * r + 2] * p[2]) + s[r];
  }
}

static inline void pairs_rotate(Random *random, PairCase *pair) {
  double rotation[9];
  random_rotation(random, rotation);
  pairs_transform(pair->x, 8, rotation, 1, (Vec3){0, 0, 0});
}

// Four tetrahedra that fill `tet`, meeting at the inner point of these barycentric weights.
static inline void pairs_subdivide(const double tet[12], const double weights[4], double parts[4][12]) {
  Vec3 inner = {0, 0, 0};
  for (int a = 0; a < 4; a++) inner = vec3_add(inner, vec3_scale(weights[a], vec3_at(tet + 3 * a)));
  for (int part = 0; part < 4; part++) {
    memcpy(parts[part], tet, 12 * sizeof *tet);
    vec3_store(parts[part] + 3 * part, inner);
  }
}

// --- ingredients
// --------------------------------------------------------------------------------------------

// A coordinate on the grid in [low, high].
static inline double pairs_grid(Random *random, double low, double high) {
  return round(random_between(random, low, high) * 256) / 256;
}

static inline Vec3 pairs_grid_point(Random *random, double low, double high) {
  double x = pairs_grid(random, low, high), y = pairs_grid(random, low, high);
  return (Vec3){x, y, pairs_grid(random, low, high)};
}

static inline Vec3 pairs_vertex(const PairCase *pair, int i) {
  return vec3_at(pair->x + 3 * i);
}

static inline void pairs_set(PairCase *pair, int i, Vec3 p) {
  vec3_store(pair->x + 3 * i, p);
}

// Tetrahedron `which` (0, 1): vertices on the grid of the unit cube, six times the volume at least 0.1.
static inline void pairs_fat(Random *random, PairCase *pair, int which) {
  do {
    for (int i = 0; i < 4; i++) pairs_set(pair, 4 * which + i, pairs_grid_point(random, 0, 1));
  } while (!(pairs_tet_volume(pair->x + 12 * which) >= 0.1 / 6));
}

// A tetrahedron with vertices uniform in the unit cube, not flatter than `least`.
static inline void pairs_loose(Random *random, PairCase *pair, int which, double least) {
  do {
    for (int i = 12 * which; i < 12 * which + 12; i++) pair->x[i] = random_uniform(random);
  } while (!(pairs_tet_volume(pair->x + 12 * which) >= least));
}

// Vertices `first` … 7 at random on the grid on the side n·(p − at) > 0, until the second tetrahedron is fat;
// false if the vertices that are given do not allow it.
static inline bool pairs_fill_beyond(Random *random, PairCase *pair, int first, Vec3 n, Vec3 at) {
  for (int attempt = 0; attempt < 50; attempt++) {
    for (int i = first; i < 8; i++) {
      Vec3 p;
      do p = pairs_grid_point(random, -1, 2);
      while (!(vec3_dot(n, vec3_sub(p, at)) > 0.02 * vec3_length(n)));
      pairs_set(pair, i, p);
    }
    if (pairs_tet_volume(pair->x + 12) >= 0.02 / 6) return true;
  }
  return false;
}

// The normal of the face of the first tetrahedron opposite to its vertex 0, pointing away from that vertex.
// Exact on the grid.
static inline Vec3 pairs_face_normal(const PairCase *pair, int opposite) {
  int a = (opposite + 1) % 4, b = (opposite + 2) % 4, c = (opposite + 3) % 4;
  Vec3 origin = pairs_vertex(pair, a);
  Vec3 n = vec3_cross(vec3_sub(pairs_vertex(pair, b), origin), vec3_sub(pairs_vertex(pair, c), origin));
  return vec3_dot(n, vec3_sub(pairs_vertex(pair, opposite), origin)) > 0 ? vec3_scale(-1, n) : n;
}

// A point strictly inside the face opposite to vertex 0 of the first tetrahedron, with dyadic weights.
static inline Vec3 pairs_face_point(Random *random, const PairCase *pair) {
  int i = 1 + random_below(random, 6), j = 1 + random_below(random, 7 - i);
  Vec3 p = vec3_scale(i / 8.0, pairs_vertex(pair, 1));
  p = vec3_add(p, vec3_scale(j / 8.0, pairs_vertex(pair, 2)));
  return vec3_add(p, vec3_scale((8 - i - j) / 8.0, pairs_vertex(pair, 3)));
}

static inline void pairs_expect(PairCase *pair, double volume, double slack) {
  pair->volume = volume;
  pair->slack = slack;
}

// --- classes
// ------------------------------------------------------------------------------------------------

static inline void pairs_make_far(Random *random, PairCase *pair) {
  pairs_loose(random, pair, 0, 1e-3);
  pairs_loose(random, pair, 1, 1e-3);
  for (int i = 4; i < 8; i++) pair->x[3 * i] += 2;
  pairs_expect(pair, 0, 0);
  pair->is_smooth = true;
}

// Boxes overlap, and a plane through the middle of both keeps them apart.
static inline void pairs_make_boxes(Random *random, PairCase *pair) {
  double n[3];
  for (;;) {
    random_direction(random, n);
    for (int i = 0; i < 8; i++) {
      Vec3 p;
      double side;
      do {
        p = (Vec3){random_uniform(random), random_uniform(random), random_uniform(random)};
        side = vec3_dot(vec3_at(n), vec3_sub(p, (Vec3){0.5, 0.5, 0.5}));
      } while (!(i < 4 ? side < -0.01 : side > 0.01));
      pairs_set(pair, i, p);
    }
    bool boxes_overlap = pairs_smaller_volume(pair->x) >= 1e-3;
    for (int c = 0; c < 3; c++) {
      double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
      for (int i = 0; i < 8; i++) {
        low[i / 4] = fmin(low[i / 4], pair->x[3 * i + c]);
        high[i / 4] = fmax(high[i / 4], pair->x[3 * i + c]);
      }
      boxes_overlap = boxes_overlap && low[0] < high[1] && low[1] < high[0];
    }
    if (boxes_overlap) break;
  }
  pairs_expect(pair, 0, 0);
  pair->is_smooth = true;
}

static inline void pairs_make_uniform(Random *random, PairCase *pair) {
  pairs_loose(random, pair, 0, 1e-3);
  pairs_loose(random, pair, 1, 1e-3);
  pair->is_smooth = true;
}

// As they come, however flat.
static inline void pairs_make_wild(Random *random, PairCase *pair) {
  pairs_loose(random, pair, 0, 0);
  pairs_loose(random, pair, 1, 0);
}

// A face pressed by nearly parallel vertices or a single vertex to a depth between 0.1 and 1e-9.
static inline void pairs_make_shallow(Random *random, PairCase *pair) {
  pairs_fat(random, pair, 0);
  int vertices = 1 + random_below(random, 3);
  double depth = pow(10, random_between(random, -9, -1));
  Vec3 n = pairs_face_normal(pair, 0);
  n = vec3_scale(1 / vec3_length(n), n);
  do
    for (int i = 0; i < vertices; i++) pairs_set(pair, 4 + i, pairs_face_point(random, pair));
  while (!pairs_fill_beyond(random, pair, 4 + vertices, n, pairs_vertex(pair, 1)));
  for (int i = 4; i < 8; i++) pairs_set(pair, i, vec3_sub(pairs_vertex(pair, i), vec3_scale(depth, n)));
}

// `vertices` of the second tetrahedron lie exactly in a face of the first, the others beyond it.
static inline void pairs_touch_face(Random *random, PairCase *pair, int vertices) {
  pairs_fat(random, pair, 0);
  do
    for (int i = 0; i < vertices; i++) pairs_set(pair, 4 + i, pairs_face_point(random, pair));
  while (!pairs_fill_beyond(random, pair, 4 + vertices, pairs_face_normal(pair, 0), pairs_vertex(pair, 1)));
  pairs_expect(pair, 0, 0);
}

static inline void pairs_make_vertex_face(Random *random, PairCase *pair) {
  pairs_touch_face(random, pair, 1);
}
static inline void pairs_make_edge_face(Random *random, PairCase *pair) {
  pairs_touch_face(random, pair, 2);
}
static inline void pairs_make_face_face(Random *random, PairCase *pair) {
  pairs_touch_face(random, pair, 3);
}

// The same vertex, and a plane through it that separates the rest: neighbours in a mesh.
static inline void pairs_make_vertex_vertex(Random *random, PairCase *pair) {
  Vec3 apex, n;
  bool is_below;
  do {
    pairs_fat(random, pair, 0);
    apex = pairs_vertex(pair, 0);
    n = (Vec3){0, 0, 0};
    for (int i = 1; i < 4; i++) n = vec3_add(n, vec3_sub(apex, pairs_vertex(pair, i)));
    is_below = true;
    for (int i = 1; i < 4; i++) is_below = is_below && vec3_dot(n, vec3_sub(pairs_vertex(pair, i), apex)) < 0;
    pairs_set(pair, 4, apex);
  } while (!(is_below && pairs_fill_beyond(random, pair, 5, n, apex)));
  pairs_expect(pair, 0, 0);
}

// A vertex in the middle of the edge (0, 1); `on_edge` 2: both ends of it, a shared edge.
static inline void pairs_touch_edge(Random *random, PairCase *pair, int on_edge) {
  Vec3 n, a, b;
  do {
    pairs_fat(random, pair, 0);
    n = vec3_add(pairs_face_normal(pair, 2), pairs_face_normal(pair, 3));
    a = pairs_vertex(pair, 0), b = pairs_vertex(pair, 1);
    pairs_set(pair, 4, on_edge == 2 ? a : vec3_scale(0.5, vec3_add(a, b)));
    if (on_edge == 2) pairs_set(pair, 5, b);
  } while (!pairs_fill_beyond(random, pair, 4 + on_edge, n, a));
  pairs_expect(pair, 0, 0);
}

static inline void pairs_make_vertex_edge(Random *random, PairCase *pair) {
  pairs_touch_edge(random, pair, 1);
}
static inline void pairs_make_shared_edge(Random *random, PairCase *pair) {
  pairs_touch_edge(random, pair, 2);
}

// Two edges cross in the middle of each.
static inline void pairs_make_edge_edge(Random *random, PairCase *pair) {
  Vec3 middle, n;
  bool is_below;
  do {
    pairs_fat(random, pair, 0);
    Vec3 a = pairs_vertex(pair, 0), b = pairs_vertex(pair, 1), d = pairs_grid_point(random, -1, 1);
    middle = vec3_scale(0.5, vec3_add(a, b));
    n = vec3_cross(vec3_sub(b, a), d);
    if (vec3_dot(n, vec3_sub(pairs_vertex(pair, 2), a)) > 0) n = vec3_scale(-1, n);
    is_below = vec3_dot(n, vec3_sub(pairs_vertex(pair, 2), a)) < 0 &&
               vec3_dot(n, vec3_sub(pairs_vertex(pair, 3), a)) < 0 && vec3_length(n) > 0.1;
    pairs_set(pair, 4, vec3_add(middle, d)), pairs_set(pair, 5, vec3_sub(middle, d));
  } while (!(is_below && pairs_fill_beyond(random, pair, 6, n, middle)));
  pairs_expect(pair, 0, 0);
}

static inline void pairs_make_shared_face(Random *random, PairCase *pair) {
  do {
    pairs_fat(random, pair, 0);
    for (int i = 1; i < 4; i++) pairs_set(pair, 3 + i, pairs_vertex(pair, i));
  } while (!pairs_fill_beyond(random, pair, 7, pairs_face_normal(pair, 0), pairs_vertex(pair, 1)));
  pairs_expect(pair, 0, 0);
}

// One, two or three vertices in common, the rest anywhere: as a folded mesh has them.
static inline void pairs_share(Random *random, PairCase *pair, int vertices) {
  do {
    pairs_fat(random, pair, 0);
    pairs_fat(random, pair, 1);
    for (int i = 0; i < vertices; i++) pairs_set(pair, 4 + i, pairs_vertex(pair, i));
  } while (!(pairs_tet_volume(pair->x + 12) >= 0.02 / 6));
}

static inline void pairs_make_shared_vertex_overlap(Random *random, PairCase *pair) {
  pairs_share(random, pair, 1);
}
static inline void pairs_make_shared_edge_overlap(Random *random, PairCase *pair) {
  pairs_share(random, pair, 2);
}
static inline void pairs_make_shared_face_overlap(Random *random, PairCase *pair) {
  pairs_share(random, pair, 3);
}

// Faces (0, 1, 2) of both in the plane z = slope·(x/2 + y/4), exactly; apexes on the same or opposite sides.
static inline void pairs_coplanar(Random *random, PairCase *pair, double slope, double side) {
  do {
    for (int i = 0; i < 8; i++) {
      Vec3 p = pairs_grid_point(random, 0, 1);
      double above = i == 3 ? 0.25 + p.z : i == 7 ? side * (0.25 + p.z) : 0;
      p.z = slope * (p.x / 2 + p.y / 4) + above;
      pairs_set(pair, i, p);
    }
  } while (!(pairs_smaller_volume(pair->x) >= 0.02));
  if (side < 0) pairs_expect(pair, 0, 0);
}

static inline void pairs_make_same_axis(Random *random, PairCase *pair) {
  pairs_coplanar(random, pair, 0, 1);
}
static inline void pairs_make_same_tilted(Random *random, PairCase *pair) {
  pairs_coplanar(random, pair, 1, 1);
}
static inline void pairs_make_same_rotated(Random *random, PairCase *pair) {
  pairs_coplanar(random, pair, 0, 1);
  pairs_rotate(random, pair);
}
static inline void pairs_make_opposite_axis(Random *random, PairCase *pair) {
  pairs_coplanar(random, pair, 0, -1);
}
static inline void pairs_make_opposite_tilted(Random *random, PairCase *pair) {
  pairs_coplanar(random, pair, 1, -1);
}
static inline void pairs_make_opposite_rotated(Random *random, PairCase *pair) {
  pairs_coplanar(random, pair, 0, -1);
  pairs_rotate(random, pair);
  pairs_expect(pair, 0, 1e-15);
}

static inline void pairs_make_identical(Random *random, PairCase *pair) {
  pairs_fat(random, pair, 0);
  pairs_rotate(random, pair);
  pairs_permute(pair->x, random_below(random, 24), pair->x + 12);
  pairs_expect(pair, pairs_tet_volume(pair->x), 1e-15);
}

static inline void pairs_make_few_ulp(Random *random, PairCase *pair) {
  pairs_make_identical(random, pair);
  for (int i = 12; i < 24; i++)
    for (int steps = random_below(random, 7) - 3; steps; steps += steps < 0 ? 1 : -1)
      pair->x[i] = nextafter(pair->x[i], steps < 0 ? -INFINITY : INFINITY);
  pairs_expect(pair, pairs_tet_volume(pair->x), 1e-14);
}

// The second is a smaller tetrahedron at a random place inside the first.
static inline void pairs_make_inside(Random *random, PairCase *pair) {
  pairs_loose(random, pair, 0, 1e-2);
  do {
    for (int i = 4; i < 8; i++) {
      double weight[4], sum = 0;
      for (int a = 0; a < 4; a++) sum += weight[a] = random_between(random, 0.05, 1);
      Vec3 p = {0, 0, 0};
      for (int a = 0; a < 4; a++) p = vec3_add(p, vec3_scale(weight[a] / sum, pairs_vertex(pair, a)));
      pairs_set(pair, i, p);
    }
  } while (!(pairs_tet_volume(pair->x + 12) > 1e-5));
  pairs_expect(pair, pairs_tet_volume(pair->x + 12), 1e-15);
  pair->is_smooth = true;
}

// Each vertex of the second lies in a face, on an edge or at a vertex of the first.
static inline void pairs_make_inside_touching(Random *random, PairCase *pair) {
  pairs_fat(random, pair, 0);
  do {
    for (int i = 0; i < 4; i++) {
      int left = 8;
      Vec3 p = {0, 0, 0};
      for (int a = 0; a < 3; a++) {
        int share = a == 2 ? left : random_below(random, left + 1);
        p = vec3_add(p, vec3_scale(share / 8.0, pairs_vertex(pair, (i + 1 + a) % 4)));
        left -= share;
      }
      pairs_set(pair, 4 + i, p);
    }
  } while (!(pairs_tet_volume(pair->x + 12) > 1e-3));
  pairs_expect(pair, pairs_tet_volume(pair->x + 12), 1e-15);
}

// A tetrahedron of volume 1e-12 through the middle of the unit cube: a cap (a vertex just above a face), a
// kite (two edges that nearly cross) or a needle.
static inline void pairs_sliver(Random *random, PairCase *pair, int which) {
  Vec3 p[4];
  double area = 0;
  int shape = random_below(random, 3);
  do {
    for (int i = 0; i < 3; i++)
      p[i] = (Vec3){random_uniform(random), random_uniform(random), random_uniform(random)};
    if (shape == 2) {
      double d[3];
      random_direction(random, d);
      p[2] = vec3_add(p[1], vec3_scale(1e-6, vec3_at(d)));
    }
    Vec3 n = vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0]));
    area = vec3_length(n) / 2;
    double s = random_between(random, 0.2, 0.8), t = random_between(random, 0.2, 0.8);
    p[3] = shape == 0   ? vec3_scale(1 / 3.0, vec3_add(p[0], vec3_add(p[1], p[2])))
           : shape == 1 ? vec3_add(p[0], vec3_add(vec3_scale(s, vec3_sub(p[1], p[0])),
                                                  vec3_scale(-t, vec3_sub(p[2], p[0]))))
                        : vec3_add(p[0], vec3_scale(s, vec3_sub(p[1], p[0])));
    p[3] = vec3_add(p[3], vec3_scale(3e-12 / area / (2 * area), n));
  } while (!(area > (shape == 2 ? 2e-7 : 0.1)));
  for (int i = 0; i < 4; i++) pairs_set(pair, 4 * which + i, p[i]);
}

static inline void pairs_make_sliver_fat(Random *random, PairCase *pair) {
  pairs_sliver(random, pair, 0);
  pairs_loose(random, pair, 1, 1e-2);
}
static inline void pairs_make_sliver_sliver(Random *random, PairCase *pair) {
  pairs_sliver(random, pair, 0);
  pairs_sliver(random, pair, 1);
}

static inline void pairs_make_offset(Random *random, PairCase *pair) {
  const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  pairs_make_uniform(random, pair);
  pairs_transform(pair->x, 8, identity, 1, (Vec3){1e6, -1e6, 1e6});
}

static inline void pairs_scaled(Random *random, PairCase *pair, double scale) {
  pairs_make_uniform(random, pair);
  for (int i = 0; i < 24; i++) pair->x[i] *= scale;
}
static inline void pairs_make_tiny(Random *random, PairCase *pair) {
  pairs_scaled(random, pair, 1e-9);
}
static inline void pairs_make_huge(Random *random, PairCase *pair) {
  pairs_scaled(random, pair, 1e9);
}

// Turned inside out: the first, the second or both have the negative orientation.
static inline void pairs_make_inverted(Random *random, PairCase *pair) {
  int which = 1 + random_below(random, 3);
  pairs_make_uniform(random, pair);
  for (int t = 0; t < 2; t++) {
    Vec3 a = pairs_vertex(pair, 4 * t), b = pairs_vertex(pair, 4 * t + 1);
    double det = vec3_det4(a, b, pairs_vertex(pair, 4 * t + 2), pairs_vertex(pair, 4 * t + 3));
    if ((det < 0) != ((which >> t & 1) != 0)) pairs_set(pair, 4 * t, b), pairs_set(pair, 4 * t + 1, a);
  }
}

// Exactly flat, on the grid: four points of a tilted plane, of a line, two vertices the same, or a point.
static inline void pairs_make_flat(Random *random, PairCase *pair) {
  int which = random_below(random, 2), shape = random_below(random, 4);
  pairs_fat(random, pair, 0);
  pairs_fat(random, pair, 1);
  for (int i = 0; i < 4; i++) {
    Vec3 p = pairs_vertex(pair, 4 * which + i);
    if (shape == 0) p.z = p.x / 2 + p.y / 4;
    if (shape == 1) p.y = p.x / 2, p.z = p.x / 4;
    if (shape == 2 && i == 3) p = pairs_vertex(pair, 4 * which + random_below(random, 3));
    if (shape == 3 && i > 0) p = pairs_vertex(pair, 4 * which);
    pairs_set(pair, 4 * which + i, p);
  }
  pairs_expect(pair, 0, 0);
  pair->is_flat = true;
}

static const PairClass pairs_classes[] = {
    {"far", pairs_make_far},
    {"boxes", pairs_make_boxes},
    {"uniform", pairs_make_uniform},
    {"wild", pairs_make_wild},
    {"shallow", pairs_make_shallow},
    {"vertex on face", pairs_make_vertex_face},
    {"edge on face", pairs_make_edge_face},
    {"face on face", pairs_make_face_face},
    {"vertex on vertex", pairs_make_vertex_vertex},
    {"vertex on edge", pairs_make_vertex_edge},
    {"edge on edge", pairs_make_edge_edge},
    {"shared edge", pairs_make_shared_edge},
    {"shared face", pairs_make_shared_face},
    {"shared vertex, overlapping", pairs_make_shared_vertex_overlap},
    {"shared edge, overlapping", pairs_make_shared_edge_overlap},
    {"shared face, overlapping", pairs_make_shared_face_overlap},
    {"coplanar, same side, axis", pairs_make_same_axis},
    {"coplanar, same side, tilted", pairs_make_same_tilted},
    {"coplanar, same side, rotated", pairs_make_same_rotated},
    {"coplanar, opposite, axis", pairs_make_opposite_axis},
    {"coplanar, opposite, tilted", pairs_make_opposite_tilted},
    {"coplanar, opposite, rotated", pairs_make_opposite_rotated},
    {"identical", pairs_make_identical},
    {"identical but a few ulp", pairs_make_few_ulp},
    {"inside", pairs_make_inside},
    {"inside, touching", pairs_make_inside_touching},
    {"sliver and fat", pairs_make_sliver_fat},
    {"sliver and sliver", pairs_make_sliver_sliver},
    {"offset 1e6", pairs_make_offset},
    {"scale 1e-9", pairs_make_tiny},
    {"scale 1e9", pairs_make_huge},
    {"inverted", pairs_make_inverted},
    {"flat", pairs_make_flat},
};

enum { PAIRS_CLASS_COUNT = sizeof pairs_classes / sizeof *pairs_classes };

static inline PairCase pairs_make(int class_index, int member) {
  PairCase pair = {.volume = NAN};
  Random random = random_seeded((uint64_t)(1000 + class_index), (uint64_t)member);
  pairs_classes[class_index].make(&random, &pair);
  return pair;
}

#endif

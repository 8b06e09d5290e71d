// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/hard.h"

#include <math.h>
#include <string.h>

#include "overlap/exact/exact.h"
#include "overlap/pair/invariant.h"

void datagen_hard_permute(const double tet[12], int k, double permuted[12]) {
  int left[4] = {0, 1, 2, 3};
  for (int i = 0, radix = 24; i < 4; i++) {
    radix /= 4 - i;
    int pick = k / radix % (4 - i);
    memcpy(permuted + 3 * i, tet + 3 * left[pick], 3 * sizeof *tet);
    for (int j = pick; j < 3 - i; j++) left[j] = left[j + 1];
  }
}

void datagen_hard_transform(double *x, int count, const double rotation[9], double scale, Vec3 shift) {
  for (int i = 0; i < count; i++) {
    double p[3] = {x[3 * i], x[3 * i + 1], x[3 * i + 2]};
    double s[3] = {shift.x, shift.y, shift.z};
    for (int r = 0; r < 3; r++)
      x[3 * i + r] =
          scale * (rotation[3 * r] * p[0] + rotation[3 * r + 1] * p[1] + rotation[3 * r + 2] * p[2]) + s[r];
  }
}

static void rotate(Random *random, DatagenHardPair *pair) {
  double rotation[9];
  random_rotation(random, rotation);
  datagen_hard_transform(pair->x, 8, rotation, 1, (Vec3){0, 0, 0});
}

void datagen_hard_subdivide(const double tet[12], const double weights[4], double parts[4][12]) {
  Vec3 inner = {0, 0, 0};
  for (int a = 0; a < 4; a++) inner = vec3_add(inner, vec3_scale(weights[a], vec3_at(tet + 3 * a)));
  for (int part = 0; part < 4; part++) {
    memcpy(parts[part], tet, 12 * sizeof *tet);
    vec3_store(parts[part] + 3 * part, inner);
  }
}

void datagen_hard_fill(const DatagenHardClass *class, Random *random, DatagenHardPair *pair) {
  if (class->make)
    class->make(random, pair);
  else
    class->make_of(random, pair, class->number);
}

// A coordinate on the grid in [low, high].
static double grid(Random *random, double low, double high) {
  return round(random_between(random, low, high) * 256) / 256;
}

static Vec3 grid_point(Random *random, double low, double high) {
  double x = grid(random, low, high), y = grid(random, low, high);
  return (Vec3){x, y, grid(random, low, high)};
}

Vec3 datagen_hard_vertex(const DatagenHardPair *pair, int i) {
  return vec3_at(pair->x + 3 * i);
}

void datagen_hard_set(DatagenHardPair *pair, int i, Vec3 p) {
  vec3_store(pair->x + 3 * i, p);
}

void datagen_hard_fat(Random *random, DatagenHardPair *pair, int which) {
  do {
    for (int i = 0; i < 4; i++) datagen_hard_set(pair, 4 * which + i, grid_point(random, 0, 1));
  } while (!(overlap_invariant_tet_volume(pair->x + 12 * which) >= 0.1 / 6));
}

// A tetrahedron with vertices uniform in the unit cube, not flatter than `least`.
static void loose(Random *random, DatagenHardPair *pair, int which, double least) {
  do {
    for (int i = 12 * which; i < 12 * which + 12; i++) pair->x[i] = random_uniform(random);
  } while (!(overlap_invariant_tet_volume(pair->x + 12 * which) >= least));
}

// Vertices `first` … 7 at random on the grid on the side n·(p − at) > 0, until the second tetrahedron is fat;
// false if the vertices that are given do not allow it.
static bool fill_beyond(Random *random, DatagenHardPair *pair, int first, Vec3 n, Vec3 at) {
  for (int attempt = 0; attempt < 50; attempt++) {
    for (int i = first; i < 8; i++) {
      Vec3 p;
      do p = grid_point(random, -1, 2);
      while (!(vec3_dot(n, vec3_sub(p, at)) > 0.02 * vec3_length(n)));
      datagen_hard_set(pair, i, p);
    }
    if (overlap_invariant_tet_volume(pair->x + 12) >= 0.02 / 6) return true;
  }
  return false;
}

Vec3 datagen_hard_face_normal(const DatagenHardPair *pair, int opposite) {
  int a = (opposite + 1) % 4, b = (opposite + 2) % 4, c = (opposite + 3) % 4;
  Vec3 origin = datagen_hard_vertex(pair, a);
  Vec3 n = vec3_cross(vec3_sub(datagen_hard_vertex(pair, b), origin),
                      vec3_sub(datagen_hard_vertex(pair, c), origin));
  return vec3_dot(n, vec3_sub(datagen_hard_vertex(pair, opposite), origin)) > 0 ? vec3_scale(-1, n) : n;
}

// A point strictly inside the face opposite to vertex 0 of the first tetrahedron, with dyadic weights.
static Vec3 face_point(Random *random, const DatagenHardPair *pair) {
  int i = 1 + random_below(random, 6), j = 1 + random_below(random, 7 - i);
  Vec3 p = vec3_scale(i / 8.0, datagen_hard_vertex(pair, 1));
  p = vec3_add(p, vec3_scale(j / 8.0, datagen_hard_vertex(pair, 2)));
  return vec3_add(p, vec3_scale((8 - i - j) / 8.0, datagen_hard_vertex(pair, 3)));
}

static void expect(DatagenHardPair *pair, double volume, double slack) {
  pair->volume = volume;
  pair->slack = slack;
}

static void make_far(Random *random, DatagenHardPair *pair) {
  loose(random, pair, 0, 1e-3);
  loose(random, pair, 1, 1e-3);
  for (int i = 4; i < 8; i++) pair->x[3 * i] += 2;
  expect(pair, 0, 0);
  pair->is_smooth = true;
}

// Boxes overlap, and a plane through the middle of both keeps them apart.
static void make_boxes(Random *random, DatagenHardPair *pair) {
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
      datagen_hard_set(pair, i, p);
    }
    bool boxes_overlap = overlap_invariant_smaller_volume(pair->x) >= 1e-3;
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
  expect(pair, 0, 0);
  pair->is_smooth = true;
}

static void make_uniform(Random *random, DatagenHardPair *pair) {
  loose(random, pair, 0, 1e-3);
  loose(random, pair, 1, 1e-3);
  pair->is_smooth = true;
}

// As they come, however flat.
static void make_wild(Random *random, DatagenHardPair *pair) {
  loose(random, pair, 0, 0);
  loose(random, pair, 1, 0);
}

// A face pressed by nearly parallel vertices or a single vertex to a depth between 0.1 and 1e-9.
static void make_shallow(Random *random, DatagenHardPair *pair) {
  datagen_hard_fat(random, pair, 0);
  int vertices = 1 + random_below(random, 3);
  double depth = pow(10, random_between(random, -9, -1));
  Vec3 n = datagen_hard_face_normal(pair, 0);
  n = vec3_scale(1 / vec3_length(n), n);
  do
    for (int i = 0; i < vertices; i++) datagen_hard_set(pair, 4 + i, face_point(random, pair));
  while (!fill_beyond(random, pair, 4 + vertices, n, datagen_hard_vertex(pair, 1)));
  for (int i = 4; i < 8; i++)
    datagen_hard_set(pair, i, vec3_sub(datagen_hard_vertex(pair, i), vec3_scale(depth, n)));
}

// So many vertices of the second tetrahedron lie exactly in a face of the first, the others beyond it.
static void touch_face(Random *random, DatagenHardPair *pair, double number) {
  const int vertices = (int)number;
  datagen_hard_fat(random, pair, 0);
  do
    for (int i = 0; i < vertices; i++) datagen_hard_set(pair, 4 + i, face_point(random, pair));
  while (!fill_beyond(random, pair, 4 + vertices, datagen_hard_face_normal(pair, 0),
                      datagen_hard_vertex(pair, 1)));
  expect(pair, 0, 0);
}

// The same vertex, and a plane through it that separates the rest: neighbours in a mesh.
static void make_vertex_vertex(Random *random, DatagenHardPair *pair) {
  Vec3 apex, n;
  bool is_below;
  do {
    datagen_hard_fat(random, pair, 0);
    apex = datagen_hard_vertex(pair, 0);
    n = (Vec3){0, 0, 0};
    for (int i = 1; i < 4; i++) n = vec3_add(n, vec3_sub(apex, datagen_hard_vertex(pair, i)));
    is_below = true;
    for (int i = 1; i < 4; i++)
      is_below = is_below && vec3_dot(n, vec3_sub(datagen_hard_vertex(pair, i), apex)) < 0;
    datagen_hard_set(pair, 4, apex);
  } while (!(is_below && fill_beyond(random, pair, 5, n, apex)));
  expect(pair, 0, 0);
}

// 1: a vertex in the middle of the edge (0, 1); 2: both ends of it, a shared edge.
static void touch_edge(Random *random, DatagenHardPair *pair, double number) {
  const int on_edge = (int)number;
  Vec3 n, a, b;
  do {
    datagen_hard_fat(random, pair, 0);
    n = vec3_add(datagen_hard_face_normal(pair, 2), datagen_hard_face_normal(pair, 3));
    a = datagen_hard_vertex(pair, 0), b = datagen_hard_vertex(pair, 1);
    datagen_hard_set(pair, 4, on_edge == 2 ? a : vec3_scale(0.5, vec3_add(a, b)));
    if (on_edge == 2) datagen_hard_set(pair, 5, b);
  } while (!fill_beyond(random, pair, 4 + on_edge, n, a));
  expect(pair, 0, 0);
}

// Two edges cross in the middle of each.
static void make_edge_edge(Random *random, DatagenHardPair *pair) {
  Vec3 middle, n;
  bool is_below;
  do {
    datagen_hard_fat(random, pair, 0);
    Vec3 a = datagen_hard_vertex(pair, 0), b = datagen_hard_vertex(pair, 1), d = grid_point(random, -1, 1);
    middle = vec3_scale(0.5, vec3_add(a, b));
    n = vec3_cross(vec3_sub(b, a), d);
    if (vec3_dot(n, vec3_sub(datagen_hard_vertex(pair, 2), a)) > 0) n = vec3_scale(-1, n);
    is_below = vec3_dot(n, vec3_sub(datagen_hard_vertex(pair, 2), a)) < 0 &&
               vec3_dot(n, vec3_sub(datagen_hard_vertex(pair, 3), a)) < 0 && vec3_length(n) > 0.1;
    datagen_hard_set(pair, 4, vec3_add(middle, d)), datagen_hard_set(pair, 5, vec3_sub(middle, d));
  } while (!(is_below && fill_beyond(random, pair, 6, n, middle)));
  expect(pair, 0, 0);
}

static void make_shared_face(Random *random, DatagenHardPair *pair) {
  do {
    datagen_hard_fat(random, pair, 0);
    for (int i = 1; i < 4; i++) datagen_hard_set(pair, 3 + i, datagen_hard_vertex(pair, i));
  } while (!fill_beyond(random, pair, 7, datagen_hard_face_normal(pair, 0), datagen_hard_vertex(pair, 1)));
  expect(pair, 0, 0);
}

// One, two or three vertices in common, the rest anywhere: as a folded mesh has them.
static void share(Random *random, DatagenHardPair *pair, double vertices) {
  do {
    datagen_hard_fat(random, pair, 0);
    datagen_hard_fat(random, pair, 1);
    for (int i = 0; i < vertices; i++) datagen_hard_set(pair, 4 + i, datagen_hard_vertex(pair, i));
  } while (!(overlap_invariant_tet_volume(pair->x + 12) >= 0.02 / 6));
}

// Faces (0, 1, 2) of both in the plane z = slope·(x/2 + y/4), exactly; apexes on the same or opposite sides.
static void coplanar(Random *random, DatagenHardPair *pair, double slope, double side) {
  do {
    for (int i = 0; i < 8; i++) {
      Vec3 p = grid_point(random, 0, 1);
      double above = i == 3 ? 0.25 + p.z : i == 7 ? side * (0.25 + p.z) : 0;
      p.z = slope * (p.x / 2 + p.y / 4) + above;
      datagen_hard_set(pair, i, p);
    }
  } while (!(overlap_invariant_smaller_volume(pair->x) >= 0.02));
  if (side < 0) expect(pair, 0, 0);
}

static void make_same_axis(Random *random, DatagenHardPair *pair) {
  coplanar(random, pair, 0, 1);
}
static void make_same_tilted(Random *random, DatagenHardPair *pair) {
  coplanar(random, pair, 1, 1);
}
static void make_same_rotated(Random *random, DatagenHardPair *pair) {
  coplanar(random, pair, 0, 1);
  rotate(random, pair);
}
static void make_opposite_axis(Random *random, DatagenHardPair *pair) {
  coplanar(random, pair, 0, -1);
}
static void make_opposite_tilted(Random *random, DatagenHardPair *pair) {
  coplanar(random, pair, 1, -1);
}
static void make_opposite_rotated(Random *random, DatagenHardPair *pair) {
  coplanar(random, pair, 0, -1);
  rotate(random, pair);
  expect(pair, 0, 1e-15);
}

static void make_identical(Random *random, DatagenHardPair *pair) {
  datagen_hard_fat(random, pair, 0);
  rotate(random, pair);
  datagen_hard_permute(pair->x, random_below(random, 24), pair->x + 12);
  expect(pair, overlap_invariant_tet_volume(pair->x), 1e-15);
}

static void make_few_ulp(Random *random, DatagenHardPair *pair) {
  make_identical(random, pair);
  for (int i = 12; i < 24; i++)
    for (int steps = random_below(random, 7) - 3; steps; steps += steps < 0 ? 1 : -1)
      pair->x[i] = nextafter(pair->x[i], steps < 0 ? -INFINITY : INFINITY);
  expect(pair, overlap_invariant_tet_volume(pair->x), 1e-14);
}

// The second is a smaller tetrahedron at a random place inside the first.
static void make_inside(Random *random, DatagenHardPair *pair) {
  loose(random, pair, 0, 1e-2);
  do {
    for (int i = 4; i < 8; i++) {
      double weight[4], sum = 0;
      for (int a = 0; a < 4; a++) sum += weight[a] = random_between(random, 0.05, 1);
      Vec3 p = {0, 0, 0};
      for (int a = 0; a < 4; a++) p = vec3_add(p, vec3_scale(weight[a] / sum, datagen_hard_vertex(pair, a)));
      datagen_hard_set(pair, i, p);
    }
  } while (!(overlap_invariant_tet_volume(pair->x + 12) > 1e-5));
  expect(pair, overlap_invariant_tet_volume(pair->x + 12), 1e-15);
  pair->is_smooth = true;
}

// Each vertex of the second lies in a face, on an edge or at a vertex of the first.
static void make_inside_touching(Random *random, DatagenHardPair *pair) {
  datagen_hard_fat(random, pair, 0);
  do {
    for (int i = 0; i < 4; i++) {
      int left = 8;
      Vec3 p = {0, 0, 0};
      for (int a = 0; a < 3; a++) {
        int share = a == 2 ? left : random_below(random, left + 1);
        p = vec3_add(p, vec3_scale(share / 8.0, datagen_hard_vertex(pair, (i + 1 + a) % 4)));
        left -= share;
      }
      datagen_hard_set(pair, 4 + i, p);
    }
  } while (!(overlap_invariant_tet_volume(pair->x + 12) > 1e-3));
  expect(pair, overlap_invariant_tet_volume(pair->x + 12), 1e-15);
}

// A tetrahedron of volume 1e-12 through the middle of the unit cube: a cap (a vertex just above a face), a
// kite (two edges that nearly cross) or a needle.
static void sliver(Random *random, DatagenHardPair *pair, int which) {
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
  for (int i = 0; i < 4; i++) datagen_hard_set(pair, 4 * which + i, p[i]);
}

static void make_sliver_fat(Random *random, DatagenHardPair *pair) {
  sliver(random, pair, 0);
  loose(random, pair, 1, 1e-2);
}
static void make_sliver_sliver(Random *random, DatagenHardPair *pair) {
  sliver(random, pair, 0);
  sliver(random, pair, 1);
}

static void make_offset(Random *random, DatagenHardPair *pair) {
  const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  make_uniform(random, pair);
  datagen_hard_transform(pair->x, 8, identity, 1, (Vec3){1e6, -1e6, 1e6});
}

static void scaled(Random *random, DatagenHardPair *pair, double scale) {
  make_uniform(random, pair);
  for (int i = 0; i < 24; i++) pair->x[i] *= scale;
}
// Turned inside out: the first, the second or both have the negative orientation.
static void make_inverted(Random *random, DatagenHardPair *pair) {
  int which = 1 + random_below(random, 3);
  make_uniform(random, pair);
  for (int t = 0; t < 2; t++) {
    Vec3 a = datagen_hard_vertex(pair, 4 * t), b = datagen_hard_vertex(pair, 4 * t + 1);
    double det = vec3_det4(a, b, datagen_hard_vertex(pair, 4 * t + 2), datagen_hard_vertex(pair, 4 * t + 3));
    if ((det < 0) != ((which >> t & 1) != 0))
      datagen_hard_set(pair, 4 * t, b), datagen_hard_set(pair, 4 * t + 1, a);
  }
}

// Exactly flat, on the grid: four points of a tilted plane, of a line, two vertices the same, or a point.
static void make_flat(Random *random, DatagenHardPair *pair) {
  int which = random_below(random, 2), shape = random_below(random, 4);
  datagen_hard_fat(random, pair, 0);
  datagen_hard_fat(random, pair, 1);
  for (int i = 0; i < 4; i++) {
    Vec3 p = datagen_hard_vertex(pair, 4 * which + i);
    if (shape == 0) p.z = p.x / 2 + p.y / 4;
    if (shape == 1) p.y = p.x / 2, p.z = p.x / 4;
    if (shape == 2 && i == 3) p = datagen_hard_vertex(pair, 4 * which + random_below(random, 3));
    if (shape == 3 && i > 0) p = datagen_hard_vertex(pair, 4 * which);
    datagen_hard_set(pair, 4 * which + i, p);
  }
  expect(pair, 0, 0);
  pair->is_flat = true;
}

// Any kind of touch, moved: what touched on the grid now does but for the rounding of coordinates, which may
// part the two or let them share a volume of that size.
static void make_touching_moved(Random *random, DatagenHardPair *pair) {
  static const DatagenHardClass touches[] = {
      {.make_of = touch_face, .number = 1}, {.make_of = touch_face, .number = 2},
      {.make_of = touch_face, .number = 3}, {.make = make_vertex_vertex},
      {.make_of = touch_edge, .number = 1}, {.make_of = touch_edge, .number = 2},
      {.make = make_shared_face},           {.make = make_edge_edge}};
  datagen_hard_fill(&touches[random_below(random, 8)], random, pair);
  double rotation[9];
  random_rotation(random, rotation);
  datagen_hard_transform(pair->x, 8, rotation, 1, (Vec3){0.3, -0.7, 1.1});
  expect(pair, 0, 1e-14);
}

// A tetrahedron of a twentieth to a third of the size, through a face of the other.
static void make_small_through_face(Random *random, DatagenHardPair *pair) {
  datagen_hard_fat(random, pair, 0);
  double size = pow(10, random_between(random, -1.3, -0.5));
  Vec3 middle = face_point(random, pair);
  bool is_cut;
  do {
    datagen_hard_fat(random, pair, 1);
    Vec3 centre = {0, 0, 0}, n = datagen_hard_face_normal(pair, 0);
    for (int i = 4; i < 8; i++) centre = vec3_add(centre, vec3_scale(0.25, datagen_hard_vertex(pair, i)));
    int above = 0;
    for (int i = 4; i < 8; i++) {
      Vec3 arm = vec3_scale(size, vec3_sub(datagen_hard_vertex(pair, i), centre));
      above += vec3_dot(n, arm) > 0;
      datagen_hard_set(pair, i, vec3_add(middle, arm));
    }
    is_cut = above > 0 && above < 4;
  } while (!is_cut);
  rotate(random, pair);
  pair->is_smooth = true;
}

// One of the six tetrahedra of a cell of a cubic grid whose vertices are shifted by up to a fifth of its
// edge.
static void mesh_cell(Random *random, DatagenHardPair *pair, int which) {
  static const int paths[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const int *path = paths[random_below(random, 6)];
  double corner[3] = {0, 0, 0};
  for (int i = 0; i < 4; i++) {
    if (i) corner[path[i - 1]] = 1;
    for (int c = 0; c < 3; c++)
      pair->x[12 * which + 3 * i + c] = corner[c] + random_between(random, -0.2, 0.2);
  }
}

// Two cells of meshes that stand in each other, in any position, with a common volume of a ten-thousandth of
// the smaller at least: what a scene asks.
static void make_mesh_cells(Random *random, DatagenHardPair *pair) {
  enum { ATTEMPTS = 1000 }; // one in three does
  double volume = 0;
  unsigned flags;
  pair->failure = "no two mesh cells that overlap were found in 1000 attempts";
  for (int attempt = 0; attempt < ATTEMPTS && pair->failure; attempt++) {
    double rotation[9];
    mesh_cell(random, pair, 0);
    mesh_cell(random, pair, 1);
    random_rotation(random, rotation);
    Vec3 shift = {random_between(random, -0.5, 1), random_between(random, -0.5, 1),
                  random_between(random, -0.5, 1)};
    datagen_hard_transform(pair->x + 12, 4, rotation, 1, shift);
    if (overlap_exact_ops.eval_pair(NULL, pair->x, &(OverlapAnswer){.volume = &volume, .flags = &flags})) {
      pair->failure = "no memory for the exact volume";
      return;
    }
    if (volume > 1e-4 * overlap_invariant_smaller_volume(pair->x)) pair->failure = NULL;
  }
  pair->is_smooth = true;
}

const DatagenHardClass datagen_hard_classes[] = {
    {"far", .make = make_far},
    {"boxes", .make = make_boxes},
    {"uniform", .make = make_uniform},
    {"wild", .make = make_wild},
    {"shallow", .make = make_shallow},
    {"vertex on face", .make_of = touch_face, .number = 1},
    {"edge on face", .make_of = touch_face, .number = 2},
    {"face on face", .make_of = touch_face, .number = 3},
    {"vertex on vertex", .make = make_vertex_vertex},
    {"vertex on edge", .make_of = touch_edge, .number = 1},
    {"edge on edge", .make = make_edge_edge},
    {"shared edge", .make_of = touch_edge, .number = 2},
    {"shared face", .make = make_shared_face},
    {"shared vertex, overlapping", .make_of = share, .number = 1},
    {"shared edge, overlapping", .make_of = share, .number = 2},
    {"shared face, overlapping", .make_of = share, .number = 3},
    {"coplanar, same side, axis", .make = make_same_axis},
    {"coplanar, same side, tilted", .make = make_same_tilted},
    {"coplanar, same side, rotated", .make = make_same_rotated},
    {"coplanar, opposite, axis", .make = make_opposite_axis},
    {"coplanar, opposite, tilted", .make = make_opposite_tilted},
    {"coplanar, opposite, rotated", .make = make_opposite_rotated},
    {"identical", .make = make_identical},
    {"identical but a few ulp", .make = make_few_ulp},
    {"inside", .make = make_inside},
    {"inside, touching", .make = make_inside_touching},
    {"sliver and fat", .make = make_sliver_fat},
    {"sliver and sliver", .make = make_sliver_sliver},
    {"offset 1e6", .make = make_offset},
    {"scale 1e-9", .make_of = scaled, .number = 1e-9},
    {"scale 1e9", .make_of = scaled, .number = 1e9},
    {"inverted", .make = make_inverted},
    {"flat", .make = make_flat},
    {"touching, moved", .make = make_touching_moved},
    {"small through a face", .make = make_small_through_face},
    {"mesh cells", .make = make_mesh_cells},
};

_Static_assert(sizeof datagen_hard_classes / sizeof *datagen_hard_classes == DATAGEN_HARD_CLASS_COUNT,
               "datagen/hard.h says how many classes there are");

DatagenHardPair datagen_hard_make(int class_index, int member) {
  DatagenHardPair pair = {.volume = NAN};
  Random random = random_seeded((uint64_t)(1000 + class_index), (uint64_t)member);
  datagen_hard_fill(&datagen_hard_classes[class_index], &random, &pair);
  return pair;
}

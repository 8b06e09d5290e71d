// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/draw/scene_pairs.h"

#include <math.h>
#include <stdint.h>

#include "base/vec3.h"
#include "datagen/draw/cube.h"

static const double JITTER = 0.15, TILT = 0.2;
static const double LEAST_RATIO = 0.5, LARGEST_RATIO = 2;
static const double LEAST_DEPTH = 1e-3, LARGEST_DEPTH = 0.6;

// Vertex (i, j, k) is at p = edge · (i, j, k) and its own jitter, seen at rotation · (p − pivot) + place.
typedef struct Lattice {
  uint64_t seed;
  double edge;
  double rotation[9]; // row-major
  Vec3 pivot, place;
} Lattice;

static Vec3 turned(const double r[9], Vec3 x) {
  return (Vec3){r[0] * x.x + r[1] * x.y + r[2] * x.z, r[3] * x.x + r[4] * x.y + r[5] * x.z,
                r[6] * x.x + r[7] * x.y + r[8] * x.z};
}

static double log_uniform(Random *random, double low, double high) {
  return exp(random_between(random, log(low), log(high)));
}

// The jitter is a function of the vertex, so that neighbours share it.
static Vec3 place_vertex(const Lattice *lattice, const int index[3]) {
  uint64_t number = 0;
  double p[3];
  for (int c = 0; c < 3; c++) number = number << 20 | (uint64_t)(index[c] + (1 << 19));
  Random random = random_seeded(lattice->seed, number);
  for (int c = 0; c < 3; c++) p[c] = lattice->edge * (index[c] + random_between(&random, -JITTER, JITTER));
  return vec3_add(turned(lattice->rotation, vec3_sub(vec3_at(p), lattice->pivot)), lattice->place);
}

static void place_tet(const Lattice *lattice, const int cell[3], int which, double tet[12]) {
  static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  int index[3] = {cell[0], cell[1], cell[2]};
  for (int v = 0; v < 4; v++) {
    if (v > 0) index[order[which][v - 1]]++;
    vec3_store(tet + 3 * v, place_vertex(lattice, index));
  }
}

// About z by any angle, then about x by the tilt.
static void draw_rotation(Random *random, double r[9]) {
  double a = random_between(random, 0, 6.283185307179586), b = random_between(random, -TILT, TILT);
  double ca = cos(a), sa = sin(a), cb = cos(b), sb = sin(b);
  const double matrix[9] = {ca, -sa, 0, cb * sa, cb * ca, -sb, sb * sa, sb * ca, cb};
  for (int i = 0; i < 9; i++) r[i] = matrix[i];
}

static bool boxes_overlap(const double pair[24]) {
  double low[2][3], high[2][3];
  for (int t = 0; t < 2; t++) datagen_cube_box(pair + 12 * t, 4, low[t], high[t]);
  for (int c = 0; c < 3; c++)
    if (!(low[0][c] < high[1][c] && low[1][c] < high[0][c])) return false;
  return true;
}

static void turn_second(Random *random, double pair[24]) {
  double rotation[9];
  random_rotation(random, rotation);
  for (int i = 0; i < 8; i++) vec3_store(pair + 3 * i, turned(rotation, vec3_at(pair + 3 * i)));
}

bool datagen_scene_pairs_try(Random *random, double pair[24]) {
  Lattice lower = {.edge = 1, .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}}, upper = {0};
  lower.seed = random_bits(random);
  upper.seed = random_bits(random);
  upper.edge = log_uniform(random, LEAST_RATIO, LARGEST_RATIO);
  draw_rotation(random, upper.rotation);
  // a point of the upper surface's cell (0, 0) comes to lie over the lower surface's cell (0, 0) or beside it
  upper.pivot.x = upper.edge * random_uniform(random);
  upper.pivot.y = upper.edge * random_uniform(random);
  upper.place.x = random_between(random, -0.5, 1.5);
  upper.place.y = random_between(random, -0.5, 1.5);
  upper.place.z = -log_uniform(random, LEAST_DEPTH, LARGEST_DEPTH) * fmin(1, upper.edge);
  place_tet(&lower, (int[]){0, 0, -1}, random_below(random, 6), pair);
  place_tet(&upper, (int[]){0, 0, 0}, random_below(random, 6), pair + 12);
  if (!boxes_overlap(pair)) return false;
  turn_second(random, pair);
  double place[3];
  for (int c = 0; c < 3; c++) place[c] = random_uniform(random);
  datagen_cube_fit(pair, place);
  return true;
}

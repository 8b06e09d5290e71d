// SPDX-License-Identifier: Apache-2.0
#include "overlap/separation.h"

#include <float.h>
#include <stddef.h>

#include "base/tet.h"
#include "base/vec3.h"
#include "overlap/clip/lanes.h"

// fmin and fmax without their care for NaN, which costs a call each.
static inline double smaller(double a, double b) {
  return a < b ? a : b;
}
static inline double larger(double a, double b) {
  return a > b ? a : b;
}

// The pair relative to its first vertex, so that far from the origin nothing is lost but what the
// coordinates lack already.
typedef struct Pair {
  Vec3 x[2][4];
} Pair;

static Pair shifted(const double *pair) {
  Pair result;
  Vec3 origin = vec3_at(pair);
  for (int t = 0; t < 2; t++)
    for (int v = 0; v < 4; v++) result.x[t][v] = vec3_sub(vec3_at(pair + 12 * t + 3 * v), origin);
  return result;
}

typedef struct Interval {
  double low, high;
} Interval;

static Interval project(const Vec3 x[4], Vec3 axis) {
  double a = vec3_dot(x[0], axis), b = vec3_dot(x[1], axis), c = vec3_dot(x[2], axis),
         d = vec3_dot(x[3], axis);
  return (Interval){smaller(smaller(a, b), smaller(c, d)), larger(larger(a, b), larger(c, d))};
}

// Distance of the two projections on an axis, times the axis' length.
static double distance_along(const Pair *pair, Vec3 axis) {
  Interval a = project(pair->x[0], axis), b = project(pair->x[1], axis);
  return larger(b.low - a.high, a.low - b.high);
}

// The same for the axis e × f in metres; −INFINITY where the two are parallel and name no axis.
static double distance_across(const Pair *pair, Vec3 e, Vec3 f) {
  Vec3 axis = vec3_cross(e, f);
  double square = vec3_dot(axis, axis), scale = vec3_dot(e, e) * vec3_dot(f, f);
  if (!(square > 1e-24 * scale)) return -INFINITY;
  return distance_along(pair, axis) / sqrt(square);
}

static const int EDGES[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

static double separation_by_faces(const Pair *pair, double enough) {
  double best = -INFINITY;
  for (int t = 0; t < 2; t++)
    for (int f = 0; f < 4 && !(best > enough); f++) {
      const Vec3 *x = pair->x[t];
      Vec3 corner = x[tet_faces[f][0]];
      best = larger(best, distance_across(pair, vec3_sub(x[tet_faces[f][1]], corner),
                                          vec3_sub(x[tet_faces[f][2]], corner)));
    }
  return best;
}

double overlap_separation_pair(const double coordinates[24], double enough) {
  Pair pair = shifted(coordinates);
  double best = separation_by_faces(&pair, enough);
  for (int e = 0; e < 6 && !(best > enough); e++) {
    Vec3 edge = vec3_sub(pair.x[0][EDGES[e][1]], pair.x[0][EDGES[e][0]]);
    for (int f = 0; f < 6; f++)
      best = larger(best,
                    distance_across(&pair, edge, vec3_sub(pair.x[1][EDGES[f][1]], pair.x[1][EDGES[f][0]])));
  }
  return best;
}

double overlap_separation_halfspace(const double tet[12], const double point[3], const double normal[3]) {
  double lowest = INFINITY;
  for (int v = 0; v < 4; v++)
    lowest = smaller(lowest, vec3_dot(vec3_sub(vec3_at(tet + 3 * v), vec3_at(point)), vec3_at(normal)));
  return lowest;
}

// Products of three lengths have a rounding error below 1e-14 of the largest such product, so 1e-12 of it is
// beyond doubt. Overflow gives no certainty, nor does underflow: what is compared must be a normal number.
static inline bool exceeds_rounding(double product, double square) {
  const double allowed = 1e-24 * square;
  return product * product > allowed && allowed > DBL_MIN && allowed < DBL_MAX;
}

// A face's area vector, twice, turned outwards, and how high the vertex opposite lies over it.
typedef struct Side {
  Vec3 corner, e, g, normal;
  double top; // ≥ 0
} Side;

static inline Side side_of(const Vec3 x[4], int f) {
  Side side = {.corner = x[tet_faces[f][0]]};
  side.e = vec3_sub(x[tet_faces[f][1]], side.corner), side.g = vec3_sub(x[tet_faces[f][2]], side.corner);
  side.normal = vec3_cross(side.e, side.g);
  side.top = -vec3_dot(vec3_sub(x[f], side.corner), side.normal);
  if (side.top < 0) side.normal = vec3_scale(-1, side.normal), side.top = -side.top;
  return side;
}

static inline double square_of(Vec3 a) {
  return vec3_dot(a, a);
}

static bool has_volume(const Vec3 x[4]) {
  const Side side = side_of(x, 3);
  return exceeds_rounding(side.top,
                          square_of(side.e) * square_of(side.g) * square_of(vec3_sub(x[3], side.corner)));
}

// Whether all of y lies beyond face f of x.
static bool face_separates(const Vec3 x[4], const Vec3 y[4], int f) {
  const Side side = side_of(x, f);
  double lowest = INFINITY, reach = 0;
  for (int v = 0; v < 4; v++) lowest = smaller(lowest, vec3_dot(vec3_sub(y[v], side.corner), side.normal));
  if (!(lowest > 0)) return false;
  for (int v = 0; v < 4; v++) reach = larger(reach, square_of(vec3_sub(y[v], side.corner)));
  return exceeds_rounding(lowest, reach * square_of(side.e) * square_of(side.g));
}

bool overlap_separation_is_certain(const double coordinates[24]) {
  Vec3 x[2][4]; // as given: differences of these are right to the last place
  for (int k = 0; k < 8; k++) x[k / 4][k % 4] = vec3_at(coordinates + 3 * k);
  if (!has_volume(x[0]) || !has_volume(x[1])) return false;
  for (int t = 0; t < 2; t++)
    for (int f = 0; f < 4; f++)
      if (face_separates(x[t], x[1 - t], f)) return true;
  return false;
}

void overlap_separation_find(int count, const double *pairs, bool *is_apart) {
  const OverlapClipLanes *lanes = overlap_clip_lanes();
  int k = 0;
  for (; lanes && k + lanes->width <= count; k += lanes->width) {
    const uint32_t apart = lanes->separate(pairs + 24 * (size_t)k);
    for (int lane = 0; lane < lanes->width; lane++) is_apart[k + lane] = apart >> lane & 1;
  }
  for (; k < count; k++) is_apart[k] = overlap_separation_is_certain(pairs + 24 * (size_t)k);
}

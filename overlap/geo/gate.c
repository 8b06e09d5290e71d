// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/gate.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

// The planes of one tetrahedron before the division by det: exact where the coordinates are on a grid.
typedef struct Planes {
  Vec3 origin;
  Vec3 normal[4]; // det · ∇λ_k [m²]
  double det;     // [m³]
  double cube;    // of the longest edge [m³]
} Planes;

static double longest_edge_squared(const double tet[12]) {
  double longest = 0;
  for (int v = 1; v < 4; v++)
    for (int w = 0; w < v; w++) {
      Vec3 edge = vec3_sub(vec3_at(tet + 3 * v), vec3_at(tet + 3 * w));
      longest = fmax(longest, vec3_dot(edge, edge));
    }
  return longest;
}

static Planes planes_of(const double tet[12]) {
  Planes planes = {.origin = vec3_at(tet)};
  Vec3 edge[4];
  for (int v = 1; v < 4; v++) edge[v] = vec3_sub(vec3_at(tet + 3 * v), planes.origin);
  planes.normal[1] = vec3_cross(edge[2], edge[3]);
  planes.normal[2] = vec3_cross(edge[3], edge[1]);
  planes.normal[3] = vec3_cross(edge[1], edge[2]);
  planes.normal[0] = vec3_scale(-1, vec3_add(vec3_add(planes.normal[1], planes.normal[2]), planes.normal[3]));
  planes.det = vec3_dot(edge[1], planes.normal[1]);
  double longest = longest_edge_squared(tet);
  planes.cube = longest * sqrt(longest);
  return planes;
}

// Below OVERLAP_GEO_LEAST_DET dividing by det may overflow.
static bool is_flat(const Planes *planes) {
  return !(fabs(planes->det) > fmax(OVERLAP_GEO_FLATTEST * planes->cube, OVERLAP_GEO_LEAST_DET));
}

// How far out a point on a plane may seem to be.
static double noise_of(const Planes *planes) {
  return fmax(OVERLAP_GEO_NOISE, OVERLAP_GEO_ROUNDING * planes->cube / fabs(planes->det));
}

// The coordinates, in the tetrahedron of `planes`, of four points. Heights are summed before they are
// divided, so that a point that is exactly in a plane gets an exact zero.
static void locate(const Planes *planes, const double points[12], double across[4][4]) {
  double inverse = 1 / planes->det;
  for (int v = 0; v < 4; v++) {
    Vec3 p = vec3_sub(vec3_at(points + 3 * v), planes->origin);
    double height[4];
    height[0] = planes->det;
    for (int k = 1; k < 4; k++) height[0] -= height[k] = vec3_dot(planes->normal[k], p);
    for (int k = 0; k < 4; k++) across[v][k] = height[k] * inverse;
  }
}

// One plane has all four points on it or beyond.
static bool is_beyond_a_plane(double across[4][4]) {
  double highest[4];
  for (int k = 0; k < 4; k++)
    highest[k] = fmax(fmax(across[0][k], across[1][k]), fmax(across[2][k], across[3][k]));
  return fmin(fmin(highest[0], highest[1]), fmin(highest[2], highest[3])) <= 0;
}

static bool is_inside(double across[4][4], double noise) {
  double lowest = 0;
  for (int v = 0; v < 4; v++)
    for (int k = 0; k < 4; k++) lowest = fmin(lowest, across[v][k]);
  return lowest >= -noise;
}

// The part of an edge that is inside or on the boundary, as two parameters between 0 and 1; false if there is
// none, not even with planes moved out by noise, which are entered at `earliest` and left from `latest` on
// (places along the edge are rounded, too).
// The ends are on the planes as they are; where these leave nothing, no farther than the moved ones let them.
// An edge within a plane is not cut by it.
static bool clip(const double p[4], const double q[4], double noise, double range[2]) {
  bool is_out = false;
  double from = 0, to = 1, earliest = 0, latest = 1;
  for (int k = 0; k < 4; k++) {
    double inverse = 1 / (p[k] - q[k]), at = p[k] * inverse, moved = at + noise * inverse;
    bool is_p_out = p[k] < -noise, is_q_out = q[k] < -noise;
    is_out |= is_p_out && is_q_out;
    from = is_p_out || (p[k] < 0 && q[k] > noise) ? fmax(from, at) : from;
    to = is_q_out || (q[k] < 0 && p[k] > noise) ? fmin(to, at) : to;
    earliest = is_p_out ? fmax(earliest, moved) : earliest;
    latest = is_q_out ? fmin(latest, moved) : latest;
  }
  range[0] = fmin(from, latest), range[1] = fmax(to, earliest);
  return !is_out && earliest <= latest + noise;
}

// Adds the ends of what is left of one tetrahedron's six edges to the slacks `own` and `other`; how many.
static int add_ends(double across[4][4], double noise, double own[4], double other[4]) {
  int count = 0;
  for (int v = 1; v < 4; v++)
    for (int w = 0; w < v; w++) {
      double range[2];
      if (!clip(across[v], across[w], noise, range)) continue;
      double at = range[0] + range[1];
      own[v] += 2 - at, own[w] += at;
      for (int k = 0; k < 4; k++) other[k] += 2 * across[v][k] + at * (across[w][k] - across[v][k]);
      count += 2;
    }
  return count;
}

static void write_normals(const Planes planes[2], GeoColumns *normal) {
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < 4; k++) {
      Vec3 n = vec3_scale(1 / planes[t].det, planes[t].normal[k]);
      int l = 4 * t + k;
      normal->column[0][l] = n.x, normal->column[1][l] = n.y, normal->column[2][l] = n.z;
    }
}

OverlapGeoOutcome overlap_geo_gate(OverlapGeoGate *gate, const double pair[24]) {
  Planes planes[2] = {planes_of(pair), planes_of(pair + 12)};
  for (int t = 0; t < 2; t++)
    if (is_flat(&planes[t])) return OVERLAP_GEO_UNFIT;
  gate->least_volume = fmin(fabs(planes[0].det), fabs(planes[1].det)) / 6;
  write_normals(planes, &gate->normal);
  locate(&planes[1], pair, gate->across[0]);
  locate(&planes[0], pair + 12, gate->across[1]);
  if (is_beyond_a_plane(gate->across[0]) || is_beyond_a_plane(gate->across[1])) return OVERLAP_GEO_EMPTY;
  double noise[2] = {noise_of(&planes[1]), noise_of(&planes[0])}; // of gate->across
  gate->is_enclosed = is_inside(gate->across[0], noise[0]) || is_inside(gate->across[1], noise[1]);

  memset(gate->slack, 0, sizeof gate->slack);
  int count = add_ends(gate->across[0], noise[0], gate->slack, gate->slack + 4);
  count += add_ends(gate->across[1], noise[1], gate->slack + 4, gate->slack);
  if (count == 0) return OVERLAP_GEO_EMPTY;
  bool is_inside_all = true;
  for (int k = 0; k < GEO_LANES; k++) is_inside_all &= (gate->slack[k] /= count) > OVERLAP_GEO_LEAST_SLACK;
  return is_inside_all ? OVERLAP_GEO_INSIDE : OVERLAP_GEO_EMPTY;
}

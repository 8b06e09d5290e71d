// SPDX-License-Identifier: Apache-2.0
#include "overlap/clip/polytope.h"

#include <float.h>
#include <stdbool.h>
#include <string.h>

// Barycentric coordinates of one tetrahedron's vertices in the other.
typedef struct Sides {
  double lane[4][4]; // vertex, plane
} Sides;

static OverlapClipFrame frame_of(const double tet[12]) {
  Vec3 origin = vec3_at(tet);
  Vec3 a = vec3_sub(vec3_at(tet + 3), origin), b = vec3_sub(vec3_at(tet + 6), origin);
  Vec3 c = vec3_sub(vec3_at(tet + 9), origin);
  OverlapClipFrame frame;
  frame.normal[1] = vec3_cross(b, c);
  frame.normal[2] = vec3_cross(c, a);
  frame.normal[3] = vec3_cross(a, b);
  frame.normal[0] = vec3_scale(-1, vec3_add(frame.normal[1], vec3_add(frame.normal[2], frame.normal[3])));
  frame.det = vec3_dot(a, frame.normal[1]);
  frame.inverse_det = 1 / frame.det;
  return frame;
}

static inline Sides sides_of(const OverlapClipFrame *frame, const double tet[12], const double other[12]) {
  Sides sides;
  Vec3 origin = vec3_at(tet);
  for (int j = 0; j < 4; j++) {
    Vec3 p = vec3_sub(vec3_at(other + 3 * j), origin);
    double *lane = sides.lane[j];
    for (int k = 1; k < 4; k++) lane[k] = vec3_dot(frame->normal[k], p) * frame->inverse_det;
    lane[0] = 1 - lane[1] - lane[2] - lane[3];
  }
  return sides;
}

static inline double largest(double a, double b) {
  return a > b ? a : b;
}

static inline double smallest(double a, double b) {
  return a < b ? a : b;
}

// The highest vertex above each plane; the smallest of these is negative if a plane separates.
static inline double lowest_top(const Sides *sides) {
  double top[4];
  for (int k = 0; k < 4; k++)
    top[k] =
        largest(largest(sides->lane[0][k], sides->lane[1][k]), largest(sides->lane[2][k], sides->lane[3][k]));
  return smallest(smallest(top[0], top[1]), smallest(top[2], top[3]));
}

// Bit k: plane k has a vertex outside.
static inline unsigned cutting_planes(const Sides *sides) {
  unsigned cutting = 0;
  for (int k = 0; k < 4; k++) {
    double bottom = smallest(smallest(sides->lane[0][k], sides->lane[1][k]),
                             smallest(sides->lane[2][k], sides->lane[3][k]));
    cutting |= (unsigned)(bottom < 0) << k;
  }
  return cutting;
}

static double edges_squared(const double tet[12]) {
  double sum = 0;
  for (int i = 3; i < 12; i++) sum += (tet[i] - tet[i % 3]) * (tet[i] - tet[i % 3]);
  return sum;
}

static double distance_squared(const double a[3], const double b[3]) {
  Vec3 way = vec3_sub(vec3_at(b), vec3_at(a));
  return vec3_dot(way, way);
}

// |det| beyond what rounding makes of a flat tetrahedron, ε (Σ edge²)^(3/2); and not near underflow.
static bool has_volume(double size, double squared) {
  return size * size > DBL_EPSILON * DBL_EPSILON * squared * squared * squared && size > DBL_MIN;
}

// The tetrahedron's own six edges; plane numbers of A.
static const OverlapClipEdge whole[6] = {{1, 2, 0, 3}, {2, 3, 0, 1}, {3, 1, 0, 2},
                                         {0, 3, 1, 2}, {2, 0, 1, 3}, {0, 1, 2, 3}};

static void start(OverlapClipPolytope *polytope, int subject, const Sides *sides) {
  uint8_t own = (uint8_t)(4 * subject), other = (uint8_t)(4 - own);
  polytope->subject = subject;
  polytope->vertex_count = 4;
  polytope->edge_count = 6;
  memset(polytope->origin, 0, sizeof polytope->origin);
  for (int j = 0; j < 4; j++) {
    double *vertex = polytope->vertex[j];
    for (int k = 0; k < 4; k++) vertex[own + k] = j == k, vertex[other + k] = sides->lane[j][k];
  }
  for (int e = 0; e < 6; e++) {
    OverlapClipEdge edge = whole[e];
    polytope->edge[e] =
        (OverlapClipEdge){edge.from, edge.to, (uint8_t)(edge.left + own), (uint8_t)(edge.right + own)};
  }
}

// Turned so that it is walked from the inside of plane k to the outside.
static inline OverlapClipEdge turned_outward(const OverlapClipPolytope *polytope, OverlapClipEdge edge,
                                             int k) {
  bool leaves = polytope->vertex[edge.to][k] < 0;
  return (OverlapClipEdge){leaves ? edge.from : edge.to, leaves ? edge.to : edge.from,
                           leaves ? edge.left : edge.right, leaves ? edge.right : edge.left};
}

// Removes what lies outside of plane k.
static void cut(OverlapClipPolytope *polytope, int k) {
  OverlapClipEdge crossing[OVERLAP_CLIP_EDGES];
  int kept = 0, crossing_count = 0;
  for (int e = 0; e < polytope->edge_count; e++) {
    OverlapClipEdge edge = polytope->edge[e];
    int from_outside = polytope->vertex[edge.from][k] < 0, to_outside = polytope->vertex[edge.to][k] < 0;
    polytope->edge[kept] = edge;
    crossing[crossing_count] = edge;
    kept += !(from_outside | to_outside);
    crossing_count += from_outside ^ to_outside;
  }

  // The walk around face `left` leaves at the new vertex, the walk around `right` enters there. A face may be
  // entered several times where distances are rounding: its entries form a list.
  uint8_t entry[8] = {0}, next_entry[OVERLAP_CLIP_EDGES];
  int made = polytope->vertex_count;
  for (int c = 0; c < crossing_count; c++) {
    OverlapClipEdge edge = turned_outward(polytope, crossing[c], k);
    const double *in = polytope->vertex[edge.from], *out = polytope->vertex[edge.to];
    double *vertex = polytope->vertex[made + c];
    double scale = 1 / (in[k] - out[k]), to_share = in[k] * scale, from_share = -out[k] * scale;
    for (int lane = 0; lane < 8; lane++) vertex[lane] = from_share * in[lane] + to_share * out[lane];
    vertex[k] = 0;
    edge.to = (uint8_t)(made + c);
    crossing[c] = polytope->edge[kept++] = edge;
    next_entry[c] = entry[edge.right];
    entry[edge.right] = (uint8_t)c;
  }
  for (int c = 0; c < crossing_count; c++) {
    uint8_t face = crossing[c].left, end = entry[face];
    entry[face] = next_entry[end];
    polytope->edge[kept++] = (OverlapClipEdge){(uint8_t)(made + c), (uint8_t)(made + end), face, (uint8_t)k};
  }
  polytope->vertex_count = made + crossing_count;
  polytope->edge_count = kept;
}

// The highest vertex that is left above plane k.
static double top_above(const OverlapClipPolytope *polytope, int k) {
  double top = -INFINITY;
  for (int e = 0; e < polytope->edge_count; e++) {
    OverlapClipEdge edge = polytope->edge[e];
    top = largest(top, largest(polytope->vertex[edge.from][k], polytope->vertex[edge.to][k]));
  }
  return top;
}

// What clipping starts from.
typedef struct Start {
  Sides a_in_b, b_in_a;
  double size_a, size_b; // |det|
  bool is_flat;          // rounding of the planes alone may exceed 1e-12 of the smaller volume
} Start;

// Sets the polytope's frames and noise. OVERLAP: no plane of either separates them.
static inline OverlapClipOutcome separate(OverlapClipPolytope *polytope, const double *a, const double *b,
                                          Start *it) {
  polytope->frame[0] = frame_of(a), polytope->frame[1] = frame_of(b);
  it->size_a = fabs(polytope->frame[0].det), it->size_b = fabs(polytope->frame[1].det);
  double squared_a = edges_squared(a), squared_b = edges_squared(b);
  if (!(has_volume(it->size_a, squared_a) && has_volume(it->size_b, squared_b)))
    return OVERLAP_CLIP_UNCERTAIN;

  // no difference of coordinates is much longer than the root of `squared`
  double squared = squared_a + squared_b + distance_squared(a, b);
  double noise = polytope->noise = OVERLAP_CLIP_NOISE * squared * sqrt(squared) + DBL_MIN;
  it->b_in_a = sides_of(&polytope->frame[0], a, b);
  double top_a = lowest_top(&it->b_in_a);
  if (top_a * it->size_a < -noise) return OVERLAP_CLIP_DISJOINT;
  it->a_in_b = sides_of(&polytope->frame[1], b, a);
  double top_b = lowest_top(&it->a_in_b);
  if (top_b * it->size_b < -noise) return OVERLAP_CLIP_DISJOINT;

  // an error of det · λ of `noise` moves a face by a volume of at most half of that
  double size = smallest(it->size_a, it->size_b);
  it->is_flat = !(noise / 2 <= 1e-12 * size / 6);
  if (top_a <= 0 || top_b <= 0) return it->is_flat ? OVERLAP_CLIP_UNCERTAIN : OVERLAP_CLIP_DISJOINT;
  return noise <= OVERLAP_CLIP_FLATTEST * size ? OVERLAP_CLIP_OVERLAP : OVERLAP_CLIP_UNCERTAIN;
}

// The tetrahedron that fewer of the other's planes cut is clipped by those.
OverlapClipOutcome overlap_clip_polytope_make(OverlapClipPolytope *polytope, const double pair[24]) {
  Start it;
  OverlapClipOutcome outcome = separate(polytope, pair, pair + 12, &it);
  if (outcome != OVERLAP_CLIP_OVERLAP) return outcome;

  unsigned cuts_a = cutting_planes(&it.a_in_b), cuts_b = cutting_planes(&it.b_in_a);
  bool takes_b = __builtin_popcount(cuts_b) < __builtin_popcount(cuts_a);
  unsigned cutting = takes_b ? cuts_b : cuts_a;
  double size = takes_b ? it.size_a : it.size_b; // of the tetrahedron whose planes cut
  start(polytope, takes_b, takes_b ? &it.b_in_a : &it.a_in_b);
  if (!cutting) return OVERLAP_CLIP_ENCLOSED;
  for (int k = 0; k < 4; k++) {
    if (!(cutting >> k & 1)) continue;
    int plane = takes_b ? k : k + 4;
    bool is_surely_empty = !it.is_flat || top_above(polytope, plane) * size < -polytope->noise;
    cut(polytope, plane);
    if (polytope->edge_count == 0) return is_surely_empty ? OVERLAP_CLIP_DISJOINT : OVERLAP_CLIP_UNCERTAIN;
  }
  return OVERLAP_CLIP_OVERLAP;
}

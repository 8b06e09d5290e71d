// SPDX-License-Identifier: Apache-2.0
#include "overlap/exact/polygon.h"

#include <assert.h>
#include <stdlib.h>

#include "overlap/exact/fixed.h"

static const mp_limb_t one_limb = 1;
static const ExactInteger one = {&one_limb, 1}, zero = {&one_limb, 0};

// α_k of the other's vertex p, for a plane k of the own tetrahedron.
static ExactInteger above_own(const ExactPolygon *polygon, int p, int k) {
  return polygon->pair->tets[polygon->own].height[p][k];
}

// β_l of the own vertex j, for a plane l of the other tetrahedron.
static ExactInteger above_other(const ExactPolygon *polygon, int j, int l) {
  return polygon->pair->tets[1 - polygon->own].height[j][l];
}

static ExactInteger bracket(const ExactPolygon *polygon, int own_edge, int other_edge) {
  const ExactPair *pair = polygon->pair;
  return polygon->own == 0 ? pair->cross[own_edge][other_edge] : pair->cross[other_edge][own_edge];
}

// The sign of the permutation (ends of the edge opposite to mn, m, n).
static int parity(int m, int n) {
  return overlap_exact_pair_edge_sign[5 - overlap_exact_pair_edge_of[m][n]] * (m < n ? 1 : -1);
}

// Where the own edge i j meets plane l: x = (β_l(j) a_i − β_l(i) a_j) / w, w = β_l(j) − β_l(i). By Cramer's
// rule β_m(x) w = β_m(i) β_l(j) − β_l(i) β_m(j) = ε D [a_i a_j b_p b_q] with p q the two others of m, l.
// Returns β_m(x) |w| / D.
static ExactInteger own_edge_height(const ExactPolygon *polygon, const ExactCorner *corner, int m) {
  if (m == corner->plane) return zero;
  const int other_edge = 5 - overlap_exact_pair_edge_of[m][corner->plane];
  return overlap_exact_integer_signed(bracket(polygon, corner->edge, other_edge),
                                      corner->turn * parity(m, corner->plane));
}

// Where the other's edge p q meets the face k: x = (α_k(q) b_p − α_k(p) b_q) / w, w = α_k(q) − α_k(p).
// It lies in the two planes that hold the edge; β_p(x) = D α_k(q) / w and β_q(x) = −D α_k(p) / w.
// Returns β_m(x) |w| / D.
static ExactInteger other_edge_height(const ExactPolygon *polygon, const ExactCorner *corner, int m) {
  const int p = overlap_exact_pair_edge_ends[corner->edge][0],
            q = overlap_exact_pair_edge_ends[corner->edge][1];
  if (m == p) return overlap_exact_integer_signed(above_own(polygon, q, polygon->face), corner->turn);
  if (m == q) return overlap_exact_integer_signed(above_own(polygon, p, polygon->face), -corner->turn);
  return zero;
}

// A positive multiple of β_m at the corner.
static ExactInteger height_over(const ExactPolygon *polygon, const ExactCorner *corner, int m) {
  switch (corner->kind) {
  case EXACT_CORNER_VERTEX:
    return above_other(polygon, corner->vertex, m);
  case EXACT_CORNER_OWN_EDGE:
    return own_edge_height(polygon, corner, m);
  case EXACT_CORNER_OTHER_EDGE:
    return other_edge_height(polygon, corner, m);
  }
  return zero;
}

// |w| of the formulas above.
static ExactInteger weight(const ExactPolygon *polygon, ExactArena *arena, const ExactCorner *corner) {
  if (corner->kind == EXACT_CORNER_VERTEX) return one;
  ExactInteger w;
  if (corner->kind == EXACT_CORNER_OWN_EDGE) {
    const int *ends = overlap_exact_pair_edge_ends[corner->edge];
    w = overlap_exact_integer_sub(arena, above_other(polygon, ends[1], corner->plane),
                                  above_other(polygon, ends[0], corner->plane));
  } else {
    const int *ends = overlap_exact_pair_edge_ends[corner->edge];
    w = overlap_exact_integer_sub(arena, above_own(polygon, ends[1], polygon->face),
                                  above_own(polygon, ends[0], polygon->face));
  }
  return overlap_exact_integer_signed(w, overlap_exact_integer_sign(w));
}

// |w| times the barycentric coordinate of the corner for vertex i of the face. For the other's edge that is
// ε [a_j a_j' b_p b_q], j j' the two others of i and the face's number, again by Cramer's rule.
static ExactInteger coordinate(const ExactPolygon *polygon, const ExactCorner *corner, int i) {
  switch (corner->kind) {
  case EXACT_CORNER_VERTEX:
    return corner->vertex == i ? one : zero;
  case EXACT_CORNER_OWN_EDGE: {
    const int *ends = overlap_exact_pair_edge_ends[corner->edge];
    if (i == ends[0])
      return overlap_exact_integer_signed(above_other(polygon, ends[1], corner->plane), corner->turn);
    if (i == ends[1])
      return overlap_exact_integer_signed(above_other(polygon, ends[0], corner->plane), -corner->turn);
    return zero;
  }
  case EXACT_CORNER_OTHER_EDGE: {
    const int own_edge = 5 - overlap_exact_pair_edge_of[i][polygon->face];
    return overlap_exact_integer_signed(bracket(polygon, own_edge, corner->edge),
                                        corner->turn * parity(i, polygon->face));
  }
  }
  return zero;
}

// The point of line `line` in plane m. The line has points strictly on both sides of m, so there is one.
static ExactCorner cross_line(const ExactPolygon *polygon, int line, int m) {
  ExactCorner corner = {.kind = EXACT_CORNER_OWN_EDGE, .plane = m};
  ExactInteger first, second;
  if (line >= 4) {
    corner.edge = line - 4;
    first = above_other(polygon, overlap_exact_pair_edge_ends[corner.edge][0], m);
    second = above_other(polygon, overlap_exact_pair_edge_ends[corner.edge][1], m);
  } else {
    corner.kind = EXACT_CORNER_OTHER_EDGE;
    corner.edge = 5 - overlap_exact_pair_edge_of[line][m];
    first = above_own(polygon, overlap_exact_pair_edge_ends[corner.edge][0], polygon->face);
    second = above_own(polygon, overlap_exact_pair_edge_ends[corner.edge][1], polygon->face);
  }
  const int order = overlap_exact_integer_compare(second, first);
  corner.turn = (order > 0) - (order < 0);
  assert(corner.turn != 0);
  return corner;
}

static void append(ExactPolygon *polygon, ExactCorner corner, int line) {
  assert(polygon->count < EXACT_POLYGON_CORNERS);
  polygon->corners[polygon->count] = corner;
  polygon->lines[polygon->count++] = line;
}

// Keeps the part with β_m ≥ 0.
static void cut_by(ExactPolygon *polygon, int m) {
  int side[EXACT_POLYGON_CORNERS], lowest = 0;
  for (int t = 0; t < polygon->count; t++) {
    side[t] = overlap_exact_integer_sign(height_over(polygon, &polygon->corners[t], m));
    if (side[t] < lowest) lowest = side[t];
  }
  if (lowest == 0) return;
  const ExactPolygon whole = *polygon;
  polygon->count = 0;
  for (int t = 0; t < whole.count; t++) {
    const int here = side[t], there = side[(t + 1) % whole.count], line = whole.lines[t];
    if (here >= 0) append(polygon, whole.corners[t], here == 0 && there < 0 ? m : line);
    if (here * there < 0) append(polygon, cross_line(&whole, line, m), there < 0 ? m : line);
  }
}

void overlap_exact_polygon_cut(ExactPolygon *polygon, const ExactPair *pair, int own, int face) {
  *polygon = (ExactPolygon){.pair = pair, .own = own, .face = face};
  int ends[3], count = 0;
  for (int i = 0; i < 4; i++)
    if (i != face) ends[count++] = i;
  for (int t = 0; t < 3; t++)
    append(polygon, (ExactCorner){.kind = EXACT_CORNER_VERTEX, .vertex = ends[t]},
           4 + overlap_exact_pair_edge_of[ends[t]][ends[(t + 1) % 3]]);
  for (int m = 0; m < 4 && polygon->count >= 3; m++) cut_by(polygon, m);
}

// A corner in homogeneous barycentric coordinates of its face, and as numbers.
typedef struct Placed {
  ExactInteger coordinate[3]; // ≥ 0, sum = weight
  int dropped;                // limbs of the weight left out below
  ExactFixed fixed;           // the same
  long double inverse;        // 2^bits / weight, bits as in `fixed`
  long double weight;         // without the limbs dropped
  long double share[3];       // coordinate / weight, where moments are wanted
} Placed;

static long double share_of(const Placed *placed, int c) {
  long double value;
  if (placed->coordinate[c].size == 0) return 0;
  if (overlap_exact_fixed_value(&placed->fixed, c, &value)) return value * placed->inverse;
  return overlap_exact_integer_value(placed->coordinate[c], placed->dropped) / placed->weight;
}

static Placed place(const ExactPolygon *polygon, ExactArena *arena, const ExactCorner *corner,
                    bool with_shares) {
  Placed placed;
  const ExactInteger w = weight(polygon, arena, corner);
  placed.dropped = w.size > 3 ? w.size - 3 : 0;
  for (int i = 0, c = 0; i < 4; i++)
    if (i != polygon->face) placed.coordinate[c++] = coordinate(polygon, corner, i);
  placed.fixed = overlap_exact_fixed_from(placed.coordinate, w);
  placed.inverse = 1 / overlap_exact_fixed_weight(w);
  placed.weight = overlap_exact_integer_value(w, placed.dropped);
  for (int c = 0; c < 3 && with_shares; c++) placed.share[c] = share_of(&placed, c);
  return placed;
}

// The area of the triangle p q r relative to the face: det(p, q, r) / (w_p w_q w_r), ≥ 0 as the corners go
// round with the face's vertices in increasing order. All digits are computed where 127 may not do.
static long double triangle(ExactArena *arena, const Placed *p, const Placed *q, const Placed *r) {
  long double value;
  if (overlap_exact_fixed_determinant(&p->fixed, &q->fixed, &r->fixed, &value))
    return value * (p->inverse * q->inverse * r->inverse);
  mp_limb_t *mark = arena->next;
  ExactInteger qr[3];
  overlap_exact_integer_cross(arena, q->coordinate, r->coordinate, qr);
  const ExactInteger det = overlap_exact_integer_dot(arena, p->coordinate, qr);
  value = overlap_exact_integer_value(det, p->dropped + q->dropped + r->dropped);
  arena->next = mark;
  return value / (p->weight * q->weight * r->weight);
}

ExactMoments overlap_exact_polygon_measure(const ExactPolygon *polygon, ExactArena *arena,
                                           bool with_moments) {
  ExactMoments moments = {0};
  if (polygon->count < 3) return moments;
  mp_limb_t *mark = arena->next;
  const Placed apex = place(polygon, arena, &polygon->corners[0], with_moments);
  Placed last = place(polygon, arena, &polygon->corners[1], with_moments);
  for (int t = 2; t < polygon->count; t++) {
    const Placed next = place(polygon, arena, &polygon->corners[t], with_moments);
    const long double area = triangle(arena, &apex, &last, &next);
    moments.area += area;
    for (int i = 0, c = 0; i < 4 && with_moments; i++) {
      if (i == polygon->face) continue;
      moments.moment[i] += area * (apex.share[c] + last.share[c] + next.share[c]) / 3;
      c++;
    }
    last = next;
  }
  arena->next = mark;
  return moments;
}

void overlap_exact_polygon_lift(const ExactPolygon *polygon, ExactArena *arena, long double height[2][4]) {
  const ExactCorner *corner = &polygon->corners[0];
  const ExactTet *tets = polygon->pair->tets;
  const int own = polygon->own, other = 1 - own;
  mp_limb_t *mark = arena->next;
  const long double w = overlap_exact_integer_value(weight(polygon, arena, corner), 0);
  const long double own_det = overlap_exact_integer_value(tets[own].det, 0),
                    other_det = overlap_exact_integer_value(tets[other].det, 0);
  for (int k = 0; k < 4; k++) {
    height[own][k] = k == polygon->face
                         ? 0
                         : own_det * (overlap_exact_integer_value(coordinate(polygon, corner, k), 0) / w);
    const long double over = overlap_exact_integer_value(height_over(polygon, corner, k), 0);
    height[other][k] = corner->kind == EXACT_CORNER_VERTEX ? over : other_det * (over / w);
  }
  arena->next = mark;
}

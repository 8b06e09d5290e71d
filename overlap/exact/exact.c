// SPDX-License-Identifier: Apache-2.0
// The boundary of the intersection is eight polygons, one on each face of either tetrahedron. With O any
// point of the intersection, here one of its corners, and r_F the polygon's share of the face F,
//
//     V = Σ_F α_F(O) r_F / 6                    pyramids over the polygons with apex O
//     dV/dx_i = Σ_{F∋i} −½ n_F m_{F,i}          Reynolds: the face moves by N_i dx_i; −½ n_F is its outward
//                                               area vector, m_{F,i} the polygon's share weighted with N_i
//
//     x̄ = ¼ O + ¾ Σ_F α_F(O) Σ_i m_{F,i} x_i / Σ_F α_F(O) r_F,   O = Σ_k α_k(O) x_k / Σ_k α_k(O)
//
// the mean of the pyramids' centroids, k the planes of one of the two; and every α, r and m is a sum of
// non-negative terms.
#include "overlap/exact/exact.h"

#include <math.h>

#include "overlap/exact/polygon.h"
#include "overlap/separation.h"

// All four vertices of one on the outer side of a face of the other, or in it.
static bool is_beyond_a_face(const ExactPair *pair) {
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < 4; k++) {
      int highest = -1;
      for (int p = 0; p < 4; p++) {
        const int side = overlap_exact_integer_sign(pair->tets[t].height[p][k]);
        if (side > highest) highest = side;
      }
      if (highest <= 0) return true;
    }
  return false;
}

// Every vertex of the other tetrahedron lies in this one.
static bool encloses(const ExactTet *tet) {
  for (int p = 0; p < 4; p++)
    for (int k = 0; k < 4; k++)
      if (overlap_exact_integer_sign(tet->height[p][k]) < 0) return false;
  return true;
}

// Face k of tetrahedron t lies in a plane of the other. Not back to back: those pairs were found disjoint.
static bool coincides(const ExactPair *pair, int t, int k) {
  for (int l = 0; l < 4; l++) {
    int in_plane = 0;
    for (int j = 0; j < 4; j++)
      in_plane += j != k && overlap_exact_integer_sign(pair->tets[1 - t].height[j][l]) == 0;
    if (in_plane == 3) return true;
  }
  return false;
}

typedef struct Boundary {
  bool has_area;
  ExactMoments parts[2][4]; // polygons, halved where faces coincide
  long double apex[2][4];   // heights of a corner of the intersection over the planes [unit³]
} Boundary;

static void halve(ExactMoments *part) {
  part->area /= 2;
  for (int i = 0; i < 4; i++) part->moment[i] /= 2;
}

static void find_boundary(Boundary *boundary, const ExactPair *pair, ExactArena *arena, bool with_moments) {
  ExactPolygon polygon;
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < 4; k++) {
      overlap_exact_polygon_cut(&polygon, pair, t, k);
      boundary->parts[t][k] = overlap_exact_polygon_measure(&polygon, arena, with_moments);
      if (polygon.count < 3) continue;
      if (!boundary->has_area) overlap_exact_polygon_lift(&polygon, arena, boundary->apex);
      boundary->has_area = true;
      if (coincides(pair, t, k)) halve(&boundary->parts[t][k]);
    }
}

static double sum_volume(const Boundary *boundary, int exponent) {
  long double volume = 0;
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < 4; k++) volume += boundary->apex[t][k] * boundary->parts[t][k].area;
  return (double)ldexpl(volume / 6, 3 * exponent);
}

static void sum_gradient(const Boundary *boundary, const ExactPair *pair, double gradient[24]) {
  for (int t = 0; t < 2; t++) {
    const ExactTet *tet = &pair->tets[t];
    long double sum[4][3] = {{0}};
    for (int k = 0; k < 4; k++) {
      if (!(boundary->parts[t][k].area > 0)) continue;
      for (int c = 0; c < 3; c++) {
        const long double outward = -overlap_exact_integer_value(tet->normal[k][c], 0) / 2;
        for (int i = 0; i < 4; i++) sum[i][c] += outward * boundary->parts[t][k].moment[i];
      }
    }
    for (int i = 0; i < 4; i++)
      for (int c = 0; c < 3; c++)
        gradient[12 * t + 3 * tet->order[i] + c] = (double)ldexpl(sum[i][c], 2 * pair->exponent);
  }
}

// Relative to the pair's first vertex, with weights that are all positive.
static void sum_centroid(const Boundary *boundary, const ExactPair *pair, const double coordinates[24],
                         double centroid[3]) {
  long double det = 0, volume = 0, apex[3] = {0}, sum[3] = {0};
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < 4; k++) {
      const long double height = boundary->apex[t][k];
      volume += height * boundary->parts[t][k].area;
      if (t == 0) det += height;
      for (int i = 0; i < 4; i++) {
        const double *x = coordinates + 12 * t + 3 * pair->tets[t].order[i];
        const long double weight = height * boundary->parts[t][k].moment[i];
        for (int c = 0; c < 3; c++) {
          const long double way = (long double)x[c] - coordinates[c];
          sum[c] += weight * way;
          if (t == 0 && i == k) apex[c] += height * way;
        }
      }
    }
  for (int c = 0; c < 3; c++)
    centroid[c] = (double)(coordinates[c] + (apex[c] / det + 3 * sum[c] / volume) / 4);
}

static unsigned intersect(const double coordinates[24], const OverlapAnswer *answer) {
  if (overlap_separation_is_certain(coordinates)) return OVERLAP_DISJOINT;
  mp_limb_t limbs[EXACT_PAIR_LIMBS];
  ExactArena arena = {limbs, limbs + EXACT_PAIR_LIMBS};
  ExactPair pair;
  overlap_exact_pair_load(&pair, &arena, coordinates);
  if (overlap_exact_integer_sign(pair.tets[0].det) == 0 || overlap_exact_integer_sign(pair.tets[1].det) == 0)
    return OVERLAP_FLAT;
  overlap_exact_pair_find_heights(&pair, &arena);
  if (is_beyond_a_face(&pair)) return OVERLAP_DISJOINT;
  overlap_exact_pair_find_crossings(&pair, &arena);
  Boundary boundary = {.has_area = false};
  find_boundary(&boundary, &pair, &arena, answer->gradient || answer->centroid);
  if (!boundary.has_area) return OVERLAP_DISJOINT;
  *answer->volume = sum_volume(&boundary, pair.exponent);
  if (answer->gradient) sum_gradient(&boundary, &pair, answer->gradient);
  if (answer->centroid) sum_centroid(&boundary, &pair, coordinates, answer->centroid);
  return encloses(&pair.tets[0]) || encloses(&pair.tets[1]) ? OVERLAP_ENCLOSED : 0;
}

static Status eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  (void)self;
  overlap_ops_write_nothing(answer);
  *answer->flags = intersect(pair, answer);
  return STATUS_OK;
}

const OverlapOps overlap_exact_ops = {
    .name = "exact",
    .help = "exact rational arithmetic; every input, signs always right, values rounded once",
    .seconds_per_pair = 8e-6,
    .eval_pair = eval_pair,
    .has_centroid = overlap_ops_always,
};

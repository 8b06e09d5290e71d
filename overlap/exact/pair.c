// SPDX-License-Identifier: Apache-2.0
#include "overlap/exact/pair.h"

#include <limits.h>

const int overlap_exact_pair_edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
const int overlap_exact_pair_edge_of[4][4] = {{-1, 0, 1, 2}, {0, -1, 3, 4}, {1, 3, -1, 5}, {2, 4, 5, -1}};
const int overlap_exact_pair_edge_sign[6] = {1, -1, 1, 1, -1, 1};

static void subtract(ExactArena *arena, const ExactInteger x[3], const ExactInteger y[3],
                     ExactInteger difference[3]) {
  for (int c = 0; c < 3; c++) difference[c] = overlap_exact_integer_sub(arena, x[c], y[c]);
}

static int common_exponent(const double coordinates[24]) {
  int lowest = INT_MAX;
  for (int c = 0; c < 24; c++) {
    if (coordinates[c] == 0) continue;
    const int exponent = overlap_exact_integer_exponent(coordinates[c]);
    if (exponent < lowest) lowest = exponent;
  }
  return lowest == INT_MAX ? 0 : lowest;
}

// Normals of faces 1, 2, 3 meet in vertex 0: α_1(x) = [a0 x a2 a3] = (x − a0)·((a2 − a0) × (a3 − a0)), …
static void find_normals(ExactTet *tet, ExactArena *arena) {
  ExactInteger edge[4][3];
  for (int k = 1; k < 4; k++) subtract(arena, tet->vertex[k], tet->vertex[0], edge[k]);
  overlap_exact_integer_cross(arena, edge[2], edge[3], tet->normal[1]);
  overlap_exact_integer_cross(arena, edge[3], edge[1], tet->normal[2]);
  overlap_exact_integer_cross(arena, edge[1], edge[2], tet->normal[3]);
  for (int c = 0; c < 3; c++)
    tet->normal[0][c] = overlap_exact_integer_negated(overlap_exact_integer_sum(
        arena, (const ExactInteger[]){tet->normal[1][c], tet->normal[2][c], tet->normal[3][c], {0}}));
  tet->det = overlap_exact_integer_dot(arena, edge[1], tet->normal[1]);
}

// Exchanges vertices 2 and 3. That turns every normal round; those of faces 2 and 3 change places.
static void mirror(ExactTet *tet) {
  tet->order[2] = 3, tet->order[3] = 2;
  for (int c = 0; c < 3; c++) {
    const ExactInteger vertex = tet->vertex[2][c], normal = tet->normal[2][c];
    tet->vertex[2][c] = tet->vertex[3][c], tet->vertex[3][c] = vertex;
    tet->normal[0][c] = overlap_exact_integer_negated(tet->normal[0][c]);
    tet->normal[1][c] = overlap_exact_integer_negated(tet->normal[1][c]);
    tet->normal[2][c] = overlap_exact_integer_negated(tet->normal[3][c]);
    tet->normal[3][c] = overlap_exact_integer_negated(normal);
  }
  tet->det = overlap_exact_integer_negated(tet->det);
}

void overlap_exact_pair_load(ExactPair *pair, ExactArena *arena, const double coordinates[24]) {
  pair->exponent = common_exponent(coordinates);
  ExactInteger origin[3];
  for (int c = 0; c < 3; c++)
    origin[c] = overlap_exact_integer_from_double(arena, coordinates[c], pair->exponent);
  for (int t = 0; t < 2; t++) {
    ExactTet *tet = &pair->tets[t];
    for (int k = 0; k < 4; k++) {
      ExactInteger point[3];
      tet->order[k] = k;
      for (int c = 0; c < 3; c++)
        point[c] = overlap_exact_integer_from_double(arena, coordinates[12 * t + 3 * k + c], pair->exponent);
      subtract(arena, point, origin, tet->vertex[k]);
    }
    find_normals(tet, arena);
    if (overlap_exact_integer_sign(tet->det) < 0) mirror(tet);
  }
}

// The four α of a point; they sum to det.
static void find_heights_of(const ExactTet *tet, ExactArena *arena, const ExactInteger point[3],
                            ExactInteger height[4]) {
  ExactInteger offset[3];
  subtract(arena, point, tet->vertex[0], offset);
  for (int k = 1; k < 4; k++) height[k] = overlap_exact_integer_dot(arena, offset, tet->normal[k]);
  height[0] = overlap_exact_integer_sum(
      arena, (const ExactInteger[]){tet->det, overlap_exact_integer_negated(height[1]),
                                    overlap_exact_integer_negated(height[2]),
                                    overlap_exact_integer_negated(height[3])});
}

void overlap_exact_pair_find_heights(ExactPair *pair, ExactArena *arena) {
  for (int t = 0; t < 2; t++)
    for (int p = 0; p < 4; p++)
      find_heights_of(&pair->tets[t], arena, pair->tets[1 - t].vertex[p], pair->tets[t].height[p]);
}

// Nine brackets [a0 a_j b0 b_q] = (a_j − a0)·((b0 − a0) × (b_q − b0)) and the heights give the other 27: for
// five points of weight 1 the alternating sum of the brackets that leave one out is 0. With a0 a_i a_j b_p
// b_q that is
//     [a_i a_j b_p b_q] = [a0 a_j b_p b_q] − [a0 a_i b_p b_q] + [a0 a_i a_j b_q] − [a0 a_i a_j b_p],
// the last two being ±α_k of b_q and b_p, and the like with a_i a_j b_0 b_p b_q.
static ExactInteger close_first(const ExactPair *pair, ExactArena *arena, int i, int j, int f) {
  const int k = 6 - i - j, p = overlap_exact_pair_edge_ends[f][0], q = overlap_exact_pair_edge_ends[f][1];
  const ExactTet *a = &pair->tets[0];
  const int sign = k % 2 ? 1 : -1; // a_k goes from the last place to its own
  return overlap_exact_integer_sum(
      arena,
      (const ExactInteger[]){pair->cross[j - 1][f], overlap_exact_integer_negated(pair->cross[i - 1][f]),
                             overlap_exact_integer_signed(a->height[q][k], sign),
                             overlap_exact_integer_signed(a->height[p][k], -sign)});
}

static ExactInteger close_second(const ExactPair *pair, ExactArena *arena, int e, int p, int q) {
  const int l = 6 - p - q, i = overlap_exact_pair_edge_ends[e][0], j = overlap_exact_pair_edge_ends[e][1];
  const ExactTet *b = &pair->tets[1];
  const int sign = l % 2 ? -1 : 1; // b_l goes from the first place to its own
  return overlap_exact_integer_sum(
      arena,
      (const ExactInteger[]){pair->cross[e][q - 1], overlap_exact_integer_negated(pair->cross[e][p - 1]),
                             overlap_exact_integer_signed(b->height[i][l], sign),
                             overlap_exact_integer_signed(b->height[j][l], -sign)});
}

void overlap_exact_pair_find_crossings(ExactPair *pair, ExactArena *arena) {
  const ExactTet *a = &pair->tets[0], *b = &pair->tets[1];
  for (int q = 1; q < 4; q++) {
    ExactInteger edge[3], moment[3];
    subtract(arena, b->vertex[q], b->vertex[0], edge);
    overlap_exact_integer_cross(arena, b->vertex[0], edge, moment);
    for (int j = 1; j < 4; j++)
      pair->cross[j - 1][q - 1] = overlap_exact_integer_dot(arena, a->vertex[j], moment);
  }
  for (int e = 0; e < 3; e++)
    for (int f = 3; f < 6; f++)
      pair->cross[e][f] = close_second(pair, arena, e, overlap_exact_pair_edge_ends[f][0],
                                       overlap_exact_pair_edge_ends[f][1]);
  for (int e = 3; e < 6; e++)
    for (int f = 0; f < 6; f++)
      pair->cross[e][f] =
          close_first(pair, arena, overlap_exact_pair_edge_ends[e][0], overlap_exact_pair_edge_ends[e][1], f);
}

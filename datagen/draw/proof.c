// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/draw/proof.h"

#include "overlap/exact/pair.h"

// Which of the eight planes (0–3 of the first tetrahedron, 4–7 of the second, each opposite to the vertex of
// that number) pass through every vertex of P seen so far.
typedef struct Common {
  unsigned planes; // bits
  bool is_empty;   // no vertex yet
} Common;

static void add_vertex(Common *common, unsigned planes) {
  common->planes &= planes;
  common->is_empty = false;
}

// All of one lies strictly beyond a face of the other: what most disjoint pairs show.
static bool has_separating_face(const ExactPair *pair) {
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < 4; k++) {
      int beyond = 0;
      for (int p = 0; p < 4; p++) beyond += overlap_exact_integer_sign(pair->tets[t].height[p][k]) < 0;
      if (beyond == 4) return true;
    }
  return false;
}

// Vertex v of tetrahedron t, if it lies in the other.
static void see_vertex(Common *common, const ExactPair *pair, int t, int v) {
  unsigned planes = (0xfu ^ (1u << v)) << (4 * t);
  for (int k = 0; k < 4; k++) {
    int side = overlap_exact_integer_sign(pair->tets[1 - t].height[v][k]);
    if (side < 0) return;
    if (side == 0) planes |= 1u << (4 * (1 - t) + k);
  }
  add_vertex(common, planes);
}

// The sign of the permutation (ends of the edge opposite to mn, m, n).
static int parity(int m, int n) {
  return overlap_exact_pair_edge_sign[5 - overlap_exact_pair_edge_of[m][n]] * (m < n ? 1 : -1);
}

// The inner point where edge e = ij of tetrahedron t crosses plane k of the other, if it lies in the other:
// by Cramer's rule its height over plane m has the sign of (β_k(j) − β_k(i)) ε [a_i a_j b_p b_q], p q the two
// others of m, k.
static void see_crossing(Common *common, const ExactPair *pair, int t, int e, int k) {
  const ExactTet *other = &pair->tets[1 - t];
  const int i = overlap_exact_pair_edge_ends[e][0], j = overlap_exact_pair_edge_ends[e][1];
  const int from = overlap_exact_integer_sign(other->height[i][k]),
            to = overlap_exact_integer_sign(other->height[j][k]);
  if (from * to >= 0) return;
  unsigned planes = (0xfu ^ (1u << i) ^ (1u << j)) << (4 * t) | 1u << (4 * (1 - t) + k);
  for (int m = 0; m < 4; m++) {
    if (m == k) continue;
    const int other_edge = 5 - overlap_exact_pair_edge_of[m][k];
    const ExactInteger bracket = t == 0 ? pair->cross[e][other_edge] : pair->cross[other_edge][e];
    const int side = overlap_exact_integer_sign(bracket) * to * parity(m, k);
    if (side < 0) return;
    if (side == 0) planes |= 1u << (4 * (1 - t) + m);
  }
  add_vertex(common, planes);
}

static Common find_common(const ExactPair *pair) {
  Common common = {.planes = 0xff, .is_empty = true};
  for (int t = 0; t < 2; t++) {
    for (int v = 0; v < 4; v++) see_vertex(&common, pair, t, v);
    for (int e = 0; e < 6; e++)
      for (int k = 0; k < 4; k++) see_crossing(&common, pair, t, e, k);
  }
  return common;
}

static bool is_zero(const ExactInteger x[3]) {
  return !overlap_exact_integer_sign(x[0]) && !overlap_exact_integer_sign(x[1]) &&
         !overlap_exact_integer_sign(x[2]);
}

// Of integer vectors that are not zero.
static int rank_of(ExactArena *arena, const ExactInteger *const *vectors, int count) {
  if (count == 0) return 0;
  ExactInteger plane[3];
  int rank = 1;
  for (int i = 1; i < count && rank < 3; i++) {
    if (rank == 2) {
      if (overlap_exact_integer_sign(overlap_exact_integer_dot(arena, plane, vectors[i]))) rank = 3;
      continue;
    }
    overlap_exact_integer_cross(arena, vectors[0], vectors[i], plane);
    if (!is_zero(plane)) rank = 2;
  }
  return rank;
}

static int rank_of_planes(const ExactPair *pair, ExactArena *arena, unsigned planes) {
  const ExactInteger *normals[8];
  int count = 0;
  for (int k = 0; k < 8; k++)
    if (planes >> k & 1) normals[count++] = pair->tets[k / 4].normal[k % 4];
  return rank_of(arena, normals, count);
}

static int count_bits(unsigned bits) {
  int count = 0;
  for (; bits; bits &= bits - 1) count++;
  return count;
}

DatagenProof datagen_proof_of(const double coordinates[24]) {
  static const DatagenProof disjoint = {.dimension = -1, .carrier = {3, 3}};
  mp_limb_t limbs[EXACT_PAIR_LIMBS];
  ExactArena arena = {limbs, limbs + EXACT_PAIR_LIMBS};
  ExactPair pair;
  overlap_exact_pair_load(&pair, &arena, coordinates);
  if (!overlap_exact_integer_sign(pair.tets[0].det) || !overlap_exact_integer_sign(pair.tets[1].det))
    return (DatagenProof){.dimension = -1, .carrier = {3, 3}, .is_flat = true};
  overlap_exact_pair_find_heights(&pair, &arena);
  if (has_separating_face(&pair)) return disjoint;
  overlap_exact_pair_find_crossings(&pair, &arena);
  Common common = find_common(&pair);
  if (common.is_empty) return disjoint;
  return (DatagenProof){.dimension = 3 - rank_of_planes(&pair, &arena, common.planes),
                        .carrier = {3 - count_bits(common.planes & 0xf), 3 - count_bits(common.planes >> 4)}};
}

bool datagen_proof_confirms(const DatagenProof *proof, DatagenKind kind) {
  const DatagenKindInfo *info = datagen_kind_info((int)kind);
  if (!info || proof->is_flat) return false;
  if (kind == DATAGEN_CAPTURED) return true;
  return proof->dimension == info->dimension && proof->carrier[0] == info->carrier[0] &&
         proof->carrier[1] == info->carrier[1];
}

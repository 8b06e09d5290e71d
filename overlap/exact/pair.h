// SPDX-License-Identifier: Apache-2.0
// A pair of tetrahedra as integers, with the 68 brackets [w x y z] = det(x − w, y − w, z − w) that decide
// everything about their intersection: 16 + 16 vertices against face planes and 36 edges against edges. All
// three are of degree 3 in the coordinates. That they suffice is Cramer's rule. Let α_k(x) = [a with a_k
// replaced by x], which is D times the barycentric coordinate k of x in the tetrahedron a. So α_k(x) ≥ 0 on
// the inner side of face k, which lies opposite to a_k. With complementary pairs (i j), (m n) and ε the sign
// of the permutation (i j m n),
//
//     α_m(p) α_n(q) − α_n(p) α_m(q) = ε D [a_i a_j p q].
//
// So a point where an edge meets a face has barycentric coordinates made of brackets alone (polygon.c).
#ifndef TETLAP_OVERLAP_EXACT_PAIR_H
#define TETLAP_OVERLAP_EXACT_PAIR_H

#include "overlap/exact/integer.h"

// Limbs that a pair and the polygons of one face at a time can need. From 2^-1074 to 2^1024 a coordinate
// takes 34; 102 numbers of degree 1, 39 of degree 2 (68) and 140 of degree 3 (102) make 20400, a polygon's
// weights and one triangle's products (degree 9: 306) at most 4000 more. Ordinary pairs use the first few
// hundred.
enum { EXACT_PAIR_LIMBS = 26000 };

// Edges 0 … 5 of a tetrahedron are 01 02 03 12 13 23; 5 − e is opposite to e.
extern const int overlap_exact_pair_edge_ends[6][2];
extern const int overlap_exact_pair_edge_of[4][4]; // of two vertices; −1 on the diagonal
extern const int overlap_exact_pair_edge_sign[6];  // of the permutation (ends of e, ends of 5 − e)

typedef struct ExactTet {
  int order[4];              // vertex i here is vertex order[i] of the caller's: makes det ≥ 0
  ExactInteger vertex[4][3]; // relative to vertex 0 of the first tetrahedron [unit]
  ExactInteger normal[4][3]; // of face k, inward, twice its area: α_k(x) = normal_k·x + const [unit²]
  ExactInteger det;          // six times the volume [unit³]
  ExactInteger height[4][4]; // [p][k]: α_k of the other tetrahedron's vertex p [unit³]
} ExactTet;

typedef struct ExactPair {
  int exponent; // unit = 2^exponent m
  ExactTet tets[2];
  ExactInteger cross[6]
                    [6]; // [e][f]: [a_i a_j b_p b_q], edge e = ij of the first, f = pq of the second [unit³]
} ExactPair;

// In three steps, so that a caller can stop early. The numbers live in the arena.
// 1. Vertices, normals, det; orientation made positive.
void overlap_exact_pair_load(ExactPair *pair, ExactArena *arena, const double coordinates[24]);
// 2. Heights; both det must be positive.
void overlap_exact_pair_find_heights(ExactPair *pair, ExactArena *arena);
// 3. Edges against edges.
void overlap_exact_pair_find_crossings(ExactPair *pair, ExactArena *arena);

#endif

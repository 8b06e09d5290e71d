// SPDX-License-Identifier: GPL-3.0-or-later
// What two closed tetrahedra have in common, proven in integer arithmetic: the dimension of their
// intersection P, and on which face of each it lies.
//
// P is a polytope cut out by eight half-spaces. Each of its vertices is a vertex of one tetrahedron, or the
// point where an edge of one crosses a plane of the other. The signs of the 68 brackets of
// overlap/exact/pair.h name all of them, and say which of the eight planes pass through each. The planes
// through every vertex are those that hold all of P. If their normals have rank r, P has dimension 3 − r. If
// c of them are of one tetrahedron, P lies in a face of it of dimension 3 − c and in none smaller.
#ifndef TETLAP_DATAGEN_DRAW_PROOF_H
#define TETLAP_DATAGEN_DRAW_PROOF_H

#include <stdbool.h>

#include "datagen/law/kind.h"

typedef struct DatagenProof {
  int dimension;  // of P: −1 (empty), 0 … 3
  int carrier[2]; // dimension of the smallest face of either that holds P, 0 … 3; 3 and 3 if P is empty
  bool is_flat;   // a tetrahedron has no volume: nothing else is said
} DatagenProof;

// The coordinates are taken as the rational numbers that they are; finite ones only. About 5 µs and 230 kB of
// stack, no other memory.
DatagenProof datagen_proof_of(const double pair[24]);

// Whether the proof confirms what the kind claims. CAPTURED claims only that neither is flat.
bool datagen_proof_confirms(const DatagenProof *proof, DatagenKind kind);

#endif

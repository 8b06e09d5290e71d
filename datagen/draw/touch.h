// SPDX-License-Identifier: GPL-3.0-or-later
// Candidates for pairs that touch: strategies 2 to 4 of the paper (TetrahedronPairNet, section 2.1) and the
// three that it misses. All vertices are in the unit cube. A candidate is built to touch in exact numbers.
// Whether it is what its kind claims is for datagen_proof_confirms to say: the edge may not reach the face,
// and rounding may have moved the free vertices across a plane.
//
// Why touching survives rounding to double. The first tetrahedron's vertices a_i are whole multiples of
// 2⁻²⁴, uniform in the cube. A contact point is p = Σ k_i a_i / 2²⁴ with whole k_i that sum to 2²⁴: a whole
// multiple of 2⁻⁴⁸ between 0 and 1, so a double holds it exactly and p lies exactly on the edge or in the
// plane. The points of a crossing edge are p ± k d / 2²⁴ with d whole multiples of 2⁻²⁴. Nothing else has to
// be exact, and the free vertices are ordinary doubles.
//
// The free vertices: points at distance r from the contact (its point, the edge's middle, the face's
// centroid), r uniform in (0, 1). The direction is uniform on the hemisphere n·d > 1e-16 about the outward
// normal n. Both are drawn again until the point is in the cube. For kinds 6 to 8, n is a random positive
// combination of the outward unit normals of the faces that meet at the vertex or edge: any plane that
// touches the first tetrahedron there and nowhere else may be the separating one.
#ifndef TETLAP_DATAGEN_DRAW_TOUCH_H
#define TETLAP_DATAGEN_DRAW_TOUCH_H

#include <stdbool.h>

#include "base/random.h"
#include "datagen/law/kind.h"

// One attempt at a touching kind; false: it failed, try again. In no particular order of vertices:
// shuffle them.
bool datagen_touch_try(DatagenKind kind, Random *random, double pair[24]);

#endif

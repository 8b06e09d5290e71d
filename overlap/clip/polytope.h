// SPDX-License-Identifier: Apache-2.0
// The intersection of two tetrahedra as a closed polyhedron, by clipping one with the other's planes in
// double precision.
//
// Each vertex of the polyhedron is eight numbers: its barycentric coordinates in A (lanes 0–3) and in B
// (lanes 4–7). Lane f is zero on plane f and positive inside. So the distances that clipping needs are
// already there, and a cut is a convex combination of lanes. What lies on a plane has an exact zero in its
// lane.
//
//        q                     One record per edge, walked from → to with the polyhedron's face `left` on one
//        ^   left: plane f     side and `right` on the other: every edge is in two faces, in opposite
//        |                     directions. A plane that cuts an edge ends it there. Each old face that is cut
//   ─────r───── plane k        is left once and entered once by the walk around it, and the new edge joins
//        |   right: plane g    the two; on the other side of that edge lies the new face k. No face is ever
//        p                     stored as a loop: all that is asked of it are sums over its edges.
//
// So the surface stays closed whatever the signs of distances that are only rounding: touching, coplanar,
// identical and nested tetrahedra take the same path, and an error of the distances of ε moves the faces by
// ε.
#ifndef TETLAP_OVERLAP_CLIP_POLYTOPE_H
#define TETLAP_OVERLAP_CLIP_POLYTOPE_H

#include <float.h>
#include <stdint.h>

#include "base/vec3.h"
#include "overlap/clip/constants.h"
#include "overlap/clip/polytope_types.h"

OverlapClipOutcome overlap_clip_polytope_make(OverlapClipPolytope *polytope, const double pair[24]);

#endif

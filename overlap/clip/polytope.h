// SPDX-License-Identifier: Apache-2.0
// The intersection of two tetrahedra as a closed polyhedron, by clipping one with the other's planes in
// double precision.
//
// Each vertex of the polyhedron is eight numbers: its barycentric coordinates in A (lanes 0–3) and in B
// (lanes 4–7). Lane f is zero on plane f and positive inside, so the distances that clipping needs are
// already there, a cut is a convex combination of lanes, and what lies on a plane has an exact zero in its
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

// Every vertex ends three edges. A cut with c crossings, at most one an edge, replaces the c or more ends
// outside (each ends three edges: at least c/3 vertices) by c new vertices: 4 vertices become at most 8, 16,
// 32,
// 64. With e = 3/2 v edges: at most 96 edges, and at most 4 + 6 + 12 + 24 + 48 = 94 vertices made in all.
enum { OVERLAP_CLIP_VERTICES = 96, OVERLAP_CLIP_EDGES = 96 };

// A tetrahedron's planes.
typedef struct OverlapClipFrame {
  Vec3 normal[4];     // det · ∇λ_f [m²]; the outward area vector of face f is −½ sign(det) normal[f]
  double det;         // six times the signed volume [m³]
  double inverse_det; // [1/m³]
} OverlapClipFrame;

typedef struct OverlapClipEdge {
  uint8_t from, to;    // vertices
  uint8_t left, right; // planes: 0–3 of A, 4–7 of B
} OverlapClipEdge;

typedef struct OverlapClipPolytope {
  OverlapClipFrame frame[2];
  int subject;  // the tetrahedron that was clipped, 0 or 1: edges turn outward as seen in its barycentric
                // space
  double noise; // what rounding may do to det · λ of any vertex in any plane [m³]
  int vertex_count, edge_count;
  OverlapClipEdge edge[OVERLAP_CLIP_EDGES];
  double origin[8];                        // what vertices are relative to; zero at first
  double vertex[OVERLAP_CLIP_VERTICES][8]; // some of them belong to no edge any more
} OverlapClipPolytope;

typedef enum OverlapClipOutcome {
  OVERLAP_CLIP_DISJOINT,  // no common interior, beyond doubt or but for less than 1e-12 of the smaller volume
  OVERLAP_CLIP_OVERLAP,   // the polytope is there, its volume may still come out as zero
  OVERLAP_CLIP_ENCLOSED,  // the same, and it is one of the two, whole
  OVERLAP_CLIP_UNCERTAIN, // a tetrahedron is so flat that double precision cannot tell
} OverlapClipOutcome;

OverlapClipOutcome overlap_clip_polytope_make(OverlapClipPolytope *polytope, const double pair[24]);

#endif

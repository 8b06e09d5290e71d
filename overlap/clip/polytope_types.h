// SPDX-License-Identifier: Apache-2.0
// The polyhedron of polytope.h as data. Part of what devices compile, so it includes nothing; Vec3 is known.
#ifndef TETLAP_OVERLAP_CLIP_POLYTOPE_TYPES_H
#define TETLAP_OVERLAP_CLIP_POLYTOPE_TYPES_H

// Every vertex ends three edges, so v vertices have e = 3/2 v edges. A cut with c crossings, at most one an
// edge, replaces the vertices outside, at least c/3 of them, by c new ones: 4 vertices become at most 8, 16,
// 32, 64. So there are at most 96 edges, and 4 + 6 + 12 + 24 + 48 = 94 vertices are made at most.
enum { OVERLAP_CLIP_VERTICES = 96, OVERLAP_CLIP_EDGES = 96 };

// A tetrahedron's planes.
typedef struct OverlapClipFrame {
  Vec3 normal[4];     // det · ∇λ_f [m²]; the outward area vector of face f is −½ sign(det) normal[f]
  double det;         // six times the signed volume [m³]
  double inverse_det; // [1/m³]
} OverlapClipFrame;

typedef struct OverlapClipEdge {
  unsigned char from, to;    // vertices
  unsigned char left, right; // planes: 0–3 of A, 4–7 of B
} OverlapClipEdge;

typedef struct OverlapClipPolytope {
  OverlapClipFrame frame[2];
  int subject;     // the tetrahedron that was clipped, 0 or 1; in its barycentric space edges turn outward
  double own[2];   // L_A², L_B² of clip.h [m²]
  double noise[2]; // ν_A, ν_B: what rounding may do to det · λ of any vertex in any plane of A, of B [m³]
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

// What the gradient and the Hessian share: φ_f and m_fa of all eight faces.
typedef struct OverlapClipMoments {
  double fraction[8];  // φ_f
  double moment[8][4]; // m_fa, a the vertex of face f's own tetrahedron; 0 for the vertex that is not in it
} OverlapClipMoments;

#endif

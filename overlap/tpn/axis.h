// SPDX-License-Identifier: Apache-2.0
// The axis that separates two tetrahedra best, of those of the separating axis theorem (S. Gottschalk,
// M. C. Lin, D. Manocha, OBBTree, SIGGRAPH 1996; C. Ericson, Real-Time Collision Detection, 2005, ch. 5): two
// convex polyhedra are disjoint if and only if their projections are so on a normal of a face or on the cross
// product of an edge of each.
//
// The reach of an axis is the overlap of the two projected intervals over the sum of their widths: below 0,
// the axis separates. It does not change under affine maps, nor with the order of the two. So all is found
// from the barycentric coordinates λ of one tetrahedron's vertices in the other:
//
//   face k    λ_k is 0 on the face and 1 at the vertex opposite; the other's interval is that of its λ_k.
//   edges     With d the change of λ along the other's edge, h = λ_r d_s − λ_s d_r is 0 on the edge between
//             the other two vertices than r and s, and constant along the other's edge. h(r) = d_s,
//             h(s) = −d_r. The edge supports its tetrahedron if these are not on two sides of 0; the other's
//             edge likewise. Only where both do, on the sides that face each other, the axis counts.
#ifndef TETLAP_OVERLAP_TPN_AXIS_H
#define TETLAP_OVERLAP_TPN_AXIS_H

#include <stdbool.h>

// One of the two tetrahedra, and the other in its coordinates.
typedef struct OverlapTpnAxisSide {
  bool stands;         // it is not flat; else nothing below is valid
  double lambda[4][4]; // [b][k]: of the other's vertex b, the barycentric coordinate of vertex k
  double det;          // |det E|
} OverlapTpnAxisSide;

typedef struct OverlapTpnAxis {
  bool is_edges;
  double reach;
  int tet;        // whose face it is; of edges, `larger`
  int face;       // of a face: the vertex opposite to it
  int edge[2][4]; // of edges: of each tetrahedron the edge's two vertices, then the other two, the one nearer
                  // to the plane along both edges first
} OverlapTpnAxis;

// That of least reach. `larger` (0 or 1) is the tetrahedron that stands and whose frame is used for edges;
// where faces of both have the same reach to 1e-9, its face counts. Edges count where they have less than
// every face by more than 1e-9.
OverlapTpnAxis overlap_tpn_axis_find(const OverlapTpnAxisSide sides[2], int larger);

#endif

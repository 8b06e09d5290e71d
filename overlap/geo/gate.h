// SPDX-License-Identifier: Apache-2.0
// Whether two tetrahedra intersect, and a point inside the intersection if they do: the first step of the
// overlap model `geo`.
//
// Plane k of a pair is where one barycentric coordinate vanishes, of the first tetrahedron for k = 0 … 3, of
// the second for k = 4 … 7; its slack s_k at a point is that coordinate. The twelve edges are clipped with
// the other tetrahedron's planes. Every vertex of the intersection is an end of a clipped edge, so the mean
// of all ends lies strictly inside; and a point on an edge is a combination of slacks at the edge's ends,
// which loses no digits where the intersection is small.
//
// What counts is how far a point is from a plane, never its place along an edge: an edge as good as parallel
// to a plane may cross it anywhere, by rounding alone. So an edge has ends if the planes, moved out by noise
// (below), leave any of it. Then all vertices of the intersection, which rounding moves by less, are kept, up
// to noise; and if the mean of the at most 24 ends is on a plane, none is farther above it than some 24 times
// noise: so much of a tetrahedron's height is what an overlap that is called EMPTY may have.
#ifndef TETLAP_OVERLAP_GEO_GATE_H
#define TETLAP_OVERLAP_GEO_GATE_H

#include <stdbool.h>

#include "overlap/geo/constants.h"
#include "overlap/geo/lanes.h"

typedef enum OverlapGeoOutcome {
  OVERLAP_GEO_INSIDE, // they intersect, everything asked for is there
  OVERLAP_GEO_EMPTY,  // no common interior, down to rounding: V = 0
  OVERLAP_GEO_UNFIT,  // to be answered by the exact model: too flat, or numbers that cannot be trusted
} OverlapGeoOutcome;

typedef struct OverlapGeoGate {
  GeoColumns normal;       // ∇ of the slacks [1/m]
  double slack[GEO_LANES]; // at a point inside; each tetrahedron's four sum to 1
  double across[2][4][4];  // [t][v][k]: barycentric coordinate k, in the other, of vertex v of t
  double least_volume;     // of the two tetrahedra [m³]
  bool is_enclosed;        // all vertices of one are in the other, but for rounding
} OverlapGeoGate;

// With EMPTY only normal and across, with UNFIT nothing is valid.
OverlapGeoOutcome overlap_geo_gate(OverlapGeoGate *gate, const double pair[24]);

#endif

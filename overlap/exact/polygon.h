// SPDX-License-Identifier: Apache-2.0
// The part of a tetrahedron's face that lies in another tetrahedron: a convex polygon, cut out of the face by
// the other's four planes (Sutherland and Hodgman 1974). No coordinate is ever constructed while cutting: a
// corner is a name (a vertex; an own edge and the other's plane; the other's edge and the own plane), and on
// which side of a plane it lies is the sign of a bracket or of a height (pair.h). So zeros are zeros,
// a polygon of three corners or more has an area, and one that is a point or a segment has fewer.
#ifndef TETLAP_OVERLAP_EXACT_POLYGON_H
#define TETLAP_OVERLAP_EXACT_POLYGON_H

#include <stdbool.h>

#include "overlap/exact/pair.h"

typedef enum ExactCornerKind {
  EXACT_CORNER_VERTEX,     // of the own tetrahedron
  EXACT_CORNER_OWN_EDGE,   // crosses a plane of the other
  EXACT_CORNER_OTHER_EDGE, // crosses the plane of the face
} ExactCornerKind;

typedef struct ExactCorner {
  ExactCornerKind kind;
  int vertex; // VERTEX: which
  int edge;   // OWN_EDGE, OTHER_EDGE: of that tetrahedron
  int plane;  // OWN_EDGE: of the other tetrahedron
  int turn;   // OWN_EDGE, OTHER_EDGE: sign of the homogeneous weight as the formulas give it
} ExactCorner;

enum { EXACT_POLYGON_CORNERS = 8 }; // a triangle cut four times has seven

typedef struct ExactPolygon {
  const ExactPair *pair; // borrowed
  int own;               // the tetrahedron (0, 1) that the face belongs to
  int face;              // opposite to its vertex of that number
  int count;             // below 3: no area
  ExactCorner corners[EXACT_POLYGON_CORNERS];
  int lines[EXACT_POLYGON_CORNERS]; // what runs from corner t to t + 1: plane 0 … 3 of the other, 4 + own
                                    // edge
} ExactPolygon;

// Relative to the face: of its area, and of its area times N_i, the face's linear function that is 1 at
// vertex i. moment[face] is 0 and the moments sum to the area.
typedef struct ExactMoments {
  long double area;
  long double moment[4];
} ExactMoments;

void overlap_exact_polygon_cut(ExactPolygon *polygon, const ExactPair *pair, int own, int face);

// All terms are non-negative integer quotients: relative error of a few 2^-62. Without moments those stay 0.
ExactMoments overlap_exact_polygon_measure(const ExactPolygon *polygon, ExactArena *arena, bool with_moments);

// How high the first corner lies over the planes, as α of pair.h: height[own or other][plane], all ≥ 0
// [unit³].
void overlap_exact_polygon_lift(const ExactPolygon *polygon, ExactArena *arena, long double height[2][4]);

#endif

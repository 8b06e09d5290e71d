// SPDX-License-Identifier: Apache-2.0
// Planes that nearly coincide, as coplanar.h has them. Its text is also part of what a device compiles: it
// includes nothing.
#ifndef TETLAP_OVERLAP_GEO_COPLANAR_TYPES_H
#define TETLAP_OVERLAP_GEO_COPLANAR_TYPES_H

// Planes of a tetrahedron; pairs of planes across, on two sides.
enum { OVERLAP_GEO_ACROSS = 4, OVERLAP_GEO_MOST_CLOSE = 4 * 4 * 2 };

// Two planes that nearly coincide.
typedef struct OverlapGeoClose {
  int k, l;
  double side;                  // −1: they look the same way, +1: at each other
  double ratio;                 // r_kl
  double share, slope, bending; // w_kl and its first two derivatives by r_kl
} OverlapGeoClose;

typedef struct OverlapGeoCoplanar {
  int count; // 0 as a rule
  OverlapGeoClose close[OVERLAP_GEO_MOST_CLOSE];
  double share; // w
} OverlapGeoCoplanar;

#endif

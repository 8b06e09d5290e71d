// SPDX-License-Identifier: Apache-2.0
// Arithmetic on eight numbers at a time, one for each plane of a pair: 0–3 the faces of the first
// tetrahedron, 4–7 those of the second. Loops of fixed length that a compiler turns into vectors; sums are
// taken in a fixed order, so that every instruction set gives the same bits.
#ifndef TETLAP_OVERLAP_GEO_LANES_H
#define TETLAP_OVERLAP_GEO_LANES_H

enum { GEO_LANES = 8 };

typedef struct GeoMatrix {
  double row[GEO_LANES][GEO_LANES];
} GeoMatrix;

// Three numbers for each plane: a vector by component, or the columns of an 8 × 3 matrix.
typedef struct GeoColumns {
  double column[3][GEO_LANES];
} GeoColumns;

static inline double geo_sum(const double x[GEO_LANES]) {
  double part[4];
  for (int l = 0; l < 4; l++) part[l] = x[l] + x[l + 4];
  return (part[0] + part[2]) + (part[1] + part[3]);
}

static inline double geo_dot(const double x[GEO_LANES], const double y[GEO_LANES]) {
  double product[GEO_LANES];
  for (int l = 0; l < GEO_LANES; l++) product[l] = x[l] * y[l];
  return geo_sum(product);
}

// y += a x
static inline void geo_add(double y[GEO_LANES], double a, const double x[GEO_LANES]) {
  for (int l = 0; l < GEO_LANES; l++) y[l] += a * x[l];
}

#endif

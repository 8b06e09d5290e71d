// SPDX-License-Identifier: Apache-2.0
// Normalisations of a pair before a network sees it (TetrahedronPairNet, table 2), and the way back of a
// gradient through them.
//
//   pca   rigid: the first tetrahedron's centroid becomes the origin, its principal axes the coordinate axes,
//         the largest principal value first. Along the first two axes the sum of the vertices' cubed
//         coordinates is not negative, the third completes a right-handed system. V' = V.
//   unit  affine: the first tetrahedron becomes the unit simplex (its vertices in their order the origin and
//         the unit vectors). V' = V / |det E|, E the matrix of its edges from the first vertex.
//   unscaled  unit, but V' = V: the network is left to tell the volume of the pair as it was, of which only
//         the image is shown. No function of its input: pairs with the same image have other volumes.
//   sorted  unit, with the vertices of both in an order that does not depend on how they came: the first's
//         by its barycentric coordinates of the other's centroid, the largest first; then the other's by
//         their barycentric coordinate of the first's first vertex. Coordinates beyond 3 are compressed: ±3
//         (1 + ln(|x|/3)), so that a flat first tetrahedron gives no huge numbers.
//   axis  as sorted, but the order of the two tetrahedra does not depend on how they came, either. Of the
//         axes that can separate the two, the one of least reach (overlap/tpn/axis.h) decides.
//           A face: its tetrahedron comes first, the vertex opposite to the face as its last one, the others
//         as in sorted; the other's vertices are in the order of their coordinate of that vertex, the largest
//         first. So the face is the plane x₃ = 0, and the fifth vertex has the greatest x₃.
//           Two edges: the larger tetrahedron comes first. Its edge's ends, as in sorted, come before the
//         other two, the nearer to the plane along both edges first: that plane is x₃ + slope x₂ = 0 with
//         0 ≤ slope ≤ 1. Of the other, the edge's ends come first, by rising x₂, then the nearer of the other
//         two. x₃ + slope x₂, the height, takes the place of x₃: again 0 on a plane that supports the first,
//         and greatest at the fifth vertex. The sixth has the same and is given that plus the slope: so the
//         sixth above the fifth says that it is edges, and by how much, the slope.
//           In both cases the axis separates if the fifth vertex's x₃ is not positive. Of equally large ones
//         (|det E| equal to 1e-9), the larger is that with the greatest vertex, by x, then y, then z. A flat
//         one does not come first.
//
// The paper has the first two, the code that its authors published trains the third. The last two are ours: a
// network on them cannot tell the order of vertices, and learns one twenty-fourth of the cases twice over;
// on the last it cannot tell the order of the two, either, and whether they are disjoint is the sign of one
// number. Where two values that decide are equal, its value jumps.
//
// All are functions of the pair: a network's V = factor · V'(normalised) has a gradient that goes through
// them, including the turning of the axes. A principal axis turns by D_ij / (λ_j − λ_i), D the change of the
// second moment in the axes' frame, which has no bound as values get equal, and there the axes jump: that is
// the normalisation's own defect. 1/Δ is replaced by Δ/(Δ² + (1e-6 tr λ)²): the exact derivative while the
// values differ, and with equal values the axes within their plane count as fixed.
#ifndef TETLAP_OVERLAP_TPN_NORMALISE_H
#define TETLAP_OVERLAP_TPN_NORMALISE_H

#include <stdbool.h>

typedef enum OverlapTpnNormalisation {
  OVERLAP_TPN_NORMALISE_UNIT,
  OVERLAP_TPN_NORMALISE_PCA,
  OVERLAP_TPN_NORMALISE_SORTED,
  OVERLAP_TPN_NORMALISE_UNSCALED,
  OVERLAP_TPN_NORMALISE_AXIS,
  OVERLAP_TPN_NORMALISE_COUNT,
} OverlapTpnNormalisation;

typedef struct OverlapTpnNormalised {
  OverlapTpnNormalisation kind;
  double pair[24];  // the normalised pair
  double factor;    // V = factor · V'
  double matrix[9]; // normalised = matrix · (x − origin), row-major
  double origin[3];
  double principal[3]; // pca: principal values, falling
  double slope, run; // axis, of two edges: of the plane along both, change of x₂ along the second's; run 0:
                     // of a face
  int order[8]; // sorted, axis: which of the pair's eight vertices stands in each place
} OverlapTpnNormalised;

// False: the first tetrahedron is too flat for it (all but pca: |det E| below 1e-14 of the edges'
// product; of axis, both are), or what the network would be shown is not finite.
bool overlap_tpn_normalise(OverlapTpnNormalisation kind, const double pair[24],
                           OverlapTpnNormalised *normalised);

// ∇ of factor · V' with respect to the pair, from V' and ∇V' with respect to the normalised pair.
void overlap_tpn_normalise_pull(const OverlapTpnNormalised *normalised, double volume, const double inner[24],
                                double gradient[24]);

// The first tetrahedron of all normalised pairs (12), NULL where it depends on the pair.
const double *overlap_tpn_normalise_first(OverlapTpnNormalisation kind);

// Of `unit`, whose V' is a function of the second tetrahedron's normalised coordinates alone: of an
// s(normalised) with derivatives inner (24, of which the last 12 count) and inner_hessian (12, 12), those
// with respect to the pair, (24) and (24, 24); without the factor.
void overlap_tpn_normalise_bend_unit(const OverlapTpnNormalised *normalised, const double inner[24],
                                     const double inner_hessian[144], double gradient[24],
                                     double hessian[576]);

const char *overlap_tpn_normalise_name(OverlapTpnNormalisation kind); // "unit", "pca", …

#endif

// SPDX-License-Identifier: Apache-2.0
// Second derivatives along half of the directions are enough. An affine map of all space by 1 + B changes the
// gradient of log V at x_i, and that of any function of P, by −Bᵀ times itself. A step of one vertex of one
// tetrahedron is such a map but for the vertices of the other. So only the vertices of one tetrahedron are
// moved one by one: of the one whose vertices have the smaller barycentric coordinates in the other.
#ifndef TETLAP_OVERLAP_GEO_HESSIAN_H
#define TETLAP_OVERLAP_GEO_HESSIAN_H

#include "overlap/geo/bundle/bundle.h"
#include "overlap/geo/frame.h"
#include "overlap/ops.h"

// The tetrahedron that is moved.
int overlap_geo_hessian_moved(const OverlapGeoFrame *frame);

// Given the columns of the moved tetrahedron in hessian (24, 24) and the gradient (24), fills in the others
// and makes it symmetric.
void overlap_geo_hessian_complete(const OverlapGeoFrame *frame, int moved, const double *gradient,
                                  double *hessian);

#endif

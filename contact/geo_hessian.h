// SPDX-License-Identifier: GPL-3.0-or-later
// The second derivative of log V. Twelve of the 24 directions need no work: an affine map of all space by
// 1 + B changes ∂ log V/∂x_i by −Bᵀ ∂ log V/∂x_i and V's invariants not at all. A step of one vertex of one
// tetrahedron is such a map but for the vertices of the other. So only the vertices of one tetrahedron are
// moved one by one: of the one whose vertices have the smaller barycentric coordinates in the other.
#ifndef TETLAP_CONTACT_GEO_HESSIAN_H
#define TETLAP_CONTACT_GEO_HESSIAN_H

#include "contact/geo.h"

enum { CONTACT_GEO_DIRECTIONS = 12 };

// The changes of the frame along the twelve directions, in their columns of hessian (24, 24) all but the
// network's curvature, and the changes of the features (12, count). `weights` are the network's gradient
// (count); both are ignored if the model is constant. Returns the tetrahedron that is moved.
int contact_geo_hessian_begin(const ContactGeoModel *model, const ContactGeoFrame *frame,
                              const double *weights, const GeoMatrix *slope, const ContactGeoAdjoint *adjoint,
                              double *feature_changes, double *hessian);

// The rest, given the curvature (12, 12) along those changes, NULL if the model is constant. `gradient` (24)
// is that of log V. Leaves hessian symmetric [1/m²].
void contact_geo_hessian_end(const ContactGeoFrame *frame, int moved, const double *curvature,
                             const double *gradient, double *hessian);

#endif

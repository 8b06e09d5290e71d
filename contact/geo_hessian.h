// SPDX-License-Identifier: GPL-3.0-or-later
// The second derivative of log V. Twelve of the 24 directions need no work: an affine map of all space by
// 1 + B changes ∂ log V/∂x_i by −Bᵀ ∂ log V/∂x_i and V's invariants not at all. A step of one vertex of one
// tetrahedron is such a map but for the vertices of the other. So only the vertices of one tetrahedron are
// moved one by one: of the one whose vertices have the smaller barycentric coordinates in the other.
#ifndef TETLAP_CONTACT_GEO_HESSIAN_H
#define TETLAP_CONTACT_GEO_HESSIAN_H

#include "contact/geo.h"

// hessian (24, 24), symmetric [1/m²]. `invariants`, `features`, `weights` and `sweep` are ignored if the
// model is constant.
Status contact_geo_hessian(const ContactGeoModel *model, const ContactGeoFrame *frame,
                           const ContactGeoInvariants *invariants, const double *features,
                           const double *weights, const ContactGeoSweep *sweep, const GeoMatrix *slope,
                           const ContactGeoAdjoint *adjoint, double *hessian);

#endif

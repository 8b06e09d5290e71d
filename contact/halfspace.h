// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a tetrahedron below a plane, in closed form: the overlap with a half-space obstacle.
#ifndef TETLAP_CONTACT_HALFSPACE_H
#define TETLAP_CONTACT_HALFSPACE_H

// The solid is { x : normal·(x − point) ≤ 0 }; `normal` has unit length.
// V [m³], and, where not NULL, dV/dx of the four vertices [m²] and d²V/dx² [m] (12 × 12). Analytic in each of
// the cases 1, 2, 3 or 4 vertices below; V is C² across them. Scale-free: no tolerance.
void contact_halfspace_overlap(const double tet[12], const double point[3], const double normal[3],
                               double *volume, double gradient[12], double hessian[144]);

#endif

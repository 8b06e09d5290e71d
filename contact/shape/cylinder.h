// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a tetrahedron inside a cylinder with flat ends, exactly round: the overlap with such an
// obstacle.
//
// The axis is z. A column along z meets the cylinder's side nowhere, so by Gauss' theorem for fields along z
// the integral of f over the part inside is a sum over the polygons that bound the tetrahedron between the
// ends,
//
//   ∫ f dV = Σ_polygons ∫ n_z ∫_{z₀}^{z} f dz' dA   over the part of the polygon inside the side,
//
// whatever z₀. Seen along z that part is bounded by segments and by arcs of a circle. It is cut into
// triangles, with a rule that is exact for f, and segments of circles, with Gauss' rule to rounding.
//
// The depth of the potential `field` is the less of (R² − r²)/(2K) and of that below the nearer end, H − |z|,
// with K = R but for a cylinder of less radius that shares the depth's slope. With w what the first is more
// than the second, φ = (R² − r²)/(2K) − max(w, 0). w > 0 is again a circle as seen along z on every plane,
// and w vanishes at its lower end: the same sum with z₀ = z − w.
#ifndef TETLAP_CONTACT_SHAPE_CYLINDER_H
#define TETLAP_CONTACT_SHAPE_CYLINDER_H

#include <stdbool.h>

#include "base/vec3.h"

typedef struct ContactCylinder {
  double radius, half_length; // R, H [m]
  double round;               // K [m]
} ContactCylinder;

// V [m³] and, where not NULL, ∂V/∂x [m²] of a tetrahedron (4, 3) of either orientation.
void contact_cylinder_overlap(const ContactCylinder *cylinder, const double tet[12], double *volume,
                              double gradient[12]);

// Of the potential `field` (contact/pressure/field.h) with c = 1 Pa/m: V [m³], the energy of a tetrahedron of
// that rest volume [m⁴], its gradient s ∫ λ_a ∇φ [m³] and, where not NULL, the Hessian [m²], of central
// differences as in contact/shape/ball.h.
void contact_cylinder_press(const ContactCylinder *cylinder, const double tet[12], double rest_volume,
                            double *volume, double *energy, double gradient[12], double hessian[144]);

// The less of both depths; negative outside.
double contact_cylinder_depth(const ContactCylinder *cylinder, Vec3 x);

// A lower bound of the distance of a tetrahedron, from the side or from an end; negative once they overlap.
double contact_cylinder_separation(const ContactCylinder *cylinder, const double tet[12]);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Obstacles without elements: half-spaces, balls, cylinders and convex solids, at rest or moving. Each
// function has one `case` a kind.
#ifndef TETLAP_CONTACT_SHAPE_SHAPE_H
#define TETLAP_CONTACT_SHAPE_SHAPE_H

#include "base/vec3.h"
#include "contact/def.h"

// Where the shape's point is at a time [m].
Vec3 contact_shape_point(const ContactShape *shape, double time);
// How fast the shape's material moves at x [m/s]; with its spin.
Vec3 contact_shape_velocity(const ContactShape *shape, double time, Vec3 x);

// Where the shape's material that is at x at `time` was at the time `before` [m].
Vec3 contact_shape_place_before(const ContactShape *shape, double time, double before, Vec3 x);

// V [m³] and, where not NULL, ∂V/∂x [m²] of a tetrahedron (4, 3) in the shape.
void contact_shape_overlap(const ContactShape *shape, double time, const double tet[12], double *volume,
                           double gradient[12]);
// Of the potential `field` (contact/pressure/field.h) with c = 1 Pa/m: the overlap V [m³], the energy [m⁴] of
// a tetrahedron (4, 3) of that rest volume, ∂/∂x of it [m³] and, where not NULL, ∂²/∂x² [m²]. The depth in a
// ball is (R² − r²)/(2R), in a convex solid the least of those below its planes. In a cylinder it is the less
// of (R² − r²)/(2R) from the axis and of that below the nearer end.
void contact_shape_press(const ContactShape *shape, double time, const double tet[12], double rest_volume,
                         double *volume, double *energy, double gradient[12], double hessian[144]);
// The depth of x in the shape, as there [m]; negative outside. And that of its middle, the largest; INFINITY:
// there is none.
double contact_shape_depth(const ContactShape *shape, double time, Vec3 x);
double contact_shape_middle(const ContactShape *shape);
// What of the shape is deeper than `depth`, which is less than its middle's. `solid` is kept, borrowed, where
// the shape has one.
ContactShape contact_shape_shrink(const ContactShape *shape, double depth, struct ContactConvex *solid);
// The shape as it stands at that time, at rest: for many questions about one time.
ContactShape contact_shape_stand(const ContactShape *shape, double time);
// Distance of a tetrahedron from the shape [m], negative once they overlap; of a convex solid as in
// overlap/separation.h, ending early with a lower bound once it exceeds `enough`.
double contact_shape_separation(const ContactShape *shape, double time, const double tet[12], double enough);

// Distance of x from the shape's surface [m], negative inside; beyond an edge of a convex solid that from the
// farthest of its planes, which is less.
double contact_shape_gap(const ContactShape *shape, double time, Vec3 x);

// A lower bound of the distance of vertices begin … end, and of all between them, from the shape [m].
double contact_shape_clearance(const ContactShape *shape, double time, const double *positions, int begin,
                               int end);
// How far its surface has come nearer to anything between two times, at most [m]; and how fast it does [m/s].
double contact_shape_motion(const ContactShape *shape, double from, double to);
double contact_shape_speed(const ContactShape *shape, double time);

// STATUS_INPUT: a normal that is no unit vector, a radius that is not positive, axes that are no frame.
Status contact_shape_check(const ContactShape *shape);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// How far the origin is from a triangle: squares of distances.
#ifndef TETLAP_CONTACT_SHAPE_TRIANGLE_H
#define TETLAP_CONTACT_SHAPE_TRIANGLE_H

#include "base/vec3.h"

// From the segment a b.
double contact_triangle_square_of_edge(Vec3 a, Vec3 b);

// From a triangle: from its plane where the foot lies inside, else from an edge.
double contact_triangle_square(const Vec3 corners[3]);

#endif

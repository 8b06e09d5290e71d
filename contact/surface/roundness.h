// SPDX-License-Identifier: GPL-3.0-or-later
// How a body's surface curves, and how fine it is meshed there.
#ifndef TETLAP_CONTACT_SURFACE_ROUNDNESS_H
#define TETLAP_CONTACT_SURFACE_ROUNDNESS_H

#include "contact/def.h"

// A facet curves by the form that the ways of its three edges to the surface make, which is estimated from
// the vertices round it (contact/surface/smooth/smooth_points.h). What is less than a twentieth of the
// surface counts as none.
typedef struct ContactRoundness {
  double edge;   // of facets, along what curves: a tenth are finer; of flat ones where none curves [m]
  double round;  // 1/R of the convex ones, the median by area; 0: there are none [1/m]
  double hollow; // ... and of the concave ones [1/m]
} ContactRoundness;

// `crease` as in the definition [rad]. `held` (vertex_count): vertices that cannot move; facets between them
// do not count. NULL: none.
Status contact_roundness_measure(ContactRoundness *roundness, const ContactSystemDef *def,
                                 const ContactBody *body, double crease, const bool *held);

#endif

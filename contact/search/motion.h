// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds of by how much two parties, bodies or shapes, come nearer.
#ifndef TETLAP_CONTACT_SEARCH_MOTION_H
#define TETLAP_CONTACT_SEARCH_MOTION_H

#include "base/vec3.h"
#include "contact/search/layout.h"

// The displacements of a party's points: their mean, the largest difference from it, and the longest.
typedef struct ContactMotion {
  Vec3 mean;      // [m]
  double spread;  // the longest difference from that [m]
  double longest; // [m]
} ContactMotion;

// How `to` − `from` (NULL: 0) moves over vertices begin … end; NaN counts as infinite.
ContactMotion contact_motion_of(const double *to, const double *from, int begin, int end);
ContactMotion contact_motion_of_shape(double way);

// Of all parties from the reference to these positions, into motions (party_count).
void contact_motion_measure(const ContactLayout *layout, double reference_time, const double *reference,
                            double time, const double *positions, ContactMotion *motions);

// By how much the two of an interface may have come nearer: what is common to both does not count.
double contact_motion_approach(const ContactMotion *motions, const ContactInterfaceDef *interface);

#endif

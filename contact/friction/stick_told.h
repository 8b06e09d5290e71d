// SPDX-License-Identifier: GPL-3.0-or-later
// What friction by elastic stick (contact/friction/stick.h) tells at the vertices as they were given: whether
// they slide, how far they have slid, and what that dissipated. Slip, way and work are those of the slave; of
// several interfaces, and of both halves in self-contact, they are summed.
#ifndef TETLAP_CONTACT_FRICTION_STICK_TOLD_H
#define TETLAP_CONTACT_FRICTION_STICK_TOLD_H

#include "contact/friction/stick.h"

// By given vertices; zeroed by the caller.
typedef struct ContactStickTold {
  double (*weights)[2]; // of what sticks and of what slides there, of either side [N]    (vertex_count)
  double (*slips)[3];   // slid against the other since it was last touched [m]           (vertex_count)
  double *ways;         // Σ of the lengths slid so far [m]                               (vertex_count)
  double *works;        // dissipated so far, vertices inside of the body included [J]    (vertex_count)
} ContactStickTold;

// Adds what holds at the last evaluation, which was of this history. `depths`: of the vertices below their
// surface, above 0 inside; slip and way are told at the others alone.
void contact_stick_tell(const ContactStick *stick, const ContactStickHistory *history, const bool *is_resting,
                        const double *depths, const ContactStickTold *told);

#endif

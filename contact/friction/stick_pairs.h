// SPDX-License-Identifier: GPL-3.0-or-later
// Between a contact system with the potential `field` and friction by elastic stick
// (contact/friction/stick.h): which of two is the slave, and what the pairs of an evaluation hand over.
#ifndef TETLAP_CONTACT_FRICTION_STICK_PAIRS_H
#define TETLAP_CONTACT_FRICTION_STICK_PAIRS_H

#include "contact/friction/stick.h"
#include "contact/system.h"

// Laws for all interfaces of the system with these coefficients (interface_count) and the stiffness of the
// normal law, c_t = c. Slave is the body against an obstacle, the smaller of two bodies, of two of one size
// the one with more vertices; of a body and itself both halves. `laws` (interface_count).
void contact_stick_pairs_laws(const ContactSystem *system, ContactStickLaw *laws);

// Evaluates the friction for an evaluation of the system, from the last accepted state, which was at
// `last_time` [s]. `is_resting` (interface_count) is filled.
Status contact_stick_pairs_eval(ContactStick *stick, const ContactSystem *system,
                                const ContactEvaluation *evaluation, const ContactStickLast *last,
                                double last_time, bool *is_resting);

// Of the friction that was evaluated for this evaluation:
// the power that moving obstacles without elements put in by friction [W];
double contact_stick_pairs_shape_power(const ContactStick *stick, const ContactLayout *layout,
                                       const ContactEvaluation *evaluation);

// the power by which friction drives slip at these velocities (vertex_count, 3; as given): the sum over
// interfaces of the powers of their slipping pairs, where it is positive [W]. Friction acts against the
// displacement since the last accepted state. Where the velocity has reversed since then it acts along the
// velocity: the step was too long.
double contact_stick_pairs_turned_power(const ContactStick *stick, ContactSystem *system,
                                        const ContactEvaluation *evaluation, const double *velocities);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The friction effect's inside, for output.
#ifndef TETLAP_FEM_EFFECT_FRICTION_H
#define TETLAP_FEM_EFFECT_FRICTION_H

#include "contact/friction/friction.h"

// The friction of the effect that fem_system_effect(system, &fem_effect_friction) returned; borrowed.
const ContactFriction *fem_effect_friction_of(const void *effect);

#endif

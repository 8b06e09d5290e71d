// SPDX-License-Identifier: GPL-3.0-or-later
// The inside of friction by elastic stick, for output.
#ifndef TETLAP_FEM_EFFECT_STICK_H
#define TETLAP_FEM_EFFECT_STICK_H

#include "contact/friction/stick.h"

// The law of the effect that fem_system_effect(system, "stick") returned, as it was evaluated last; borrowed.
const ContactStick *fem_effect_stick_of(const void *effect);

#endif

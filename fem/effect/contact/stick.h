// SPDX-License-Identifier: GPL-3.0-or-later
// The inside of friction by elastic stick, for output.
#ifndef TETLAP_FEM_EFFECT_STICK_H
#define TETLAP_FEM_EFFECT_STICK_H

#include "contact/friction/stick_told.h"
#include "fem/effect/state.h"

// The law of the effect that fem_system_effect(system, &fem_effect_stick) returned, as it is at a state; the
// effect's, valid until it is asked for another one.
Status fem_effect_stick_evaluate(void *effect, const FemState *state, const ContactStick **law);

// What it tells at the given vertices at a state (contact/friction/stick_told.h).
Status fem_effect_stick_tell(void *effect, const FemState *state, const ContactStickTold *told);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The inside of friction by elastic stick, for output and derivatives.
#ifndef TETLAP_FEM_EFFECT_CONTACT_STICK_H
#define TETLAP_FEM_EFFECT_CONTACT_STICK_H

#include "contact/friction/stick_pull.h"
#include "contact/friction/stick_told.h"
#include "fem/effect/state.h"
#include "fem/model/model.h"

// Friction of a model that has the same bodies in another shape, on its contact effect `contact` (borrowed),
// with the laws and the slaves that the effect `of` has. Destroy it as the effect's operations say.
Status fem_effect_stick_create_like(void **self, const FemModel *model, void *contact, const void *of);

// The law of the effect that fem_system_effect(system, &fem_effect_stick) returned, as it is at a state; the
// effect's, valid until it is asked for another one.
Status fem_effect_stick_evaluate(void *effect, const FemState *state, const ContactStick **law);
// Its derivatives backwards, at a state (contact/friction/stick_pull.h).
Status fem_effect_stick_pull(void *effect, const FemState *state, const ContactStickPull *pull);
// Where the system's states have what it remembers.
int fem_effect_stick_place(const void *effect);
// A view of what it remembers, of the numbers of one of its histories.
ContactStickHistory fem_effect_stick_history(const void *effect, const FemEffectHistory *history);

// What it reports at the given vertices at a state (contact/friction/stick_told.h).
Status fem_effect_stick_tell(void *effect, const FemState *state, const ContactStickTold *told);

#endif

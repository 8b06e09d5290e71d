// SPDX-License-Identifier: GPL-3.0-or-later
// The contact effect's inside, for output, comparison and audit.
#ifndef TETLAP_FEM_EFFECT_CONTACT_H
#define TETLAP_FEM_EFFECT_CONTACT_H

#include "contact/system.h"

// The contact system of the effect that fem_system_effect(system, "contact") returned; borrowed.
ContactSystem *fem_effect_contact_system(void *effect);

// The name of side `number` of an interface: a body, a mesh obstacle or a half-space.
const char *fem_effect_contact_name(const void *effect, int number);

#endif

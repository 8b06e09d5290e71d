// SPDX-License-Identifier: GPL-3.0-or-later
// How much and where two press each other: pressure times area and the centre of pressure, from the pairs of
// one patch.
#ifndef TETLAP_CONTACT_PRESSURE_PATCH_IMPRINT_H
#define TETLAP_CONTACT_PRESSURE_PATCH_IMPRINT_H

#include "contact/interface.h"
#include "contact/pressure/field.h"
#include "contact/pressure/patch/patches.h"

// Fills `pressed` [N] and `centre` [m] (NaN where nothing presses) of the interface of a patch of these
// pairs.
void contact_imprint_find(const ContactFieldPair *fields, const ContactPatch *patch,
                          ContactInterface *interface);

#endif

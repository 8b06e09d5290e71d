// SPDX-License-Identifier: GPL-3.0-or-later
// Where and how two press each other: the area of contact, pressure times area and the centre of pressure,
// from the pairs of one patch.
//
// The area is the sum of contact_field_area over pairs. With the potential `field` it loses a quarter of the
// outermost row of cells.
#ifndef TETLAP_CONTACT_PRESSURE_IMPRINT_H
#define TETLAP_CONTACT_PRESSURE_IMPRINT_H

#include "contact/interface.h"
#include "contact/pressure/field.h"
#include "contact/pressure/patches.h"

// Fills `area` [m²], `pressed` [N] and `centre` [m] (NaN where nothing presses) of the interface of a patch
// of these pairs.
void contact_imprint_find(const ContactFieldPair *fields, const ContactPatch *patch,
                          ContactInterface *interface);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Where two press each other: the area of contact and the centre of pressure, from the pairs of one patch.
//
// With the potential `field` the area is the sum of contact_field_area over pairs, which loses a quarter of
// the outermost row of cells. The other potentials have ∇V: the area is |Σ ∂V/∂x_A|, the length of the vector
// area of A's surface inside B, which is the area projected along the mean normal.
#ifndef TETLAP_CONTACT_PRESSURE_IMPRINT_H
#define TETLAP_CONTACT_PRESSURE_IMPRINT_H

#include "contact/interface.h"
#include "contact/pressure/field.h"
#include "contact/pressure/patches.h"

// What is looked at, borrowed: of an evaluation (contact/evaluation.h).
typedef struct ContactImprintSource {
  const ContactPatches *patches;
  const ContactFieldPair *fields; // `field` only; else NULL                (pair_count)
  const double *gradients;        // ∇V_ij                                  (pair_count, 2, 4, 3)
  const double *positions;        // [m]                                    (vertex_count, 3)
} ContactImprintSource;

// Fills `area` [m²] and `centre` [m] (NaN where nothing presses) of the interface of a patch.
void contact_imprint_find(const ContactImprintSource *source, const ContactPatch *patch,
                          ContactInterface *interface);

#endif

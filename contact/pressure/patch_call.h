// SPDX-License-Identifier: GPL-3.0-or-later
// An experiment: a cell against the other body's surface in one call. V, x̄ and the wrench of all pairs of a cell in one direction
// come from their exact sums ("exact") or from a network of the eight nearest outer triangles; the force acts on the cell at x̄
// and, opposite, on the other body's cell that holds x̄.
#ifndef TETLAP_CONTACT_PATCH_CALL_H
#define TETLAP_CONTACT_PATCH_CALL_H

#include "contact/evaluation.h"

void contact_patch_call_press(ContactEvaluation *evaluation, const ContactLayout *layout);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The pressure law of each two that can meet, as the scene says: `contact.law`, or that of the last of
// `contact.pairs` with these two which gives a law, or a stiffness, with which they are linear.
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_LAWS_H
#define TETLAP_FEM_MODEL_COMPLIANCE_LAWS_H

#include "contact/pressure/law.h"
#include "fem/model/model.h"

// Whether any two may have a law that is not linear.
bool fem_laws_are_wanted(const FemContactDef *contact);

// Of every body with every party, in the order of FemCompliance (body_count, party_count); an
// entry NULL: linear. The table is the caller's (memory_free), NULL if no law is wanted; the laws are the
// scene's. STATUS_INPUT: a law makes no sense.
Status fem_laws_create(const FemModel *model, const ContactLaw ***laws);

#endif

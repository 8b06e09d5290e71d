// SPDX-License-Identifier: GPL-3.0-or-later
// Two overlap models in the same configuration. Only pairs of tetrahedra count: half-spaces ask no model.
#ifndef TETLAP_CONTACT_AUDIT_H
#define TETLAP_CONTACT_AUDIT_H

#include "contact/evaluation.h"

// Differences of the two evaluations, relative to the reference: 0 where both are 0, INFINITY where only the
// reference is.
ContactAudit contact_audit_compare(const ContactLayout *layout, const ContactEvaluation *candidate,
                                   const ContactEvaluation *reference);

#endif

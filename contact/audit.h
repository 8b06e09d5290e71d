// SPDX-License-Identifier: GPL-3.0-or-later
// Two overlap models in the same configuration. Only pairs of tetrahedra count: half-spaces ask no model.
#ifndef TETLAP_CONTACT_AUDIT_H
#define TETLAP_CONTACT_AUDIT_H

#include "contact/evaluation.h"

// Relative differences against the reference.
typedef struct ContactAudit {
  double volume_error;   // Σ|ΔV| / ΣV over the union of pairs
  double gradient_error; // Σ|Δ∇V| / Σ|∇V|, lengths of all 24 components
  double force_error;    // ‖Δf‖₂/‖f‖₂ of the nodal forces
  double total_error;    // ‖ΔF‖₂/‖F‖₂ of the total forces of all interfaces
  int pair_count;
} ContactAudit;

// Differences of the two evaluations, relative to the reference: 0 where both are 0, INFINITY where only the
// reference is.
ContactAudit contact_audit_compare(const ContactLayout *layout, const ContactEvaluation *candidate,
                                   const ContactEvaluation *reference);

#endif

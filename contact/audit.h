// SPDX-License-Identifier: GPL-3.0-or-later
// Two overlap models in the same configuration. Only pairs of tetrahedra count: shapes ask no model.
#ifndef TETLAP_CONTACT_AUDIT_H
#define TETLAP_CONTACT_AUDIT_H

#include "contact/evaluation.h"

// A difference against the reference, and the size of the reference. Both can be summed over configurations.
typedef struct ContactAuditTerm {
  double difference, size;
} ContactAuditTerm;

typedef struct ContactAudit {
  ContactAuditTerm volume;   // Σ|ΔV|, ΣV over the union of pairs [m³]
  ContactAuditTerm gradient; // Σ|Δ∇V|, Σ|∇V|, lengths of all 24 components [m²]
  ContactAuditTerm force;    // ‖Δf‖₂, ‖f‖₂ of the nodal forces [N]
  ContactAuditTerm total;    // ‖ΔF‖₂, ‖F‖₂ of the total forces of all interfaces [N]
  int pair_count;            // of meshes, that either model gives a volume; 0: nothing was asked of them
} ContactAudit;

// Difference over size: 0 where both are 0, INFINITY where only the size is.
double contact_audit_error(ContactAuditTerm term);

ContactAudit contact_audit_compare(const ContactLayout *layout, const ContactEvaluation *candidate,
                                   const ContactEvaluation *reference);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of friction by elastic stick (contact/friction/stick.h), backwards. Given are those of a
// function g by the forces of an evaluation and by the history that it leaves. Sought are those by positions
// now and at the last accepted state, by the history there, and by the constants of the law. Every term is
// differentiated: N, n, the weights, the area, F. Of the history (S, E) the derivatives are by
//
//   q = √(2E) S/|S|,   carried = |q| F q / (√k |F q|),   next q = √k |s| F⁻¹ s / |F⁻¹ s|,
//
// since the length of S does not act. Where a vertex begins to slip or to stick, or is first pressed, the
// derivatives are one-sided.
#ifndef TETLAP_CONTACT_FRICTION_STICK_PULL_H
#define TETLAP_CONTACT_FRICTION_STICK_PULL_H

#include "contact/friction/stick.h"
#include "contact/system.h"

// Arrays are borrowed; vertices are those that were given. What is found is added.
typedef struct ContactStickPull {
  int interface;                   // that alone; CONTACT_ALL_INTERFACES
  const double *forces;            // ∂g/∂f of friction's forces; NULL: 0             (vertex_count, 3)
  const ContactStickHistory *next; // the history that the evaluation leaves
  const double (*after)[3];        // ∂g/∂q of its entries; NULL: 0                   (next->entry_count)
  double *now, *then;  // ∂g/∂x, ∂g/∂xⁿ                                   (vertex_count, 3)
  double (*before)[3]; // ∂g/∂q of the last history's entries             (entry_count)
  double *stiffness;   // ∂g/∂ ln c of normal law and springs            (interface_count)
  double *friction;    // ∂g/∂μ                                           (interface_count)
  double *answers;     // ∂g/∂V and ∂g/∂x̄ of pairs of meshes; NULL: not wanted (mesh_pair_count, 4)
  double (*moves)[2][3]; // Σ of ∂g/∂x, of ∂g/∂xⁿ over the vertices of side 0         (interface_count)
} ContactStickPull;

// For the evaluation that contact_stick_pairs_eval was called with last, and as it was. Balls and pressure
// laws have no such derivatives: the caller refuses them.
Status contact_stick_pull(const ContactStick *stick, ContactSystem *system,
                          const ContactEvaluation *evaluation, const ContactStickLast *last, double last_time,
                          const ContactStickPull *pull);

#endif

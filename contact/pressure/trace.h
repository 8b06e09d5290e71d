// SPDX-License-Identifier: GPL-3.0-or-later
// What presses on a surface and how deep, by vertices: of the pairs that meet a vertex, by the weights λ(x̄)
// with which they act on it, the force, the area that they cover and the overlap's volume. Potential `field`
// only.
//
//   p_a = Σ λ_a |F_ij| / Σ λ_a A_ij,    d_a = Σ λ_a V_ij / Σ λ_a A_ij,    A_ij = V_ij / d_ij
//   (contact_field_area)
//
// Of flat surfaces that overlap by d: d, and 2 c d (c d against a shape), up to the rim, since only what is
// covered counts.
#ifndef TETLAP_CONTACT_TRACE_H
#define TETLAP_CONTACT_TRACE_H

#include "contact/evaluation.h"
#include "contact/surface/stars.h"

typedef struct ContactTrace {
  double force;  // Σ λ |F| [N]
  double area;   // Σ λ A [m²]
  double volume; // Σ λ V [m³]
} ContactTrace;

// Adds those of the evaluation's pairs to the traces of the contact mesh (vertex_count). `is_wanted` by
// interfaces; NULL: all.
void contact_trace_add(const ContactLayout *layout, const ContactEvaluation *evaluation,
                       const bool *is_wanted, ContactTrace *traces);

// Pressures [Pa] and depths [m] of the given vertices from the traces of the contact mesh; 0 where nothing
// presses and inside of bodies. What a star carries counts where its weight is positive. `sums` (given
// vertex_count) is scratch.
void contact_trace_divide(const ContactLayout *layout, const ContactStars *stars, const ContactTrace *traces,
                          ContactTrace *sums, double *pressures, double *depths);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Contact that takes energy out: a pressure in proportion to the rate at which bodies go into each other,
//
//   Ẇ_a = ¼ Σ_{i∋a} Σ_j ∇V_ij · v,      q_a = η (W_a/V_a) (Ẇ_a/V_a),
//
// beside the pressure κ W_a/V_a of the nodal potential and handed on like it: q_ij = ½ (mean over i's
// vertices of q_a + mean over j's of q_b), force −Σ q_ij ∇V_ij; against an obstacle only the body's side,
// without ½. It is the damping of Hunt and Crossley 1975 (Coefficient of restitution interpreted as damping
// in vibroimpact, eq. 9: λ xⁿ ẋ beside k xⁿ) with the covered share W_a/V_a for their depth x, n = 1: it
// begins from nothing at touch, where a plain dashpot would jump, and takes the power Σ_a V_a η (W_a/V_a)
// (Ẇ_a/V_a)² ≥ 0 (with the weights ½). With the potential `field` depth is there itself: beside p = c d a
// pressure η d ḋ, pair by pair, with w = u̇_A − u̇_B at x̄ (contact/pressure/field.h),
//
//   −η V (s_i g_B g_Bᵀ + s_j g_A g_Aᵀ) w   on A at x̄, its opposite on B,   η [Pa s/m²].
//
// Both have this in common: a rigid motion of both bodies together has Ẇ = 0 and no viscous force, and forces
// and torques balance, because those of ∇V do. Parts that separate faster than κ/η (in shares a second) pull.
#ifndef TETLAP_CONTACT_VISCOSITY_H
#define TETLAP_CONTACT_VISCOSITY_H

#include <stddef.h>

#include "contact/system.h"

typedef struct ContactViscosity {
  ContactSystem *system; // borrowed
  double viscosity;      // η [Pa s], `field`: [Pa s/m²]
  double *rates;         // scratch: Ẇ_a, then what is made of it      (node_count)
  size_t rate_capacity;
} ContactViscosity;

// STATUS_INPUT: η ≤ 0. A zeroed one can be destroyed.
Status contact_viscosity_create(ContactViscosity *viscosity, ContactSystem *system, double coefficient);
void contact_viscosity_destroy(ContactViscosity *viscosity);
size_t contact_viscosity_bytes(const ContactViscosity *viscosity); // on the heap

// All three below look at the system's last evaluation.

// Adds the forces [N] at these velocities (vertex_count, 3) to `force`.
Status contact_viscosity_add_force(ContactViscosity *viscosity, const double *velocities, double *force);

// Adds to `resultants` [N] the force on the first side of each interface (contact_system_interfaces, 3).
Status contact_viscosity_add_resultants(ContactViscosity *viscosity, const double *velocities,
                                        double (*resultants)[3]);

// Adds −∂f/∂v times `damping_scale`, exact and never negative, and of −∂f/∂x, times `stiffness_scale`, with
// `nodal` the part Σ η Ẇ_a/V_a² ∇W_a ∇W_aᵀ where bodies go into each other. (The rest is not symmetric, or
// small.)
Status contact_viscosity_add_jacobian(ContactViscosity *viscosity, const double *velocities,
                                      double stiffness_scale, double damping_scale,
                                      const ContactStiffnessSink *sink);

// Powers [W] at these velocities.
typedef struct ContactViscosityPower {
  double dissipated; // ≥ 0
  double driven;     // put in by moving obstacles without elements; those with a mesh are the caller's
} ContactViscosityPower;
Status contact_viscosity_power(ContactViscosity *viscosity, const double *velocities,
                               ContactViscosityPower *power);

#endif

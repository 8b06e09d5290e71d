// SPDX-License-Identifier: GPL-3.0-or-later
// Contact that takes energy out: a pressure in proportion to the rate at which bodies go into each other.
// Beside the pressure p = c d of the depth field at the depth d it is η d ḋ, pair by pair, with w = u̇_A − u̇_B
// at x̄ (contact/pressure/field.h),
//
//   −η V (s_i g_B g_Bᵀ + s_j g_A g_Aᵀ) w   on A at x̄, its opposite on B,   η [Pa s/m²].
//
// It is the damping of Hunt and Crossley 1975 (Coefficient of restitution interpreted as damping in
// vibroimpact, eq. 9: λ xⁿ ẋ beside k xⁿ) with n = 1: it begins from nothing at touch, where a plain dashpot
// would jump, and never gives energy. Two bodies that move together as one rigid body feel none, and forces
// and torques balance. Parts that separate faster than c/η (in depths a second) pull.
#ifndef TETLAP_CONTACT_FRICTION_VISCOSITY_H
#define TETLAP_CONTACT_FRICTION_VISCOSITY_H

#include <stddef.h>

#include "contact/system.h"

typedef struct ContactViscosity {
  ContactSystem *system; // borrowed
  double viscosity;      // η [Pa s/m²]
} ContactViscosity;

// STATUS_INPUT: η ≤ 0. There is nothing to destroy.
Status contact_viscosity_create(ContactViscosity *viscosity, ContactSystem *system, double coefficient);

// A motion: an evaluation of the system, which is of the potential `field`, and velocities there.
typedef struct ContactViscosityMotion {
  const ContactEvaluation *evaluation;
  const double *velocities; // [m/s]                                        (vertex_count, 3)
} ContactViscosityMotion;

// Adds the forces [N] to `force` (vertex_count, 3).
void contact_viscosity_add_force(const ContactViscosity *viscosity, ContactViscosityMotion motion,
                                 double *force);

// Adds to `resultants` [N] the force on the first side of each interface (interface_count, 3).
void contact_viscosity_add_resultants(const ContactViscosity *viscosity, ContactViscosityMotion motion,
                                      double (*resultants)[3]);

// Adds to `moments` [N m] those of the same forces about the origin.
void contact_viscosity_add_moments(const ContactViscosity *viscosity, ContactViscosityMotion motion,
                                   double (*moments)[3]);

// Adds −∂f/∂v times `scale`, which is exact and never negative. ∂f/∂x is left out: it is not symmetric, or
// small.
void contact_viscosity_add_damping(const ContactViscosity *viscosity, ContactViscosityMotion motion,
                                   double scale, const ContactStiffnessSink *sink);

// Powers [W].
typedef struct ContactViscosityPower {
  double dissipated; // ≥ 0
  double driven;     // put in by moving obstacles without elements; those with a mesh are the caller's
} ContactViscosityPower;
ContactViscosityPower contact_viscosity_power(const ContactViscosity *viscosity,
                                              ContactViscosityMotion motion);

#endif

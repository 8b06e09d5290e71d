// SPDX-License-Identifier: GPL-3.0-or-later
// The same model with other constants of materials and pressure laws: how forces and energies at fixed
// positions, and the contact stiffness that is chosen, depend on them.
//
// Every law's force is linear in λ, μ, in mooney_rivlin's share, in ogden's shares and in the modulus of
// fibres; that of damping is linear in β and viscosities. So half the difference of two forces is the
// derivative, up to rounding. Ogden's exponents and directions of fibres take a difference of sixth order.
// The derivative of a pressure law by a constant stands in its place (contact/pressure/law.h).
#ifndef TETLAP_FEM_GRADIENT_VARIED_H
#define TETLAP_FEM_GRADIENT_VARIED_H

#include "contact/system.h"
#include "fem/effect/system.h"
#include "fem/gradient/parameter.h"

typedef struct FemVaried {
  FemModel model;                        // borrows all but `parts` and `scene`
  FemSceneDef scene;                     // borrows all but `contact.pairs`
  FemEffect contact;                     // of that, made when it is first asked for
  FemEffect elasticity, volume, damping; // of that model; without `self`: the scene has none
  double *force;                         // scratch                                  (vertex_count, 3)
} FemVaried;

Status fem_varied_create(FemVaried *varied, const FemModel *model);
void fem_varied_destroy(FemVaried *varied); // also of a zeroed one

// Adds the derivatives of elastic and damping forces [N] and, unless it is NULL, of the elastic energy [J] at
// a state by a constant of the material of a part (fem_parameter_is_of_material); `place`: which of ogden's
// three.
Status fem_varied_derive(FemVaried *varied, int part, FemParameterKind constant, int place,
                         const FemState *state, double *force, double *energy);

// Contact at a state by the derivative of a law by its constant (fem_parameter_is_of_law), of the interfaces
// that have this `*law`. The system's and the evaluation are valid until the next call.
typedef struct FemVariedLaw {
  const ContactSystem *system;
  const ContactEvaluation *evaluation;
  const ContactLaw *law;
} FemVariedLaw;
Status fem_varied_derive_law(FemVaried *varied, const FemParameter *parameter, const FemState *state,
                             FemVariedLaw *derived);
// Adds the forces of an interface [N/p]; nothing if it has another law.
void fem_varied_add_law(const FemVariedLaw *derived, int interface, double *force);

// ∂ ln κ/∂p of each body with each party (body_count, party_count; owned by the caller), p = E or ν of a
// part.
Status fem_varied_derive_stiffness(FemVaried *varied, int part, FemParameterKind constant, double **rates,
                                   int *party_count);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters of a scene, and what they do to the forces at fixed positions: ∂f/∂p, analytic. The elastic
// force of a body is proportional to E at fixed ν in every law without fibres, the force of contact to κ
// where the scene gives one for all, weight to density and to g.
#ifndef TETLAP_FEM_GRADIENT_PARAMETER_H
#define TETLAP_FEM_GRADIENT_PARAMETER_H

#include "fem/effect/system.h"

typedef enum FemParameterKind {
  FEM_PARAMETER_YOUNG,             // E of a body [Pa]
  FEM_PARAMETER_DENSITY,           // of a body [kg/m³]
  FEM_PARAMETER_GRAVITY,           // a component [m/s²]
  FEM_PARAMETER_CONTACT_STIFFNESS, // κ as the scene gives it
} FemParameterKind;

typedef struct FemParameter {
  FemParameterKind kind;
  int body;      // of E and density
  int component; // of gravity
} FemParameter;

// STATUS_INPUT: the scene does not give it, or forces are not known to be proportional to it; the message
// says why.
Status fem_parameter_check(const FemModel *model, const FemParameter *parameter);
// As the scene gives it.
double fem_parameter_value(const FemModel *model, const FemParameter *parameter);
// force += ∂f/∂p at the state (vertex_count, 3) [N per unit of p]. The parameter must have been checked.
Status fem_parameter_add_force(const FemParameter *parameter, FemSystem *system, const FemState *state,
                               double *force);

#endif

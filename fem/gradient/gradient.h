// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives dg/dp of a quantity g at an equilibrium f(x, p) = 0 of a static scene without friction, for any
// number of parameters p by one solve (the adjoint method):
//
//   K λ = ∂g/∂x,   dg/dp = ∂g/∂p + λ · ∂f/∂p,   K = −∂f/∂x, symmetric
//
// Where contact begins or ends exactly at the state, g has no derivative; the values are one-sided there.
#ifndef TETLAP_FEM_GRADIENT_GRADIENT_H
#define TETLAP_FEM_GRADIENT_GRADIENT_H

#include "fem/gradient/parameter.h"

// The mean of a component of the displacement over all vertices of a body [m].
typedef struct FemQuantity {
  int body, component;
} FemQuantity;

typedef struct FemGradient {
  double value;        // g
  double unbalanced;   // largest force on an unknown, as a share of the largest on a vertex
  double residual;     // |∂g/∂x − K λ| / |∂g/∂x|
  double *derivatives; // dg/dp in the order of the parameters, owned   (parameter_count)
} FemGradient;

// STATUS_INPUT: what cannot be differentiated in this scene; the message says what and why.
Status fem_gradient_check(const FemModel *model);
// At the system's accepted state, which stays; the equilibrium is found more exactly first. STATUS_SOLVER: K
// is not positive definite, so that the equilibrium is no stable one. Destroy the gradient also after a
// failure.
Status fem_gradient_find(FemGradient *gradient, FemSystem *system, const FemQuantity *quantity,
                         const FemParameter *parameters, int parameter_count);
void fem_gradient_destroy(FemGradient *gradient); // also of a zeroed one

#endif

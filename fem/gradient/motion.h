// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives dg/dp at the end of a motion without friction and damping, by the discrete adjoint of a replay:
// the run's accepted steps, their ends frozen, done again by backward differences of second order (the first
// step of first order), each balanced to rounding:
//
//   v_n = c u_n + a₁ u_{n−1} + a₂ u_{n−2},   M (c v_n + a₁ v_{n−1} + a₂ v_{n−2}) = f(u_n, t_n; p)
//
// Backwards, with λ = −β and s_n = M (a₁ β_{n+1} + a₂ β_{n+2}), whose coefficients are those of steps n + 1,
// n + 2:
//
//   (K + c² M) β_n = −∂g/∂u − c s_n − a₁ α_{n+1} − a₂ α_{n+2},   α_n = c M β_n + s_n
//   dg/dp = ∂g/∂p + Σ λ_n · (∂f/∂p − ∂M/∂p v̇_n)
//
// g is the replay's, which differs from the run's by the error of its steps. How the steps themselves depend
// on p is left out, as it is in every derivative of a run.
#ifndef TETLAP_FEM_GRADIENT_MOTION_H
#define TETLAP_FEM_GRADIENT_MOTION_H

#include "fem/gradient/gradient.h"

// The ends of a run's steps, from 0 on [s].
typedef struct FemMotionSteps {
  double *times; // owned                                                  (count)
  int count;
  size_t capacity;
} FemMotionSteps;

Status fem_motion_steps_add(FemMotionSteps *steps, double time); // STATUS_MEMORY
void fem_motion_steps_destroy(FemMotionSteps *steps);            // also of a zeroed one

// STATUS_INPUT: what cannot be differentiated in this scene; the message says what and why.
Status fem_motion_check(const FemModel *model, const FemGradientDef *def);
// STATUS_SOLVER: a step of the replay cannot be balanced, or the adjoint has no solution there; the message
// says which step. Destroy the gradient also after a failure.
Status fem_motion_differentiate(FemGradient *gradient, const FemModel *model, const FemGradientDef *def,
                                const FemMotionSteps *steps);

#endif

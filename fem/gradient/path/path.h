// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives dg/dp at the end of a path of steps, where the last state alone does not tell them. So it is of
// a motion, and of a static scene with friction or following pressures. They are those of a replay
// (fem/gradient/path/replay.h), by its discrete adjoint. Backwards, with λ = −β, s_n = M (a₁ β_{n+1} + a₂
// β_{n+2}), whose coefficients are those of steps n + 1, n + 2, J = −∂f/∂u, D = −∂f/∂v, which is symmetric,
// and q what friction remembers after a step (contact/friction/stick_pull.h). u are positions, and u_0 where
// bodies rest:
//
//   (J + c D + c² M)ᵀ β_n = −∂g/∂u − c ∂g/∂v − ū_n − (∂q_n/∂u)ᵀ q̄_n − c s_n − a₁ α_{n+1} − a₂ α_{n+2}
//   α_n = (c M + D) β_n + s_n + ∂g/∂v
//   ū_{n−1} = (∂f/∂u_{n−1})ᵀ λ_n + (∂q_n/∂u_{n−1})ᵀ q̄_n
//   q̄_{n−1} = (∂f/∂q_{n−1})ᵀ λ_n + (∂q_n/∂q_{n−1})ᵀ q̄_n
//   dg/dp = ∂g/∂p + Σ λ_n · (∂f/∂p − ∂M/∂p v̇_n) + q̄_n · ∂q_n/∂p
//           + (ū_0 + a₁ α_1 + a₂ α_2) · ∂u_0/∂p + s_0 · ∂v_0/∂p
//
// J is the matrix, but not with friction, following pressures, damping, pressure laws and overlap models that
// do not clip. Then J is not symmetric; its transpose is applied exactly, by GMRES with the factor of the
// matrix, or its diagonal where mass dominates (fem/gradient/path/dominance.h). How the steps themselves
// depend on p is left out, as it is in every derivative of a run. A vertex that changes between sticking and
// slipping within a step makes g one-sided there.
#ifndef TETLAP_FEM_GRADIENT_PATH_PATH_H
#define TETLAP_FEM_GRADIENT_PATH_PATH_H

#include <signal.h>

#include "fem/gradient/gradient.h"
#include "fem/gradient/path/replay_steps.h"

// STATUS_INPUT: what cannot be differentiated (fem_gradient_check, fem_path_check). STATUS_SOLVER: a step of
// the replay cannot be balanced, or the adjoint has no solution there; the message says which step.
// STATUS_INTERRUPTED once `stop`, if it is not NULL, is other than 0. Destroy the gradient also after a
// failure.
Status fem_path_differentiate(FemGradient *gradient, const FemModel *model, const FemGradientDef *def,
                              const FemReplaySteps *steps, const volatile sig_atomic_t *stop);

#endif

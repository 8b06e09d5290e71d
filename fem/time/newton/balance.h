// SPDX-License-Identifier: GPL-3.0-or-later
// How well the forces on a body balance: a criterion of Newton's method beside the size of its corrections.
// Contact forces in the output are as accurate as that, and an unbalanced rest does work on a body that
// turns.
#ifndef TETLAP_FEM_TIME_NEWTON_BALANCE_H
#define TETLAP_FEM_TIME_NEWTON_BALANCE_H

#include "fem/effect/state.h"
#include "fem/model/model.h"
#include "fem/time/part.h"

// Sums over a body's unknowns: r the residual, v̄ the mean velocity, Ω × d the velocity of its rotation as a
// whole, with Ω from its inertia and angular momentum. Numbers only, which ranks add up.
typedef struct FemBalanceBody {
  double unbalanced; // Σ |r| [N]
  double needed;     // Σ m |v̇| [N]
  double power;      // Σ r · (Ω × d): what the rest gives to the rotation [W]
  double turnover;   // Σ m |v̇| |v − v̄| [W]
  double energy;     // ½ Σ m (v − v̄)² [J]
  double is_within;  // 1: Σ |r| is so little that its power does not count
} FemBalanceBody;

typedef struct FemBalance {
  FemBalanceBody *bodies; // at the last state, owned                       (body_count)
  int *begin;             // of this rank's unknowns, owned                  (body_count + 1)
  double *given;          // to their rotations by steps so far, owned [J]  (body_count)
} FemBalance;

// STATUS_MEMORY.
Status fem_balance_create(FemBalance *balance, int body_count);
void fem_balance_destroy(FemBalance *balance);

// The largest excess of a body: Σ |r|, or the power where it adds to what it has given, over what is allowed
// [1]; infinite where a residual is no number. All at one `state`: `forces` f (vertex_count, 3), those of
// contact among them `pressing` (vertex_count, 3; NULL: none), and `residual` M v̇ − f of this rank's unknowns
// [N]. By all ranks.
double fem_balance_excess(FemBalance *balance, const FemModel *model, const FemPart *part,
                          const FemState *state, const double *forces, const double *pressing,
                          const double *residual);
// A step of that length [s] ends at the last state.
void fem_balance_keep(FemBalance *balance, const FemModel *model, double step);

#endif

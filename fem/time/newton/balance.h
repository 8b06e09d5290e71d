// SPDX-License-Identifier: GPL-3.0-or-later
// How well the forces on a body balance: a criterion of Newton's method beside the size of its corrections.
// Contact forces in the output are as accurate as that, and an unbalanced rest does work on a body that
// turns.
#ifndef TETLAP_FEM_TIME_NEWTON_BALANCE_H
#define TETLAP_FEM_TIME_NEWTON_BALANCE_H

#include "fem/effect/system.h"
#include "fem/time/part.h"

// Of each body: Σ |r|, and Σ m |v̇| [N]; both owned.
typedef struct FemBalance {
  double *unbalanced, *needed; // (body_count)
} FemBalance;

// STATUS_MEMORY.
Status fem_balance_create(FemBalance *balance, int body_count);
void fem_balance_destroy(FemBalance *balance);

// The largest Σ |r| of a body over what is allowed [1], infinite where a residual is no number. `residual` is
// M v̇ − f of this rank's unknowns at the state that the system's forces were evaluated at last [N],
// `pressing` contact's forces there (vertex_count, 3), NULL: none. By all ranks.
double fem_balance_excess(FemBalance *balance, const FemSystem *system, const double *pressing,
                          const FemPart *part, const double *residual);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's method on f(u, t) = 0 by the work that the force does along a step: what a step overshoots is
// found by a change of its sign, so this converges where |f| does not fall on the way, as where many vertices
// change between stick and slip, whose force has a bend and whose matrix lacks a part.
#ifndef TETLAP_FEM_TIME_DESCENT_H
#define TETLAP_FEM_TIME_DESCENT_H

#include "fem/time/equilibrium.h"

// Moves u (unknown_count) until the largest force on an unknown is below `tolerance` [N]. Contact lists
// follow its way. `*iterations` grows by those taken. RETRY: not reached; the message says why.
Status fem_descent_solve(FemEquilibrium *equilibrium, double time, double tolerance, double *u,
                         long long *iterations);

#endif

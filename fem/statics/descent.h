// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's method on f(u, t) = 0 with a line search on the work that the force does along a step: the work
// changes its sign where the step overshoots. So it converges even where |f| does not decrease along the way,
// as where many vertices change between stick and slip. There the force has a kink, and the matrix lacks a
// part.
#ifndef TETLAP_FEM_STATICS_DESCENT_H
#define TETLAP_FEM_STATICS_DESCENT_H

#include "fem/statics/equilibrium.h"

// From the iteration FEM_DESCENT_PATIENCE on, FEM_DESCENT_TOLERABLE times the tolerance is accepted: forces
// of contact may not be more accurate than that.
enum { FEM_DESCENT_PATIENCE = 25, FEM_DESCENT_TOLERABLE = 100 };

// Moves u (unknown_count) until the largest force on an unknown is below `tolerance` [N], or, late, below
// what is tolerable. Contact lists follow its way. `*iterations` grows by those taken. RETRY: not reached;
// the message says why.
Status fem_descent_solve(FemEquilibrium *equilibrium, double time, double tolerance, double *u,
                         long long *iterations);

#endif

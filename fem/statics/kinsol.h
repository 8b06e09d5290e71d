// SPDX-License-Identifier: GPL-3.0-or-later
// SUNDIALS KINSOL: Newton's method on f(u, t) = 0, a fresh factorisation in every iteration; first with full
// steps, then, where these do not converge, with a line search. The order matters: the line search lowers
// |f|, but where a slender body turns a full step stretches it first, so |f| grows tenfold, and the next step
// converges. It converges from near an equilibrium; fem/statics/statics.h brings it there.
#ifndef TETLAP_FEM_STATICS_KINSOL_H
#define TETLAP_FEM_STATICS_KINSOL_H

#include "fem/statics/equilibrium.h"

// Moves u (unknown_count) until the largest force on an unknown is below `tolerance` [N]; `length` [m] is the
// scale of displacements. `*iterations` grows by those taken. RETRY: not reached, u is then undefined; the
// message says why.
Status fem_kinsol_solve(FemEquilibrium *equilibrium, double time, double tolerance, double length, double *u,
                        long long *iterations);

#endif

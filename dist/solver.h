// SPDX-License-Identifier: GPL-3.0-or-later
// Linear solvers over ranks, all PETSc's: `amg` (BoomerAMG of hypre), `gamg`, for `cholmod` an exact factor
// by MUMPS, for `pcg` incomplete factors of each rank's block.
#ifndef TETLAP_DIST_SOLVER_H
#define TETLAP_DIST_SOLVER_H

#include "fem/sparse/solver.h"

// Where several ranks share a run these take the place of the solvers of one process.
void dist_solver_provide(void);
// Ends PETSc, if it was begun; by all ranks.
void dist_solver_close(void);

#endif

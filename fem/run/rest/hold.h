// SPDX-License-Identifier: GPL-3.0-or-later
// Numbering the unknowns anew while a run goes on: vertices that are released, bodies that fall asleep
// (rest.h). The state stays where it is.
#ifndef TETLAP_FEM_RUN_REST_HOLD_H
#define TETLAP_FEM_RUN_REST_HOLD_H

#include "fem/effect/system.h"
#include "fem/run/rest/rest.h"
#include "fem/time/audit.h"

// Removes the unknowns of bodies that have fallen asleep, and adds those of bodies that have awoken.
// What falls asleep stands still in the state from now on; its kinetic energy is counted by `rest`. u and v
// (unknown_count) are the state's.
Status fem_hold_sleepers(FemSystem *system, FemRest *rest, FemState *state, double *u, double *v);

// Releases what is due at the state's time, with the place and the velocity that it was driven to, for which
// the audit accounts, and then as above.
Status fem_hold_renumber(FemSystem *system, FemRest *rest, FemState *state, FemAudit *audit, double *u,
                         double *v);

#endif

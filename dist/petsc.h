// SPDX-License-Identifier: GPL-3.0-or-later
// PETSc's solvers, and what differs between the versions that we are compiled with: 3.18 in Debian 12, 3.22
// in Debian 13. All else calls both alike.
#ifndef TETLAP_DIST_PETSC_H
#define TETLAP_DIST_PETSC_H

#include <petscksp.h>

// Why the set-up failed on this rank, PC_NOERROR if it did not.
static inline PetscErrorCode dist_petsc_failure(PC pc, PCFailedReason *reason) {
#if PETSC_VERSION_LT(3, 20, 0)
  return PCGetFailedReasonRank(pc, reason);
#else
  return PCGetFailedReason(pc, reason);
#endif
}

#endif

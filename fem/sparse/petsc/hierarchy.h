// SPDX-License-Identifier: GPL-3.0-or-later
// The hierarchy that BoomerAMG has made, taken over into a V-cycle of our own: hypre's sweeps are on one
// thread and read each entry three times, in double precision.
#ifndef TETLAP_FEM_SPARSE_PETSC_HIERARCHY_H
#define TETLAP_FEM_SPARSE_PETSC_HIERARCHY_H

#include "fem/sparse/multigrid/cycle.h"
#include "fem/sparse/petsc/petsc_library.h"

// `multigrid` has been set up for the matrix `finest`; it can only be destroyed afterwards. `*code`: PETSc's
// error where the status is STATUS_SOLVER, else 0.
Status fem_hierarchy_take(const FemPetscLibrary *petsc, PC multigrid, const FemRows *finest, FemCycle *cycle,
                          PetscErrorCode *code);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The functions of PETSc that we call, found in its library when a solver of it is first asked for. The
// program is not linked to PETSc: it brings MPI and some seventy libraries along, which would be loaded at
// each start.
#ifndef TETLAP_FEM_SPARSE_PETSC_PETSC_LIBRARY_H
#define TETLAP_FEM_SPARSE_PETSC_PETSC_LIBRARY_H

#include <petscksp.h>
#include <stdbool.h>

#include "base/status.h"

#define FEM_PETSC_FUNCTIONS(FUNCTION)                                                                        \
  FUNCTION(MatConvert)                                                                                       \
  FUNCTION(MatCreateSeqAIJWithArrays)                                                                        \
  FUNCTION(MatDestroy)                                                                                       \
  FUNCTION(MatGetRowIJ)                                                                                      \
  FUNCTION(MatRestoreRowIJ)                                                                                  \
  FUNCTION(MatSeqAIJGetArrayRead)                                                                            \
  FUNCTION(MatSeqAIJRestoreArrayRead)                                                                        \
  FUNCTION(MatSetBlockSize)                                                                                  \
  FUNCTION(MatSetOption)                                                                                     \
  FUNCTION(PCApply)                                                                                          \
  FUNCTION(PCCreate)                                                                                         \
  FUNCTION(PCDestroy)                                                                                        \
  FUNCTION(PCGetCoarseOperators)                                                                             \
  FUNCTION(PCGetInterpolations)                                                                              \
  FUNCTION(PCSetCoordinates)                                                                                 \
  FUNCTION(PCSetFromOptions)                                                                                 \
  FUNCTION(PCSetOperators)                                                                                   \
  FUNCTION(PCSetOptionsPrefix)                                                                               \
  FUNCTION(PCSetType)                                                                                        \
  FUNCTION(PCSetUp)                                                                                          \
  FUNCTION(PetscFinalize)                                                                                    \
  FUNCTION(PetscGetVersionNumber)                                                                            \
  FUNCTION(PetscIgnoreErrorHandler)                                                                          \
  FUNCTION(PetscInitialize)                                                                                  \
  FUNCTION(PetscOptionsSetValue)                                                                             \
  FUNCTION(PetscPushErrorHandler)                                                                            \
  FUNCTION(VecCreateSeqWithArray)                                                                            \
  FUNCTION(VecDestroy)                                                                                       \
  FUNCTION(VecGetArray)                                                                                      \
  FUNCTION(VecRestoreArray)

typedef struct FemPetscLibrary {
#define FEM_PETSC_FIELD(name) __typeof__(name) *name;
  FEM_PETSC_FUNCTIONS(FEM_PETSC_FIELD)
#undef FEM_PETSC_FIELD
  MPI_Comm self; // of this process alone
  // Frees what PETSc allocated for us: what its macro PetscFree calls.
  PetscErrorCode (*release)(void *, int, const char *, const char *);
} FemPetscLibrary;

// The library, loaded and initialised once; it stays until the process ends. STATUS_IO: it is not installed,
// or is another than the one whose headers tetlap was compiled with; the message names it. Not from two
// threads at once.
Status fem_petsc_library(const FemPetscLibrary **library);

// Whether it can be used, without initialising it: it is there, has all these functions and the version of
// the headers, and BoomerAMG (hypre) is part of it.
bool fem_petsc_library_has_hypre(void);

#endif

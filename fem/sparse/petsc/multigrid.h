// SPDX-License-Identifier: GPL-3.0-or-later
// The multigrid of PETSc's library for a symmetric and positive definite matrix, of two kinds. One is hypre's
// BoomerAMG, with the unknowns of a vertex kept apart by their direction (Henson and Yang 2002); its
// hierarchy is worked through by fem/sparse/multigrid/cycle.h. The other is GAMG, PETSc's smoothed
// aggregation with the rigid motions as near-null space (Vaněk, Mandel and Brezina 1996; Adams et al. 2004).
#ifndef TETLAP_FEM_SPARSE_PETSC_MULTIGRID_H
#define TETLAP_FEM_SPARSE_PETSC_MULTIGRID_H

#include "fem/sparse/multigrid/cycle.h"
#include "fem/sparse/petsc/petsc_library.h"
#include "fem/sparse/petsc/vertex_rows.h"

typedef enum FemPetscKind { FEM_PETSC_BOOMER, FEM_PETSC_GAMG } FemPetscKind;

// BoomerAMG's options as measured on contact, friction, statics and ν = 0.45: one level of aggressive
// coarsening, which halves memory for a third more iterations. Those of several processes begin with them.
enum { FEM_PETSC_BOOMER_OPTIONS = 6 };
extern const char *const fem_petsc_boomer_options[FEM_PETSC_BOOMER_OPTIONS][2];

// The name of its solver: "amg", "gamg".
const char *fem_petsc_multigrid_name(FemPetscKind kind);

typedef struct FemPetscMultigrid {
  FemPetscKind kind;
  const FemPetscLibrary *petsc; // borrowed
  double *right, *left;         // what it is given and gives                 (rows)
  Vec right_vec, left_vec;      // views of them
  FemVertexMatrix matrix;       // kept by GAMG, whose matrix it is
  Mat view;                     // of that
  PC hierarchy;                 // of GAMG; NULL: none yet
  FemCycle cycle;               // of BoomerAMG; without levels: none yet
} FemPetscMultigrid;

// Without vectors and hierarchy; nothing is to be destroyed yet. STATUS_IO: PETSc cannot be had, or has no
// hypre.
Status fem_petsc_multigrid_open(FemPetscMultigrid *multigrid, FemPetscKind kind);
// Frees all that the calls below have made; it stays open.
void fem_petsc_multigrid_clear(FemPetscMultigrid *multigrid);

// Vectors of so many rows, for a cleared one. Clear it after a failure.
Status fem_petsc_multigrid_lay_out(FemPetscMultigrid *multigrid, int row_count);
// A new hierarchy for the matrix, in place of the one that is there; after a failure there is none.
// STATUS_RETRY: another matrix may do.
Status fem_petsc_multigrid_build(FemPetscMultigrid *multigrid, const FemVertexRows *rows,
                                 const FemMatrix *matrix);
bool fem_petsc_multigrid_is_built(const FemPetscMultigrid *multigrid);
// left ≈ A⁻¹ right.
Status fem_petsc_multigrid_apply(FemPetscMultigrid *multigrid);

#endif

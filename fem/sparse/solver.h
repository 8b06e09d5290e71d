// SPDX-License-Identifier: GPL-3.0-or-later
// Linear solvers behind one table. The condensed system S = K + c D + c² M is symmetric; a solver that works
// on the full 2n system [c I, −I; K, c M + D] takes K and D apart (klu, to compare).
#ifndef TETLAP_FEM_SPARSE_SOLVER_H
#define TETLAP_FEM_SPARSE_SOLVER_H

#include <stdbool.h>

#include "fem/sparse/matrix.h"
#include "fem/sparse/pattern.h"

typedef enum FemSolverKind {
  FEM_SOLVER_AUTO,
  FEM_SOLVER_CHOLMOD, // condensed, supernodal
  FEM_SOLVER_KLU,     // full 2n system, to compare
  FEM_SOLVER_PCG,     // condensed, block Jacobi
  FEM_SOLVER_AMG,     // condensed, conjugate gradients with BoomerAMG
  FEM_SOLVER_GAMG,    // condensed, conjugate gradients with smoothed aggregation
} FemSolverKind;

enum { FEM_SOLVER_COUNT = FEM_SOLVER_GAMG + 1 };

// Other names of two of them, which say what they are over ranks (fem_solver_provide).
typedef enum FemSolverAlias {
  FEM_SOLVER_MUMPS = FEM_SOLVER_COUNT, // cholmod: an exact factor
  FEM_SOLVER_BLOCK_JACOBI,             // pcg
} FemSolverAlias;

enum { FEM_SOLVER_NAMES = FEM_SOLVER_BLOCK_JACOBI + 1 };

typedef struct FemSolverStats {
  long long analyses, factorisations, failed_factorisations, solves, iterations;
  long long orders;      // of elimination, made anew; fewer than analyses where they are kept
  long long hierarchies; // of multigrid, made anew; fewer than factorisations where they are kept
  double analyse_s, factorise_s, solve_s; // wall [s]
  double factor_entries;
} FemSolverStats;

typedef struct FemSolverOps {
  const char *name;
  const char *help;
  bool is_condensed; // factorise is given S; else K and D
  double tolerance;  // of an iterative solver where the scene says none; 0: it has none
  // `threads` 0: as OpenMP is set. `tolerance`: relative, of iterative solvers; in (0, 1).
  Status (*create)(void **self, int threads, double tolerance);
  // The pattern is new (or has grown).
  Status (*analyse)(void *self, const FemMatrix *pattern);
  // The numbers are new; the layout must be the analysed one. Matrices and mass are borrowed until the next
  // factorise: their values must stay as they are while solve is called. RETRY: not positive definite,
  // singular, or not finite. Condensed: `damping` NULL, `mass_of_unknown` NULL. Full: `damping` may be NULL:
  // none.
  Status (*factorise)(void *self, const FemMatrix *stiffness, const FemMatrix *damping,
                      const double *mass_of_unknown, double c);
  // Condensed: solves S x = b, size n. Full: size 2n. After a factorise that went well. RETRY: no
  // convergence, or a solution that is not finite. b and x must not overlap.
  Status (*solve)(void *self, const double *b, double *x);
  // Optional, of iterative solvers whose tolerance the scene does not say: that of the solves to come, at
  // least the solver's own, as far as Newton's method needs it. 0: its own again.
  void (*aim)(void *self, double tolerance);
  // Optional, before the first analysis, of a solver without a tolerance: its solutions need not be exact
  // from now on, since they serve as a preconditioner. They are then symmetric and positive definite maps of
  // b.
  void (*be_rough)(void *self);
  // Optional, of a condensed solver in one process: how many eigenvalues of a symmetric matrix are negative,
  // by the signs of the pivots of L D Lᵀ (Sylvester). It leaves the factor alone. RETRY: a pivot is zero.
  Status (*count_negative)(const FemMatrix *matrix, int *count);
  // Optional: what was kept for the numbers to come is dropped; the next factorise begins from nothing.
  void (*forget)(void *self);
  void (*destroy)(void *self);
  const FemSolverStats *(*stats)(const void *self);
} FemSolverOps;

extern const FemSolverOps fem_solver_cholmod;
extern const FemSolverOps fem_solver_klu;
extern const FemSolverOps fem_solver_pcg;
extern const FemSolverOps fem_solver_amg;
extern const FemSolverOps fem_solver_gamg;

const char *fem_solver_name(FemSolverKind kind); // "auto", "cholmod", …
const char *fem_solver_help(FemSolverKind kind);
const FemSolverOps *fem_solver_ops(FemSolverKind kind); // not for FEM_SOLVER_AUTO

// Where ranks share the matrix (share.h) none of the above can solve it: from now on solvers come from here,
// by kind. NULL in it: there is none of that kind, and a run refuses it. NULL: those of one process again.
void fem_solver_provide(const FemSolverOps *const table[FEM_SOLVER_COUNT]);

// Whether the library of amg and gamg can be loaded; loads it.
bool fem_solver_has_multigrid(void);

// How many operations `cholmod` would take to factorise a matrix with one unknown a vertex.
Status fem_solver_factor_work(const FemPattern *pattern, double *work);

// What `create` is given for a scene's tolerance, 0: not said.
double fem_solver_tolerance(const FemSolverOps *ops, double said);

// For the solvers: OpenMP's (and so OpenBLAS's) number of threads from here on, 0: as it is. Returns the
// number before, to be given back the same way.
int fem_solver_use_threads(int threads);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Equilibrium of a system at rest: f(u, t) = 0 in the displacements alone, no velocities, no mass; half the
// unknowns of a motion. What Newton's method and relaxation share: forces, K + s M, its factors.
#ifndef TETLAP_FEM_STATICS_EQUILIBRIUM_H
#define TETLAP_FEM_STATICS_EQUILIBRIUM_H

#include "fem/effect/system.h"
#include "fem/sparse/solver.h"

typedef struct FemEquilibrium {
  FemSystem *system; // borrowed
  FemState *state;   // the one that was evaluated last, borrowed
  const FemSolverOps *ops;
  void *solver;     // of ops
  long long layout; // that was analysed; 0: none
} FemEquilibrium;

// STATUS_INPUT: a solver that is not condensed (klu).
Status fem_equilibrium_create(FemEquilibrium *equilibrium, FemSystem *system, FemState *state,
                              const FemSolverOps *ops);
void fem_equilibrium_destroy(FemEquilibrium *equilibrium); // also of a zeroed one

// Lets effects renew their lists near (time, u).
Status fem_equilibrium_renew(FemEquilibrium *equilibrium, double time, const double *u);
// Forces on the unknowns [N]. RETRY as the effects say, or if one is not a number.
Status fem_equilibrium_forces(FemEquilibrium *equilibrium, double time, const double *u, double *force);
// Factorises K + shift · M at (time, u). RETRY: not positive definite.
Status fem_equilibrium_factorise(FemEquilibrium *equilibrium, double time, const double *u, double shift);
// The same in motion, where the unknowns have the velocities v: forces, and K + damping · D + shift · M.
Status fem_equilibrium_forces_moving(FemEquilibrium *equilibrium, double time, const double *u,
                                     const double *v, double *force);
Status fem_equilibrium_factorise_moving(FemEquilibrium *equilibrium, double time, const double *u,
                                        const double *v, double damping, double shift);
// Its two halves: the system's matrix, and the factor of that as it stands.
Status fem_equilibrium_assemble_moving(FemEquilibrium *equilibrium, double time, const double *u,
                                       const double *v, double damping, double shift);
Status fem_equilibrium_factorise_assembled(FemEquilibrium *equilibrium);
// Solves with the last factor; b and x must not overlap. RETRY as of FemSolverOps.solve.
Status fem_equilibrium_solve(FemEquilibrium *equilibrium, const double *b, double *x);

// The largest absolute value.
double fem_equilibrium_largest(const double *values, int count);
// The share of a step that moves no coordinate further than a quarter of the mean edge; 1: all of it.
double fem_equilibrium_longest_share(const FemEquilibrium *equilibrium, const double *step);
// (c/L)² of the slowest body: a shift of the size of its lowest eigenvalues.
double fem_equilibrium_first_shift(const FemEquilibrium *equilibrium);

#endif

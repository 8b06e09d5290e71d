// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's linear system of the integrator as SUNDIALS sees it: a custom direct linear solver and a matrix
// without content. The Jacobian is assembled when IDA asks for one, into the system's own matrix.
//
//   IDA: Jacobian at (t, y, c) ──► fem_ida_solver_assemble ──► S = K + c D + c² M (or K and D apart)
//        set-up                ──► analyse if the layout is new, factorise
//        solve J x = b         ──► S du = r₂ + (c M + D) r₁, dv = c du − r₁
//
// c changes with every step size. Where the factor is exact, a solution at another c is found by conjugate
// gradients preconditioned with that factor, and a new matrix is assembled only where K and D have changed.
//
// Of a linear system K and D are assembled once, and S is factorised only where c is new: once for each step
// size and order.
//
// Not matrix-embedded: IDA would then factorise in every Newton iteration.
#ifndef TETLAP_FEM_TIME_IDA_SOLVER_H
#define TETLAP_FEM_TIME_IDA_SOLVER_H

#include <sundials/sundials_linearsolver.h>

#include "fem/effect/system.h"
#include "fem/sparse/solver.h"
#include "fem/time/ida/failure.h"
#include "fem/time/part.h"

typedef struct FemIdaSolver FemIdaSolver; // opaque

// `system`, `part` and `failure` are borrowed. A residual of the kinematics up to `rounding` [m/s] counts as
// zero.
Status fem_ida_solver_create(FemIdaSolver **solver, FemSystem *system, const FemPart *part,
                             const FemSolverOps *ops, double rounding, FemIdaFailure *failure,
                             SUNContext context);
void fem_ida_solver_destroy(FemIdaSolver *solver);

// Hands IDA the linear solver, its matrix, and how far c may go from the matrix's. False: IDA refuses.
bool fem_ida_solver_attach(FemIdaSolver *solver, void *ida);

// Lets effects couple at a state, assembles with c = ∂ẏ/∂y.
Status fem_ida_solver_assemble(FemIdaSolver *solver, const FemState *state, double c);

// The right-hand side of the condensed system that was solved last (part->count); NULL: the linear solver
// does not condense.
const double *fem_ida_solver_right(const FemIdaSolver *solver);

// c of the step now, and what the next solution may leave (FemSolverOps.aim), unless the scene says a
// tolerance.
void fem_ida_solver_aim(FemIdaSolver *solver, double c, double tolerance);

const double *fem_ida_solver_masses(const FemIdaSolver *solver); // of the unknowns [kg]   (part->count)
const FemSolverStats *fem_ida_solver_stats(const FemIdaSolver *solver);
// Wall time of linear systems outside of their solver: products and vectors [s].
double fem_ida_solver_product_s(const FemIdaSolver *solver);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's method for the steps of IDA, in place of SUNDIALS' own (its generic interface,
// SUNNonlinearSolver).
//
// Contact makes the equations of a step stiff on one side and soft on the other. A full Newton step that was
// predicted from the soft side lands deep in the stiff one, and SUNDIALS' method, which knows one matrix and
// four iterations, gives the step up. Here
//
// clang-format off
//   – the step along a direction δ is shortened where the condensed residual g(λ) = δu · r(u + λ δ), the slope
//     of the step's potential along δ, has changed its sign and grown (a line search by false position:
//     Matthies and Strang 1979, The solution of nonlinear finite element equations);
//   – once a new matrix did not help, directions are mixed with those before (mixing.h), so that a
//     matrix that leaves something out does not set the rate, and what goes to and fro between two states settles;
//   – where forces cannot be evaluated (beyond the contact margin, no numbers) the step is shortened as well;
//   – a matrix that makes too little way is made anew where the iteration stands, before the step is given up;
//   – what has converged by IDA's test must also balance: the caller says by how much the forces do not.
// clang-format on
#ifndef TETLAP_FEM_TIME_NEWTON_NEWTON_H
#define TETLAP_FEM_TIME_NEWTON_NEWTON_H

#include <stdbool.h>
#include <sundials/sundials_nonlinearsolver.h>

#include "base/status.h"
#include "fem/time/newton/mixing.h"

// The functions that the user of the method provides. Vectors are (2 n): displacements, velocities;
// residuals: kinematics, balance. Over ranks each has those of n unknowns (fem/time/part.h), and all go
// through the same steps.
typedef struct FemNewtonUser {
  void *self;
  int n;
  // The right-hand side of the condensed system that was solved last (n), NULL: the solver does not condense.
  const double *(*right)(void *self);
  // How far the balance (n) is from zero, as a share of what is allowed: balanced is ≤ 1.
  double (*unbalance)(void *self, const double *balance);
  // The relative residual that the next linear solution may leave (FemSolverOps.aim).
  void (*aim)(void *self, double tolerance);
} FemNewtonUser;

typedef struct FemNewton {
  SUNNonlinearSolver solver;
  FemNewtonUser user;
  SUNNonlinSolSysFn evaluate;
  SUNNonlinSolLSetupFn set_up;
  SUNNonlinSolLSolveFn solve;
  SUNNonlinSolConvTestFn test;
  void *test_data;
  N_Vector residual, direction, start; // of the size of y
  N_Vector pure;                       // the direction before it was mixed
  FemMixing mixing;
  double first_size; // of the first correction of the last solve that went well, by its weights; 0: none
  long iterations;   // of the last solve
  long failures;     // of the last solve
  int current;       // iterations since the matrix or the step was changed: what IDA's test counts
} FemNewton;

// `like`: a vector of the size of y. A zeroed one, and one whose creation failed, can be destroyed.
Status fem_newton_create(FemNewton *newton, const FemNewtonUser *user, N_Vector like, SUNContext context);
void fem_newton_destroy(FemNewton *newton);

#endif

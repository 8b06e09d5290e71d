// SPDX-License-Identifier: GPL-3.0-or-later
// A linear solver of our own as SUNDIALS sees it: custom and direct, over a matrix without content, since
// what is assembled and factorised stays with the caller.
#ifndef TETLAP_FEM_TIME_NEWTON_DIRECT_H
#define TETLAP_FEM_TIME_NEWTON_DIRECT_H

#include <sundials/sundials_linearsolver.h>

#include "base/status.h"

typedef struct FemDirect {
  SUNLinearSolver linear; // its `content` is the caller's
  SUNMatrix matrix;
} FemDirect;

// SUNDIALS' own signatures; both end in fem_direct_flag.
typedef int FemDirectSetUp(SUNLinearSolver linear, SUNMatrix matrix);
typedef int FemDirectSolve(SUNLinearSolver linear, SUNMatrix matrix, N_Vector x, N_Vector b,
                           sunrealtype tolerance);

// `content` is borrowed. A zeroed one, and one whose creation failed, can be destroyed.
Status fem_direct_create(FemDirect *direct, SUNContext context, void *content, FemDirectSetUp *set_up,
                         FemDirectSolve *solve);
void fem_direct_destroy(FemDirect *direct);

// Of a callback's answer: 0, > 0 recoverable, < 0 not.
int fem_direct_flag(int answer);

#endif

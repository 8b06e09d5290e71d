// SPDX-License-Identifier: GPL-3.0-or-later
// SUNDIALS IDA with all that it works on: y = [u; v], the system whose forces it asks for, Newton's method
// and the linear solver. memory.h makes it, equations.h is what IDA asks for, start.h begins from a state.
#ifndef TETLAP_FEM_TIME_IDA_IDA_H
#define TETLAP_FEM_TIME_IDA_IDA_H

#include "fem/effect/system.h"
#include "fem/time/error_weights.h"
#include "fem/time/ida/failure.h"
#include "fem/time/ida/solver.h"
#include "fem/time/newton/balance.h"
#include "fem/time/newton/newton.h"
#include "fem/time/part.h"

typedef struct FemIda {
  FemSystem *system;           // borrowed
  FemState *state;             // the one that was evaluated last, borrowed
  FemErrorTolerance tolerance; // of an unknown in a step
  double strictness;           // share of the tolerances of velocities that counts
  const int *groups;           // of bodies that have pressed each other, borrowed; NULL: all are one
  FemErrorGroup *group_speeds; // scratch (body_count)
  FemPart part;
  int n; // this rank's unknowns; y and ẏ have 2n
  SUNContext context;
  void *memory; // IDA's
  FemIdaSolver *solver;
  FemIdaFailure failure;
  FemNewton newton;
  FemBalance balance;
  N_Vector y, y_dot;     // state that the last step or restart ended at
  N_Vector interpolated; // scratch, and the solution within a step
  N_Vector evaluated;    // of the last residual
  double evaluated_time; // [s]
  N_Vector weights;      // scratch: of the error test
} FemIda;

// u and v of all vertices, of all ranks, into the state.
void fem_ida_scatter(FemIda *ida, double time, N_Vector y);

static inline double *fem_ida_values(N_Vector vector) {
  return N_VGetArrayPointer(vector);
}

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/ida/failure.h"

#include <ida/ida.h>
#include <stdio.h>

int fem_ida_failure_answer(FemIdaFailure *failure, Status status) {
  if (status == STATUS_OK) return 0;
  if (status > 0) {
    snprintf(failure->retry_message, sizeof failure->retry_message, "%s", status_message());
    return 1;
  }
  failure->fatal = status;
  snprintf(failure->fatal_message, sizeof failure->fatal_message, "%s", status_message());
  return -1;
}

FemReason fem_ida_failure_reason(int flag) {
  switch (flag) {
  case IDA_ERR_FAIL:
    return (FemReason){"the error of a step stayed above the tolerance however short the step",
                       "a larger time.tolerance, a smaller contact.stiffness, some effects.damping, or a "
                       "smaller time.min_step if the scene names one"};
  case IDA_CONV_FAIL:
  case IDA_LSETUP_FAIL:
  case IDA_LSOLVE_FAIL:
  case IDA_NLS_FAIL:
    return (FemReason){"Newton's method did not converge however short the step",
                       "a smaller contact.stiffness, some effects.damping, a smaller time.min_step, or "
                       "solver.linear: cholmod"};
  case IDA_RES_FAIL:
  case IDA_REP_RES_ERR:
    return (FemReason){"the forces could not be evaluated however short the step",
                       "a smaller time.max_step, or a larger contact.margin"};
  case IDA_TOO_MUCH_ACC:
    return (FemReason){"a value is so large that its last digit is coarser than the tolerance",
                       "a smaller value (velocity, spin, place, or a formula of the scene); where it is "
                       "meant, a larger time.tolerance"};
  default:
    return (FemReason){"IDA gave up", "a larger time.tolerance, or a smaller contact.stiffness"};
  }
}

int fem_ida_failure_worst(void *ida, int flag, const FemPart *part, N_Vector errors, N_Vector weights) {
  int n = part->count;
  if (flag == IDA_ERR_FAIL && IDAGetEstLocalErrors(ida, errors) == IDA_SUCCESS &&
      IDAGetErrWeights(ida, weights) == IDA_SUCCESS)
    return fem_part_worst(part, N_VGetArrayPointer(errors), N_VGetArrayPointer(weights), 0, 2 * n);
  double time, c;
  if (flag == IDA_TOO_MUCH_ACC && IDAGetCurrentTime(ida, &time) == IDA_SUCCESS &&
      IDAGetDky(ida, time, 0, errors) == IDA_SUCCESS && IDAGetErrWeights(ida, weights) == IDA_SUCCESS)
    return fem_part_worst(part, N_VGetArrayPointer(errors), N_VGetArrayPointer(weights), 0, 2 * n);
  N_Vector y, y_dot, y_predicted, y_dot_predicted, r;
  void *self;
  if (IDAGetNonlinearSystemData(ida, &time, &y_predicted, &y_dot_predicted, &y, &y_dot, &r, &c, &self) ==
          IDA_SUCCESS &&
      r)
    return fem_part_worst(part, N_VGetArrayPointer(r), NULL, n, 2 * n);
  return 0;
}

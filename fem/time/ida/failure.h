// SPDX-License-Identifier: GPL-3.0-or-later
// Failures on their way through IDA. A Status becomes the integer that a callback answers, IDA's flag for a
// step that failed a reason and the unknown where it is worst.
#ifndef TETLAP_FEM_TIME_IDA_FAILURE_H
#define TETLAP_FEM_TIME_IDA_FAILURE_H

#include <sundials/sundials_nvector.h>

#include "fem/time/part.h"
#include "fem/time/reason.h"

enum { FEM_IDA_MESSAGE_SIZE = 1024 };

// What callbacks could not say through IDA: the fatal status that ended the run, and why the last steps were
// refused.
typedef struct FemIdaFailure {
  Status fatal;                             // STATUS_OK: none
  char fatal_message[FEM_IDA_MESSAGE_SIZE]; // "" without
  char retry_message[FEM_IDA_MESSAGE_SIZE]; // "" if nothing asked for a retry since it was cleared
} FemIdaFailure;

// Keeps the thread's message and returns what IDA's callbacks must: 0, 1 (recoverable) or −1.
int fem_ida_failure_answer(FemIdaFailure *failure, Status status);

// What a flag of IDASolve below 0 means, and what may help.
FemReason fem_ida_failure_reason(int flag);

// The number among the 2·part->n of the unknown to blame: with the largest estimated error if the error test
// failed (IDA_ERR_FAIL); with the largest value beside its tolerance if that is finer than the value's digits
// (IDA_TOO_MUCH_ACC); else with the largest unbalanced force. 0: IDA does not say. By all ranks. `errors`,
// `weights`: scratch.
int fem_ida_failure_worst(void *ida, int flag, const FemPart *part, N_Vector errors, N_Vector weights);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Why a step was given up, in words: what happened, where it is worst, and what may help.
#ifndef TETLAP_FEM_TIME_REASON_H
#define TETLAP_FEM_TIME_REASON_H

#include "fem/effect/system.h"

typedef struct FemReason {
  const char *what, *advice;
} FemReason;

typedef struct FemReasonPlace {
  double time, step; // [s]
  const double *positions, *velocities;
  int unknown;       // the one with the largest error or unbalanced force
  bool is_position;  // of its position, else of its velocity
  const char *retry; // what asked last for a smaller step; empty: nothing did
} FemReasonPlace;

// STATUS_SOLVER, with a message that names vertex, body, position, velocity if that is worst, of its elements
// the one that is squeezed most, and elements that are inside out with what their law bears.
Status fem_reason_fail(const FemReason *reason, const FemSystem *system, const FemReasonPlace *place);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a step of a run stands. IDA's error test and Newton's method have let it pass; what a run promises
// (fem/model/limits.h) is decided here, from what was found at the state that the step leads to.
//
// A step that does not stand is tried again from the last accepted state with FEM_CUT of its length. Steps in
// which nothing moves are not tried: what they gain or miss is part of what is reported at the end. A stiff
// contact may give energy in less time than a wave moves anything in. Momentum that such steps miss comes
// back as the force falls, so for it they are not tried. A step whose forces cannot be evaluated never
// stands: it is cut down to the shortest step, and then the run fails.
#ifndef TETLAP_FEM_TIME_VERDICT_H
#define TETLAP_FEM_TIME_VERDICT_H

#include <stdbool.h>

typedef enum FemCause {
  FEM_CAUSE_NONE,
  FEM_CAUSE_FORCES,   // they cannot be evaluated there, or at a frame within the step
  FEM_CAUSE_ENERGY,   // it gains energy (fem/time/audit.h)
  FEM_CAUSE_MOMENTUM, // forces and motion differ (fem/measure/momentum.h)
  FEM_CAUSE_REVERSAL  // friction acts along a slip that has reversed within it
} FemCause;

typedef struct FemFindings {
  double length;   // of the step [s]
  double shortest; // step that the integrator may take [s]
  double resolved; // in less no wave moves anything [s]
  double rebound;  // in less contact moves nothing either [s]
  bool is_evaluated, gains_energy, differs_from_motion;
  double reversed; // what friction gave to a slip that has reversed, as a share of the scene's energy
} FemFindings;

typedef struct FemVerdict {
  bool stands;
  FemCause cause; // also of a step that stands since no shorter one is left
  double step;    // to be tried again; 0: none is left [s]
} FemVerdict;

FemVerdict fem_verdict_of(const FemFindings *findings);

// "it gains energy", for the log.
const char *fem_verdict_words(FemCause cause);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Where the next step of a motion ends at the latest, and how long it may be.
//
// It does not pass a knot of what is prescribed that could not be followed otherwise, nor go farther than
// effects can follow (contact lists hold so far).
#ifndef TETLAP_FEM_TIME_STOP_H
#define TETLAP_FEM_TIME_STOP_H

#include "fem/effect/system.h"

typedef struct FemStopDef {
  const FemSystem *system; // borrowed
  double begin, end;       // of the step; which it does not pass [s]
  double planned;          // its length, as the method would have it [s]
  double max_step;         // [s]
  double least;            // shorter steps are not taken; times that are nearer count as one [s]
  double displacement;     // tolerances by which what is prescribed is followed (fem/scene/signal.h) [m]
  double velocity;         // [m/s]
  bool may_halve;          // two equal steps may take the place of one and a short one
} FemStopDef;

typedef struct FemStop {
  double time;    // [s]
  double longest; // no step may be longer [s]
  bool is_knot;   // the time lies just before a knot
} FemStop;

FemStop fem_stop_choose(const FemStopDef *def);

#endif

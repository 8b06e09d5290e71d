// SPDX-License-Identifier: GPL-3.0-or-later
// A function of time that the scene prescribes (a motion, the factor of a load), and how long a step along it
// may be. An integrator evaluates such a function only where its steps end, so it could miss what lasts for
// less than a step. Therefore a step may end only where the cubic through values and rates at both ends
// follows the function in between. If it does not, the step ends at an earlier knot: a time at which the
// function has a kink or a jump.
#ifndef TETLAP_FEM_SCENE_SIGNAL_H
#define TETLAP_FEM_SCENE_SIGNAL_H

#include <stdbool.h>

// The largest change that a step may miss.
typedef struct FemForesight {
  double displacement; // of what is moved [m]
  double velocity;     // that a load gives a vertex [m/s]
  double resolution;   // knots that are closer count as one [s]
  // Statics: steps of load are straight, so the chord takes the cubic's place, a load is followed to this
  // share of its change, and only knots end a step. 0: dynamics.
  double static_share;
} FemForesight;

typedef struct FemSignal {
  const void *def;
  // Values of one unit and their rates, those not used zero; at a knot from there on.
  void (*eval)(const void *def, double time, double value[3], double rate[3]);
  double (*next_knot)(const void *def, double time); // after `time`; INFINITY: none
  bool is_curved;                                    // it is not straight between knots
  double deviation;                                  // from the cubic that is allowed,
  double impulse;                                    // times the step, INFINITY: any
} FemSignal;

// The latest time up to `farthest` where a step from `time` may end: `farthest` itself, or a knot, or a time
// between knots that are far apart where the function bends too much. Knots within the resolution from `time`
// are left behind, such before `farthest` are left to the next step.
double fem_signal_horizon(const FemSignal *signal, const FemForesight *foresight, double time,
                          double farthest);

// Just before a knot, by more than rounding: there a step ends that is not to see what begins at the knot.
double fem_signal_before(double knot);
// From such a time just past the knot.
double fem_signal_past(double before);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// What each unknown may err by in a step: the tolerances of IDA's error test.
//
// Positions may err by a length, velocities by a share of what moves. Where bodies strike each other at a
// speed v, their surfaces change theirs by v; an error far below that costs steps and changes nothing. So a
// velocity may err by `speed_share` of the present speed of the fastest body of its group, and by `velocity`
// at least. A group are bodies that have pressed each other; others' speeds are nothing to a body. Its speed
// is the root mean square over its mass, relative to the common velocity of the group (fem/model/floating.h).
// It counts up to the √(E/ρ), the speed of waves, of the body whose velocity may err. Groups are part of
// what a checkpoint keeps, so a resumed run has the same weights.
#ifndef TETLAP_FEM_TIME_ERROR_WEIGHTS_H
#define TETLAP_FEM_TIME_ERROR_WEIGHTS_H

#include "base/vec3.h"
#include "fem/time/part.h"

typedef struct FemErrorTolerance {
  double displacement; // [m]
  double velocity;     // at least [m/s]
  double speed_share;  // of the fastest body's speed; 0: `velocity` is all
} FemErrorTolerance;

// Numbers only, which ranks add up.
typedef struct FemErrorGroup {
  double mass;  // [kg]
  double p[3];  // [kg m/s]
  double speed; // of its fastest body [m/s]
} FemErrorGroup;

// The weights 1/tolerance of u and v (2 · part->count) at the velocities v (part->count). `groups`: of each
// body the number of its group, that of one of its bodies; NULL: all are one. `scratch` (body_count). By all
// ranks.
void fem_error_weights(const FemErrorTolerance *tolerance, const FemModel *model, const FemPart *part,
                       const int *groups, const double *v, FemErrorGroup *scratch, double *weights);

// The common velocity (fem/model/floating.h) of velocities v (part->count). By all ranks.
Vec3 fem_error_weights_common(const FemModel *model, const FemPart *part, const double *v);

#endif

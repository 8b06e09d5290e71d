// SPDX-License-Identifier: GPL-3.0-or-later
// What a start from a state needs beside it: accelerations, and the length of the first step.
#ifndef TETLAP_FEM_TIME_IDA_START_H
#define TETLAP_FEM_TIME_IDA_START_H

#include "fem/time/ida/ida.h"

// v̇ = M⁻¹ f at (time, ida->y), and ida->y_dot = [v; v̇]. STATUS_SOLVER: a number is not finite.
Status fem_ida_start_derivatives(FemIda *ida, double time);

// The first step of a start that is left to IDA [s]; 0: IDA's own will do. It will not where it would go by
// a velocity that nothing can notice. Where something is driven from rest with a jump of its speed,
// accelerations are large for a time in which nothing moves. They say nothing of how long a step may be; the
// error test does. So no step shorter than `shortest` [s] is chosen.
double fem_ida_start_step(FemIda *ida, double time, double end, double shortest);

#endif

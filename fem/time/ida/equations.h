// SPDX-License-Identifier: GPL-3.0-or-later
// What IDA and Newton's method ask for: functions of IDA's own forms, whose last `self` is a FemIda.
#ifndef TETLAP_FEM_TIME_IDA_EQUATIONS_H
#define TETLAP_FEM_TIME_IDA_EQUATIONS_H

#include <sundials/sundials_matrix.h>

#include "fem/time/ida/ida.h"

// r = [u̇ − v; M v̇ − f(u, v, t)]
int fem_ida_equations_residual(sunrealtype time, N_Vector y, N_Vector y_dot, N_Vector r, void *self);

// Assembles the system's matrix; IDA's `matrix` has no content.
int fem_ida_equations_jacobian(sunrealtype time, sunrealtype c, N_Vector y, N_Vector y_dot, N_Vector r,
                               SUNMatrix matrix, void *self, N_Vector scratch1, N_Vector scratch2,
                               N_Vector scratch3);

// Weights of the error test. IDA asks before every step.
int fem_ida_equations_weights(N_Vector y, N_Vector weights, void *self);

// What Newton's method asks for, of `ida`.
FemNewtonUser fem_ida_equations_user(FemIda *ida);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab solver`: what the linear solvers take for one Newton set-up and one solution of a beam.
//
// The beam (builtin.h) is taken bent, so that no stiffness is zero by symmetry, at the c = 3/(2h) that
// BDF of order 2 has at a step h. The layout is analysed once; then every round assembles the solver's
// matrices, factorises and solves for the forces of that state. The solutions are checked: a row tells the
// residual of the condensed system.
#ifndef TETLAP_LAB_SCENE_SOLVER_H
#define TETLAP_LAB_SCENE_SOLVER_H

#include "app/cli/command.h"

extern const AppCommand lab_solver;

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The linear solvers that benches compare.
#ifndef TETLAP_LAB_SCENE_SOLVERS_H
#define TETLAP_LAB_SCENE_SOLVERS_H

#include <argp.h>
#include <stdbool.h>

#include "fem/sparse/solver.h"

enum { LAB_SCENE_SOLVER_COUNT = 5 };

extern const FemSolverKind lab_scene_solvers[LAB_SCENE_SOLVER_COUNT];

// Of --solver: marks each one that is named in `wanted`, the others not.
void lab_scene_solvers_choose(struct argp_state *state, char *text, bool wanted[LAB_SCENE_SOLVER_COUNT]);

#endif

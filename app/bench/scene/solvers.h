// SPDX-License-Identifier: GPL-3.0-or-later
// The linear solvers that benches compare.
#ifndef TETLAP_APP_BENCH_SCENE_SOLVERS_H
#define TETLAP_APP_BENCH_SCENE_SOLVERS_H

#include <argp.h>
#include <stdbool.h>

#include "fem/sparse/solver.h"

enum { APP_BENCH_SOLVER_COUNT = 5 };

extern const FemSolverKind app_bench_solvers[APP_BENCH_SOLVER_COUNT];

// Of --solver: marks each one that is named in `wanted`, the others not.
void app_bench_solvers_choose(struct argp_state *state, char *text, bool wanted[APP_BENCH_SOLVER_COUNT]);

#endif

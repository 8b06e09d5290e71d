// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/scene/solvers.h"

#include "app/bench/options.h"

const FemSolverKind app_bench_solvers[APP_BENCH_SOLVER_COUNT] = {
    FEM_SOLVER_CHOLMOD, FEM_SOLVER_AMG, FEM_SOLVER_GAMG, FEM_SOLVER_PCG, FEM_SOLVER_KLU};

void app_bench_solvers_choose(struct argp_state *state, char *text, bool wanted[APP_BENCH_SOLVER_COUNT]) {
  const char *names[APP_BENCH_SOLVER_COUNT];
  for (int s = 0; s < APP_BENCH_SOLVER_COUNT; s++) names[s] = fem_solver_name(app_bench_solvers[s]);
  app_bench_options_choose(state, "solver", text, names, APP_BENCH_SOLVER_COUNT, wanted);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/scene/solvers.h"

#include "app/bench/options.h"

const FemSolverKind lab_scene_solvers[LAB_SCENE_SOLVER_COUNT] = {
    FEM_SOLVER_CHOLMOD, FEM_SOLVER_AMG, FEM_SOLVER_GAMG, FEM_SOLVER_PCG, FEM_SOLVER_KLU};

void lab_scene_solvers_choose(struct argp_state *state, char *text, bool wanted[LAB_SCENE_SOLVER_COUNT]) {
  const char *names[LAB_SCENE_SOLVER_COUNT];
  for (int s = 0; s < LAB_SCENE_SOLVER_COUNT; s++) names[s] = fem_solver_name(lab_scene_solvers[s]);
  app_bench_options_choose(state, "solver", text, names, LAB_SCENE_SOLVER_COUNT, wanted);
}

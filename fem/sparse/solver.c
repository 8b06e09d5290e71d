// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/solver.h"

#include <assert.h>
#include <omp.h>
#include <stddef.h>

static const FemSolverOps *const *provided;

static const FemSolverOps *ops_of_one(FemSolverKind kind) {
  switch (kind) {
  case FEM_SOLVER_CHOLMOD:
    return &fem_solver_cholmod;
  case FEM_SOLVER_KLU:
    return &fem_solver_klu;
  case FEM_SOLVER_PCG:
    return &fem_solver_pcg;
  case FEM_SOLVER_AMG:
    return &fem_solver_amg;
  case FEM_SOLVER_GAMG:
    return &fem_solver_gamg;
  case FEM_SOLVER_AUTO:
    break;
  }
  assert(!"a solver that is not in the table");
  return NULL;
}

const char *fem_solver_name(FemSolverKind kind) {
  return kind == FEM_SOLVER_AUTO ? "auto" : ops_of_one(kind)->name;
}

const char *fem_solver_help(FemSolverKind kind) {
  return kind == FEM_SOLVER_AUTO ? "chosen by the scene" : ops_of_one(kind)->help;
}

void fem_solver_provide(const FemSolverOps *const table[FEM_SOLVER_COUNT]) {
  provided = table;
}

const FemSolverOps *fem_solver_ops(FemSolverKind kind) {
  return provided && provided[kind] ? provided[kind] : ops_of_one(kind);
}

double fem_solver_tolerance(const FemSolverOps *ops, double said) {
  return said > 0 ? said : ops->tolerance;
}

int fem_solver_use_threads(int threads) {
  int before = omp_get_max_threads();
  if (threads > 0 && threads != before) omp_set_num_threads(threads);
  return before;
}

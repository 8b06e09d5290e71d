// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/result/run_clock.h"

#include "base/machine/clock.h"

static double solver_s(const FemSolverStats *stats) {
  return stats->analyse_s + stats->factorise_s + stats->solve_s;
}

// Given to phases until now.
static double named_s(const FemRunState *run) {
  FemRunPhases phases = run->result->cost.phases;
  fem_run_result_add_phases(&phases, &run->system);
  double sum =
      fem_run_result_named_s(&phases) + solver_s(&run->result->matrix.solver) + run->recorder.seconds;
  const FemEquilibrium *equilibrium = &run->statics.equilibrium;
  if (equilibrium->solver) sum += solver_s(equilibrium->ops->stats(equilibrium->solver));
  if (run->integrator)
    sum += solver_s(fem_integrator_solver_stats(run->integrator)) + fem_integrator_product_s(run->integrator);
  return sum;
}

FemRunSpan fem_run_clock_begin(const FemRunState *run) {
  return (FemRunSpan){clock_wall_s(), named_s(run)};
}

void fem_run_clock_end(const FemRunState *run, FemRunSpan span, double *phase) {
  *phase += clock_wall_s() - span.began_s - (named_s(run) - span.named_s);
}

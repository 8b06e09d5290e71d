// SPDX-License-Identifier: GPL-3.0-or-later
// Time: SUNDIALS IDA on y = [u; v], F = [u̇ − v; M v̇ − f(u, v, t)], BDF of order ≤ 2, rtol = 0.
//
// A custom direct linear solver condenses each Newton system to S du = r₂ + (c M + D) r₁, dv = c du − r₁ with
// S = K + c D + c² M. Frames are interpolated, never stopped at. A contact onset (root of the system's gap)
// restarts the method at the root with recomputed accelerations.
#ifndef TETLAP_FEM_INTEGRATOR_H
#define TETLAP_FEM_INTEGRATOR_H

#include "fem/solver.h"
#include "fem/system.h"

typedef struct FemIntegratorDef {
  double displacement_tolerance;           // [m]
  double velocity_tolerance;               // [m/s]
  double initial_step, min_step, max_step; // [s]; 0: chosen
  int max_order;                           // 1 or 2
  double end;                              // [s]
} FemIntegratorDef;

typedef struct FemIntegratorStats {
  long long steps, setups, newton_iterations, error_test_failures, newton_failures, residuals, restarts,
      roots;
  long long rejected_by_energy;
  double last_step, current_step; // [s]
  int last_order;
} FemIntegratorStats;

typedef struct FemIntegrator FemIntegrator; // opaque: IDA hides behind

Status fem_integrator_create(FemIntegrator **integrator, FemSystem *system, const FemSolverOps *solver,
                             const FemIntegratorDef *def);
void fem_integrator_destroy(FemIntegrator *integrator);

// One accepted step, or up to an onset. `*is_onset` tells which. STATUS_SOLVER: gave up; the message says at
// what time and step size, why, and what to try.
Status fem_integrator_step(FemIntegrator *integrator, double *time, bool *is_onset);

// The solution at a time within the last step; u, v of size n, borrowed until the next call.
Status fem_integrator_at(FemIntegrator *integrator, double time, const double **u, const double **v);

// Begins anew from (time, u, v) at order 1 with accelerations recomputed from the forces; `step` 0: IDA's
// choice.
Status fem_integrator_restart(FemIntegrator *integrator, double time, const double *u, const double *v,
                              double step);

FemIntegratorStats fem_integrator_stats(const FemIntegrator *integrator);
const FemSolverStats *fem_integrator_solver_stats(const FemIntegrator *integrator);

#endif

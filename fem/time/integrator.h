// SPDX-License-Identifier: GPL-3.0-or-later
// Time: SUNDIALS IDA on y = [u; v], F = [u̇ − v; M v̇ − f(u, v, t)], BDF of order ≤ 2, rtol = 0.
//
// A custom direct linear solver condenses each Newton system to S du = r₂ + (c M + D) r₁, dv = c du − r₁ with
// S = K + c D + c² M (ida/solver.h). Frames are interpolated, never stopped at. A step ends at the end and,
// where what is prescribed could not be followed otherwise, just before a knot of it (signal.h).
//
//   create ─► restart (first state) ─► step ─► at … ─► (accept) ─► step ─► …
//                  ▲                    │ a state to go back to
//                  └────────────────────┘
#ifndef TETLAP_FEM_TIME_INTEGRATOR_H
#define TETLAP_FEM_TIME_INTEGRATOR_H

#include "fem/effect/system.h"
#include "fem/sparse/solver.h"
#include "fem/time/stall.h"

typedef struct FemIntegratorDef {
  double displacement_tolerance;           // error per step of every unknown [m]
  double velocity_tolerance;               // [m/s]; at least, where the next is given
  double speed_share;                      // a further tolerance of a velocity (error_weights.h); 0: none
  double initial_step, min_step, max_step; // [s]; 0: chosen
  double least_start;                      // first step of a start that IDA chooses, at least [s]; 0: any
  int max_order;                           // 1 or 2
  double end;                              // [s]
  FemStall *stall;                         // of the run, borrowed; NULL: of this integrator alone, from t = 0
} FemIntegratorDef;

// Counted over all restarts. A step that is taken back, by a restart at an earlier time, is no step, but its
// evaluations count.
typedef struct FemIntegratorStats {
  long long steps, setups, newton_iterations, error_test_failures;
  long long newton_failures; // steps tried again because Newton, a solver or a force asked for it
  long long residuals;
  long long restarts;             // without the first
  double last_step, current_step; // taken, and to be tried next [s]
  int last_order;
} FemIntegratorStats;

typedef struct FemIntegrator FemIntegrator; // opaque: IDA hides behind

// `system` is borrowed, and `state`, which each evaluation fills. The linear solver takes its threads and
// tolerance from the system's scene.
// STATUS_INPUT: a tolerance, step or end that makes no sense.
Status fem_integrator_create(FemIntegrator **integrator, FemSystem *system, FemState *state,
                             const FemSolverOps *solver, const FemIntegratorDef *def);
void fem_integrator_destroy(FemIntegrator *integrator);

// Begins (anew) from any (time, u, v), at order 1, with accelerations computed from the forces; `step` 0:
// IDA's choice (the first time: def.initial_step). u and v may be the integrator's own arrays. RETRY: the
// forces cannot be evaluated there.
Status fem_integrator_restart(FemIntegrator *integrator, double time, const double *u, const double *v,
                              double step);

// The shortest step that it takes [s].
double fem_integrator_shortest_step(const FemIntegrator *integrator);

// No step passes that time [s], until another is set; INFINITY: any may. Where a step would end near it, two
// equal ones lead there.
void fem_integrator_aim(FemIntegrator *integrator, double target);

// From the next step on velocities may err by this share of their tolerances, at most 1, which go by the
// speeds in a body's group (fem/time/error_weights.h): of each body its number, borrowed.
void fem_integrator_tighten(FemIntegrator *integrator, double share, const int *groups);

// One accepted step. STATUS_SOLVER: gave up; the message says at what time and step size, why, and what to
// try. A fatal Status of an effect or a solver comes out as it is.
Status fem_integrator_step(FemIntegrator *integrator, double *time);

// Whether that step ended just before a knot of what is prescribed (signal.h): velocities and forces may be
// others from there on.
bool fem_integrator_is_at_knot(const FemIntegrator *integrator);

// The solution at a time within the last step, at its end to the last bit, or where a restart began; u, v of
// size n, by all ranks, borrowed until the next call.
Status fem_integrator_at(FemIntegrator *integrator, double time, const double **u, const double **v);

FemIntegratorStats fem_integrator_stats(const FemIntegrator *integrator);
const FemSolverStats *fem_integrator_solver_stats(const FemIntegrator *integrator);
// Wall time of linear systems outside of their solver: products and vectors [s].
double fem_integrator_product_s(const FemIntegrator *integrator);

#endif

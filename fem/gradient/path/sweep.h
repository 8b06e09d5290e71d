// SPDX-License-Identifier: GPL-3.0-or-later
// The adjoint of a replay's steps, step by step backwards: the systems of fem/gradient/path/path.h, solved
// for each goal.
#ifndef TETLAP_FEM_GRADIENT_PATH_SWEEP_H
#define TETLAP_FEM_GRADIENT_PATH_SWEEP_H

#include "fem/gradient/gradient.h"
#include "fem/gradient/path/replay.h"

// The derivatives of one goal g at a step. V: the model's vertices, n: its unknowns.
typedef struct FemSweepGoal {
  double *beta, *alpha; // β, α of this step and of the two after it             (3, n)
  // What friction at the step after this one has handed to this one:
  double *places;         // ∂g by positions                                     (3 V)
  double (*histories)[3]; // ∂g by the entries of friction's history             (history_count)
  double (*moves)[3];     // Σ of `places` over side 0 of each interface         (interface_count)
  size_t capacity;        // of `histories`
  // At this step:
  FemFriction friction; // only where the scene has friction
  FemDamping damping;
  FemYielding yielding;
  FemAnswers answers; // only where derivatives by weights are wanted
} FemSweepGoal;

typedef struct FemSweep {
  const FemGradientDef *def; // borrowed
  FemReplay replay;
  FemTangent tangent; // at the step
  FemVaried varied;
  FemChange change; // by one parameter at the step
  FemKrylov krylov;
  FemFriction scratch;
  FemDamping damping;      // scratch
  FemSweepGoal *goals;     //                                         (goal_count)
  double *slope;           // ∂g/∂x of each goal by itself            (goal_count, 3 V)
  double *factors;         // ∂g/∂q of the terms of all goals
  double *lambda, *weight; // scratch                                 (3 V)
  double *right;           // what is left of the step's system       (n)
  double *correction;      // scratch                                 (n)
  double *diagonal;        // of the step's matrix                    (n)
  int step, factorised;    // where it is; of which step the factor is, 0: of none
  bool is_spent;           // that factor does not serve any more
  bool is_light;           // at the step mass dominates (fem/gradient/path/dominance.h)
} FemSweep;

// STATUS_MEMORY, or as the replay's creation. Destroy it also after a failure.
Status fem_sweep_create(FemSweep *sweep, const FemModel *model, const FemGradientDef *def,
                        const FemReplaySteps *steps);
void fem_sweep_destroy(FemSweep *sweep);

size_t fem_sweep_value_count(const FemSweep *sweep); // 3 V
bool fem_sweep_has_friction(const FemSweep *sweep);
bool fem_sweep_is_last(const FemSweep *sweep); // whether the step is the replay's last

// β of a goal at the step (n).
double *fem_sweep_beta(const FemSweep *sweep, const FemSweepGoal *goal);
// a₁ y_{k+1} + a₂ y_{k+2} of an unknown, with the formulas of these steps; `ring`: a goal's β or α.
double fem_sweep_carried(const FemSweep *sweep, double *ring, int k, int i);
// sign · x of the unknowns into `lambda`, 0 elsewhere.
void fem_sweep_spread(FemSweep *sweep, const double *x, double sign);

// ∂g/∂x of a goal at the step, at fixed velocities; once the step is solved, less K λ.
double fem_sweep_slope(const FemSweep *sweep, int g, size_t dof);
// ∂g/∂v likewise.
double fem_sweep_rate(const FemSweep *sweep, int g, size_t dof);

// Finds how the step, at which the tangent is, is solved. To be called before its first solution.
void fem_sweep_begin_step(FemSweep *sweep);
// Solves the step for a goal whose own derivatives are there: β, α, and what is left of ∂g/∂x and ∂g/∂v on
// the prescribed coordinates. `largest` grows to its residual. STATUS_SOLVER: the residual is too large
// (fem_gradient_judge).
Status fem_sweep_solve_step(FemSweep *sweep, int g, double *largest);

#endif

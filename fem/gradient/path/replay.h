// SPDX-License-Identifier: GPL-3.0-or-later
// A run done again with the ends of its steps kept, each step balanced to rounding. A motion goes by backward
// differences of second order (the first step of first order),
//
//   v_n = c u_n + a₁ u_{n−1} + a₂ u_{n−2},   M (c v_n + a₁ v_{n−1} + a₂ v_{n−2}) = f(u_n, t_n; history),
//
// a static scene from equilibrium to equilibrium (c = a₁ = a₂ = 0). The replay differs from the run by the
// error of its steps. In a motion one matrix serves many steps, also of other lengths
// (fem/gradient/path/inverse.h); Newton's steps by it are scaled and mixed (fem/time/newton/mixing.h). The
// matrices of friction, of damping and of following pressures are not exact. With these, systems are solved
// by GMRES on differences of forces, always in a static scene, and in a motion where a new matrix gets on no
// better.
#ifndef TETLAP_FEM_GRADIENT_PATH_REPLAY_H
#define TETLAP_FEM_GRADIENT_PATH_REPLAY_H

#include "fem/gradient/path/inverse.h"
#include "fem/gradient/path/replay_steps.h"
#include "fem/sparse/krylov.h"
#include "fem/time/newton/mixing.h"

// ẏ_n = c y_n + near y_{n−1} + far y_{n−2}
typedef struct FemReplayFormula {
  double c, near, far;
} FemReplayFormula;

typedef struct FemReplay {
  const FemReplaySteps *steps; // borrowed
  FemSystem system;
  FemState before, state; // of the step before, and the one under trial
  FemInverse inverse;     // serves the next step, too
  FemEquilibrium adjoint; // of the way back; its factor serves on where the replay begins anew
  FemKrylov krylov;       // where the matrix is not near J
  FemMixing mixing;
  double *weights; // of its norm, 1                            (n)
  double share;    // that is taken of its steps
  void *stick;     // friction's effect, borrowed; NULL: none
  void *plastic;   // that of plasticity, borrowed; NULL: none
  bool is_near;    // the matrix is near J: no friction, damping, following pressure
  int n;           // unknowns
  FemReplayPlan plan;
  int segment;                 // the one in memory
  double *u, *v;               // of its steps, and of some before them      (rows, n)
  double *saved;               // u, v of the last steps before each segment (segments, 2, FEM_REPLAY_LEAD, n)
  double *force, *step;        // scratch                                   (n)
  double *ahead, *aside;       // scratch, where the matrix is not exact    (n)
  double *rate;                // the same, velocities                      (n)
  FemEffectHistory *histories; // of segments' ends, of steps between (segments + length, effect_count)
  unsigned char *yielded;      // whether a point yielded in the last step    (points of plasticity)
  unsigned char *slips;        // 0: apart, 1: sticks, 2: slips             (interfaces, contact vertices)
  double spent_s;              // processor time of its steps, also where they are done again [s]
  double worst;                // what is left in a step, as a share of the largest force
  long long switches;          // between sticking and slipping, of vertices from step to step
  long long yields;            // points that began or ceased to yield from step to step
  double c;                    // of the step that GMRES works on
  const double *middle, *speed; // its u, its v; borrowed
} FemReplay;

Status fem_replay_create(FemReplay *replay, const FemModel *model, const FemReplaySteps *steps);
void fem_replay_destroy(FemReplay *replay); // also of a zeroed one

// STATUS_SOLVER: a step cannot be balanced; the message says which.
Status fem_replay_go(FemReplay *replay);
// Puts `state` to step k as it was found and `before` to step k − 1. To be called from the last step on, one
// by one; a segment may be done again for it.
Status fem_replay_return(FemReplay *replay, int k);
// v of step k, which is there (n); before it in memory that of the steps before, as many as the formula
// needs.
const double *fem_replay_v(const FemReplay *replay, int k);
// What effects remember after step k, which is in memory or ends a segment              (effect_count).
FemEffectHistory *fem_replay_histories(const FemReplay *replay, int k);
// Factorises K + c D + c² M at step k, to which the replay has returned, in `adjoint`.
Status fem_replay_factorise(FemReplay *replay, int k);

// The formula of step k; before and beyond the steps, and in a static scene, 0.
FemReplayFormula fem_replay_formula(const FemReplay *replay, int k);
double fem_replay_mass(const FemReplay *replay, int unknown); // [kg]
// The status of step k: a failure becomes STATUS_SOLVER and an interruption is named, both with the time of
// the step.
Status fem_replay_end(const FemReplay *replay, int k, Status status);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// A run done again with the ends of its steps frozen, each step balanced to rounding. A motion goes by
// backward differences of second order (the first step of first order),
//
//   v_n = c u_n + a₁ u_{n−1} + a₂ u_{n−2},   M (c v_n + a₁ v_{n−1} + a₂ v_{n−2}) = f(u_n, t_n; history),
//
// a static scene from equilibrium to equilibrium (c = a₁ = a₂ = 0). The replay differs from the run by the
// error of its steps. In a motion a factor serves many steps, Newton's steps by it are mixed
// (fem/time/newton/mixing.h). The matrices of friction, of damping and of following pressures are not exact;
// in a static scene, and where a new one gets on no better, systems are solved by GMRES on differences of
// forces.
#ifndef TETLAP_FEM_GRADIENT_PATH_REPLAY_H
#define TETLAP_FEM_GRADIENT_PATH_REPLAY_H

#include "fem/gradient/path/replay_steps.h"
#include "fem/sparse/krylov.h"
#include "fem/statics/equilibrium.h"
#include "fem/time/newton/mixing.h"

// ẏ_n = c y_n + near y_{n−1} + far y_{n−2}
typedef struct FemReplayFormula {
  double c, near, far;
} FemReplayFormula;

typedef struct FemReplay {
  const FemReplaySteps *steps; // borrowed
  FemSystem system;
  FemState before, state; // of the step before, and the one under trial
  FemEquilibrium equilibrium;
  FemKrylov krylov; // where there is friction or damping
  FemMixing mixing;
  double *weights; // of its norm, 1                            (n)
  bool has_factor; // which serves the next step, too
  void *stick;     // friction's effect, borrowed; NULL: none
  bool is_near;    // the matrix, to J: no friction, damping, following pressure
  int n;           // unknowns
  FemReplayPlan plan;
  int segment, first;           // which is there; the step of the first row
  double *u, *v;                // of its steps, and of some before           (rows, n)
  double *saved;                // those before each segment        (segments, 2, FEM_REPLAY_LEAD, n)
  double *force, *step;         // scratch                                   (n)
  double *ahead, *aside;        // scratch, where the matrix is not exact    (n)
  double *rate;                 // the same, velocities                      (n)
  FemEffectHistory *histories;  // of segments' ends, of steps between (segments + length, effect_count)
  unsigned char *slips;         // 0: apart, 1: sticks, 2: slips             (interfaces, contact vertices)
  double spent_s;               // processor time of its steps, also where they are done again [s]
  double worst;                 // what is left in a step, as a share of the largest force
  long long switches;           // between sticking and slipping, of vertices from step to step
  double c;                     // of the step that is balanced
  const double *middle, *speed; // its u, its v
} FemReplay;

Status fem_replay_create(FemReplay *replay, const FemModel *model, const FemReplaySteps *steps);
void fem_replay_destroy(FemReplay *replay); // also of a zeroed one

// STATUS_SOLVER: a step cannot be balanced; the message says which.
Status fem_replay_go(FemReplay *replay);
// Step k as it was found: `state` is there, `before` at step k − 1. From the last step on, one by one: its
// segment may be done again.
Status fem_replay_return(FemReplay *replay, int k);
// Whether the replay begins anew at step k, both ways.
bool fem_replay_is_anew(const FemReplay *replay, int k);
// u, v of step k, which is there, before it of some others.
double *fem_replay_u(const FemReplay *replay, int k);
double *fem_replay_v(const FemReplay *replay, int k);
// What effects remember after step k, which is there or ends a segment.                 (effect_count)
FemEffectHistory *fem_replay_histories(const FemReplay *replay, int k);
// The matrix K + c D + c² M there.
Status fem_replay_factorise(FemReplay *replay, int k);

// Of step k; before and beyond the steps, and of a static scene, 0.
FemReplayFormula fem_replay_formula(const FemReplay *replay, int k);
double fem_replay_mass(const FemReplay *replay, int unknown); // [kg]
// A failure of step k, or an interruption, with its time; nothing is tried again.
Status fem_replay_end(const FemReplay *replay, int k, Status status);

#endif

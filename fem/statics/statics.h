// SPDX-License-Identifier: GPL-3.0-or-later
// Static scenes: the load (or a driven vertex) goes on in steps of `time`, which is no more than a parameter,
// and every step ends in equilibrium.
//
//   Newton (KINSOL; with contact fem/statics/descent.h) from the last equilibrium ── ok ──► accept
//        │ no
//   relaxation: (K + s M) δ = f, s falling with the force ──► Newton ── ok ──► accept
//        │ no
//   half the step; given up below a millionth of the way between two frames
//
// Relaxation is pseudo-transient continuation (Kelley and Keyes 1998; s by switched evolution relaxation,
// Mulder and van Leer 1985): implicit Euler on M u̇ = f, overdamped motion, which also brings a body that
// nothing holds down to what it falls on. History variables and contact lists follow its way.
#ifndef TETLAP_FEM_STATICS_STATICS_H
#define TETLAP_FEM_STATICS_STATICS_H

#include "fem/statics/equilibrium.h"

// Equilibria whose tangent K has negative eigenvalues: they are unstable, and before the first of them the
// way has passed a limit or a bifurcation. Looked for where Newton's method has met a K that is not positive
// definite.
typedef struct FemStability {
  long long unstable;                 // steps that ended in such a one
  long long most;                     // negative eigenvalues of one; −1: not counted
  double stable_until, unstable_from; // the last stable one's time before the first [s]; none: 0
} FemStability;

typedef struct FemStatics {
  FemEquilibrium equilibrium;
  double tolerance;             // largest force on an unknown in equilibrium, over the largest force met
  double force_scale;           // that [N]
  double *force, *step, *start; // scratch                     (unknown_count)
  double *kept_force, *kept_position; // at the last equilibrium     (vertex_count, 3)
  double kept_time;                   // of that
  double driven_work;                 // of driven vertices, of increasing gravity, and of what holds a body
                                      // that begins out of equilibrium, so far [J]
  double work_begin, work_end;        // of the last step, by the forces at its begin and end [J]
  double load_change;                 // of the last step (fem/effect/loads.h) [J]
  double work_left;                   // of the unbalanced forces, along the longest driven displacement [J]
  double residual;                    // largest force on an unknown at the end of the last step [N]
  long long steps, newton_iterations, relaxation_steps, halvings;
  FemStability stability;
  long long failures; // of factorisations, until the last step
  long long loose;    // steps whose unbalanced forces were only tolerable (descent.h)
} FemStatics;

// `system` is borrowed, and `state`, which each evaluation fills; after a step it is the equilibrium.
// STATUS_INPUT: what only a motion can have (friction by velocities, release, an initial velocity).
Status fem_statics_create(FemStatics *statics, FemSystem *system, FemState *state, const FemSolverOps *ops);
// Begins at u, or goes on from an equilibrium u at `time`, with the largest force met and the work done until
// then.
Status fem_statics_continue(FemStatics *statics, double time, const double *u, double force_scale,
                            double driven_work);
void fem_statics_destroy(FemStatics *statics); // also of a zeroed one

// From the equilibrium u at `from` to the one at `to`; u is as before if that fails. RETRY: try a smaller
// step; the message says what is left: force, vertices, elements.
Status fem_statics_step(FemStatics *statics, double from, double to, double *u);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The mechanical system of a run: the model and the effects that its scene calls for. It evaluates forces and
// the condensed or split Jacobian at any state (energies: fem/effect/system_energy.h). It owns the matrix
// pattern and the last accepted state.
#ifndef TETLAP_FEM_EFFECT_SYSTEM_H
#define TETLAP_FEM_EFFECT_SYSTEM_H

#include <signal.h>

#include "fem/effect/effect.h"
#include "fem/effect/numbering.h"

// Wall time, calls and memory of one effect.
typedef struct FemEffectCost {
  double force_s, jacobian_s, prepare_s;
  long long force_calls, jacobian_calls, prepare_calls;
  long long bytes_max; // the most that it held after creation or an accepted step [bytes]
} FemEffectCost;

typedef struct FemSystem {
  const FemModel *model; // borrowed
  bool is_whole;         // the last creation did not fail
  FemNumbering numbering;
  FemEffect effects[FEM_MAX_EFFECTS];
  FemEffectCost costs[FEM_MAX_EFFECTS];
  int effect_count;
  FemPattern *pattern;
  FemMatrix matrix;                       // S, or K for split use
  long long pattern_version;              // grows whenever `matrix` has been laid out anew
  double layout_s;                        // wall time of laying it out [s]
  FemState accepted;                      // the last accepted state
  FemEffectHistory next[FEM_MAX_EFFECTS]; // scratch of fem_system_accept
  double *forces;                         // of the last evaluation [N] (vertex_count, 3), and one of scratch
  const volatile sig_atomic_t *stop;      // once it is other than 0, forces, matrices and fem_system_accept
                                          // fail with STATUS_INTERRUPTED; borrowed; NULL: never
} FemSystem;

// At the state in which the model begins. STATUS_INPUT: nothing is free to move. After a failure its effects
// can be asked for the reason; fem_system_destroy must follow in any case.
Status fem_system_create(FemSystem *system, const FemModel *model);
// Takes the system back, in place, to what it was before its first state; fem_system_begin must follow.
// Failures as above.
Status fem_system_create_again(FemSystem *system);
void fem_system_destroy(FemSystem *system);

// A state under trial, which begins as a copy of the accepted one and has that as its `last`. The caller's
// (fem_state_destroy).
Status fem_system_create_state(const FemSystem *system, FemState *state);
// Fills a state at that time [s]: unknowns as given (displacement u = x − X [m], velocity v [m/s]; n each),
// prescribed coordinates from their motions. Others stay as they are. v NULL: all velocities are 0, also of
// what is driven.
void fem_system_scatter(const FemSystem *system, double time, const double *u, const double *v,
                        FemState *state);
// The inverse: the unknowns of a state.
void fem_system_gather(const FemSystem *system, const FemState *state, double *u, double *v);

// STATUS_RETRY: a position or velocity is not finite; the message names the first such vertex.
Status fem_system_check_state(const FemSystem *system, const FemState *state);

// Forces on all vertices [N] into system->forces. On bodies that are held they may be left out. STATUS_RETRY
// as the effects say, and where the state or a force is not finite: the message names the vertex, and the
// effect that the force is from.
Status fem_system_forces(FemSystem *system, const FemState *state);
// The same with the forces on bodies that are held.
Status fem_system_forces_of_all(FemSystem *system, const FemState *state);

// Lays system->matrix out anew if an effect couples more at the state than the pattern has; pattern_version
// grows then. To be called before assembling into system->matrix or a copy of its layout.
Status fem_system_couple(FemSystem *system, const FemState *state);

// Whether every effect is linear, so that K and D are constant.
bool fem_system_is_linear(const FemSystem *system);

// After the numbering was renewed: lays the matrix out again, unless there are no unknowns.
Status fem_system_renumber(FemSystem *system);

// matrix = k·K + d·D + m·M, K = −∂f/∂x, D = −∂f/∂v, M the masses; K and D as far as the effects have them.
Status fem_system_assemble(FemSystem *system, const FemState *state, double k, double d, double m,
                           FemMatrix *matrix);
// The same without one effect.
Status fem_system_assemble_without(FemSystem *system, const FemEffectOps *left_out, const FemState *state,
                                   double k, double d, double m, FemMatrix *matrix);

// Accepts a state at which a run begins or goes on, whatever was before: effects forget their lists, make new
// ones for a step of that length [s], and begin their histories. Pattern and matrix are those of this state.
Status fem_system_begin(FemSystem *system, const FemState *state, double next_step);
// Sets what the effect at that place (fem_system_place) remembers at the accepted state, from a checkpoint.
// STATUS_INPUT: it does not fit.
Status fem_system_remember(FemSystem *system, int place, const double *values, size_t count);
// To be called where what is held has changed (contact_system_hold): the accepted state counts as another
// one, so that nothing evaluated at it is used again.
void fem_system_forget(FemSystem *system);
// Lets effects renew their lists near a state that is not accepted.
Status fem_system_renew(FemSystem *system, const FemState *state);
// Accepts a state: effects renew their lists for a next step of that length [s] and advance their histories.
// After a failure the accepted state is the one before.
Status fem_system_accept(FemSystem *system, const FemState *state, double next_step);

// Until when a step from `time` may go so that it passes over no function of time that the scene prescribes,
// at most until `farthest` [s]. `foresight` says how exactly these must be followed (signal.h).
double fem_system_horizon(const FemSystem *system, const FemForesight *foresight, double time,
                          double farthest);

// How long the next step may be so that its forces can be evaluated [s]; INFINITY: no effect limits it.
double fem_system_longest_step(const FemSystem *system);

// Whether an effect's forces depend on velocities.
bool fem_system_dissipates(const FemSystem *system);

// The effect's place among those of the system, −1: the scene has none.
int fem_system_place(const FemSystem *system, const FemEffectOps *effect);
// The `self` of the effect with that table; NULL: the scene does not have it.
void *fem_system_effect(const FemSystem *system, const FemEffectOps *effect);

#endif

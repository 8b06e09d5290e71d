// SPDX-License-Identifier: GPL-3.0-or-later
// The mechanical system of a run: model + the effects that its scene calls for. Evaluates forces and the
// condensed or split Jacobian at any state (energies: fem/effect/system_energy.h); owns the matrix pattern
// and the last accepted state.
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
  long long pattern_version;              // grows whenever matrix has been laid out anew
  double layout_s;                        // that this took [s]
  FemState accepted;                      // the last accepted state
  FemEffectHistory next[FEM_MAX_EFFECTS]; // scratch of fem_system_accept
  double *forces;                         // scratch, and one more for how many ranks failed (vertex_count, 3)
  const volatile sig_atomic_t *stop;      // becomes non-zero: forces, matrices and what effects keep are
                                          // STATUS_INTERRUPTED; borrowed, NULL: never
} FemSystem;

// After a failure its effects can be asked for the reason; fem_system_destroy must follow.
Status fem_system_create(FemSystem *system, const FemModel *model);
// Takes it back in place to what depends on no state; fem_system_begin must follow. Failures as above.
Status fem_system_create_again(FemSystem *system);
void fem_system_destroy(FemSystem *system);

// A state to try steps from the accepted one with, the caller's; it begins as a copy of that.
Status fem_system_create_state(const FemSystem *system, FemState *state);
// Fills it: unknowns as given (displacement u = x − X, velocity v; n each), prescribed coordinates as they
// are at that time. Others stay as they are. v NULL: all is at rest, what is driven, too.
void fem_system_scatter(const FemSystem *system, double time, const double *u, const double *v,
                        FemState *state);
// The unknowns of a state, the inverse.
void fem_system_gather(const FemSystem *system, const FemState *state, double *u, double *v);

// Whether the state is made of numbers. RETRY: it is not; the message names the first vertex.
Status fem_system_check_state(const FemSystem *system, const FemState *state);

// Forces on all vertices into system->forces. RETRY as the effects say, and where the state or a force is no
// number: the message names the vertex, and the effect that the force is from. On bodies that are held they
// may be left out.
Status fem_system_forces(FemSystem *system, const FemState *state);
// The same, and the forces on bodies that are held.
Status fem_system_forces_of_all(FemSystem *system, const FemState *state);

// Lays system->matrix out anew if an effect couples more at the state than the pattern has; then
// pattern_version has grown. Call it before assembling into system->matrix or a copy of its layout.
Status fem_system_couple(FemSystem *system, const FemState *state);

// Every effect is linear: K and D are constant.
bool fem_system_is_linear(const FemSystem *system);

// After the numbering was renewed: lays the matrix out again, unless there are no unknowns.
Status fem_system_renumber(FemSystem *system);

// matrix = k·K + d·D + m·M.
Status fem_system_assemble(FemSystem *system, const FemState *state, double k, double d, double m,
                           FemMatrix *matrix);
// The same but for one effect.
Status fem_system_assemble_without(FemSystem *system, const FemEffectOps *left_out, const FemState *state,
                                   double k, double d, double m, FemMatrix *matrix);

// A run begins, or goes on, at this state, which is accepted, whatever has been before: effects begin to
// remember, and make lists for a step of that length [s]; pattern and matrix are those of this state.
Status fem_system_begin(FemSystem *system, const FemState *state, double next_step);
// What the effect at that place remembers at the accepted state, from a checkpoint. STATUS_INPUT: it does not
// fit.
Status fem_system_remember(FemSystem *system, int place, const double *values, size_t count);
// What is held has changed (contact_system_hold): nothing that was evaluated stands.
void fem_system_forget(FemSystem *system);
// Lets effects renew their lists near a state that is not accepted.
Status fem_system_renew(FemSystem *system, const FemState *state);
// Accepts a state: effects renew their lists, and histories go on.
Status fem_system_accept(FemSystem *system, const FemState *state, double next_step);

// How far a step from `time` may go, at most to `farthest`, so that no function of time is
// missed (signal.h).
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

// SPDX-License-Identifier: GPL-3.0-or-later
// The state of a run: what forces, matrices and energies are functions of.
//
// An accepted state is whole: time, positions, velocities, and what effects remember. A state under
// trial is a step from the last accepted one, `last`: effects look there for what has been, and change
// nothing. It belongs to the integrator or to statics, which fill it by fem_system_scatter. A system keeps
// the last accepted one (fem_system_accept).
#ifndef TETLAP_FEM_EFFECT_STATE_H
#define TETLAP_FEM_EFFECT_STATE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

enum { FEM_MAX_EFFECTS = 32 };

// What an effect remembers of what has been, as numbers that can be copied and written; each effect says in
// its file what they are.
typedef struct FemEffectHistory {
  double *values; // owned                                            (count)
  size_t count, capacity;
} FemEffectHistory;

typedef struct FemState {
  double time;                                 // [s]
  double *positions;                           // [m]                        (vertex_count, 3)
  double *velocities;                          // [m/s]                      (vertex_count, 3)
  FemEffectHistory histories[FEM_MAX_EFFECTS]; // of an accepted state, by the effects' places in their system
  const struct FemState *last; // the last accepted state, borrowed; itself where it is accepted
  long long version;           // the same number: the same time and positions, in any states
  const bool *is_held; // bodies that sleep: forces on them and between them may be left out; borrowed,
                       // NULL: forces on all are wanted                                   (body_count)
} FemState;

// Room for so many vertices, with copies of these positions and velocities, at time 0. It is its own `last`.
Status fem_state_create(FemState *state, int vertex_count, const double *positions, const double *velocities);
void fem_state_destroy(FemState *state); // also of a zeroed one

// A version that no state of this process has had.
long long fem_state_new_version(void);
// The state at another time, its arrays borrowed.
FemState fem_state_beside(const FemState *state, double time);

// Room for that many numbers, whose values are then anything.
Status fem_effect_history_resize(FemEffectHistory *history, size_t count);
Status fem_effect_history_set(FemEffectHistory *history, const double *values, size_t count);
void fem_effect_history_destroy(FemEffectHistory *history); // also of a zeroed one

#endif

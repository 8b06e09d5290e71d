// SPDX-License-Identifier: GPL-3.0-or-later
// An effect: one module that a scene calls for (elasticity, damping, gravity, contact …). An effect that a
// scene does not call for is never created and costs nothing. Each is one file with one table of operations,
// and one line in fem/effect/effect.c.
#ifndef TETLAP_FEM_EFFECT_EFFECT_H
#define TETLAP_FEM_EFFECT_EFFECT_H

#include <stdbool.h>

#include "base/files/record.h"
#include "fem/effect/energy.h"
#include "fem/effect/state.h"
#include "fem/model/model.h"
#include "fem/sparse/matrix.h"

struct FemSystem;

typedef struct FemEffectOps {
  const char *name;
  const char *help;  // one line
  bool couples_anew; // its couplings change, or are not those of elements
  bool dissipates;   // its forces depend on velocities: D is assembled for Newton's matrix
  bool is_divided;   // over ranks it gives what this rank's elements give: the sum over ranks is the effect's
  bool (*is_wanted)(const FemSceneDef *scene);
  Status (*create)(void **self, const FemModel *model);
  // The same as create for a run that begins anew with the same model: takes over `*old`, which is NULL then,
  // for what never changes and is expensive to make or was read from a file (weights). What depends on former
  // states is made as create makes it. NULL: create.
  Status (*create_again)(void **self, void **old);
  // Once all effects are there: to find one that this effect builds on, by fem_system_effect. NULL: none.
  Status (*connect)(void *self, const struct FemSystem *system);
  // Tells the matrix pattern which vertices this effect couples at that state; *has_grown (may be NULL) as
  // in fem/sparse/pattern.h. Called once, and for effects that `couples_anew` before every assembly. NULL:
  // none, or only a vertex with itself.
  Status (*couple)(void *self, const FemState *state, FemPattern *pattern, int *has_grown);
  // Renews the lists that evaluations near this state need; `step` [s] is the length expected next. Results
  // do not depend on lists. NULL: there are none.
  Status (*renew)(void *self, const FemState *state, double step);
  // The next `renew` makes its lists as if there were none. NULL: there are none.
  void (*forget)(void *self);
  // What the effect remembers (FemEffectHistory): where a run begins, at this state, whose `last` is itself;
  // and once a state is accepted, from what it remembered at state->last. Evaluations read
  // state->last->histories at the effect's place. NULL: nothing.
  Status (*start)(void *self, const FemState *state, FemEffectHistory *history);
  Status (*advance)(void *self, const FemState *state, FemEffectHistory *next);
  // STATUS_INPUT: numbers from a checkpoint that are no history of this scene. NULL: any are.
  Status (*check_history)(const void *self, const double *values, size_t count);
  // Adds forces [N] to `force` (vertex_count, 3); those on bodies that the state says are held may be left
  // out. RETRY: take a smaller step. NULL: none.
  Status (*add_force)(void *self, const FemState *state, double *force);
  // Adds stiffness_scale · (−∂f/∂x) + damping_scale · (−∂f/∂v), symmetric, to the matrix. NULL: none.
  Status (*add_jacobian)(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                         FemMatrix *matrix);
  Status (*add_energy)(void *self, const FemState *state, FemEnergy *energy); // NULL: none
  // Forces are linear in positions and velocities: one Jacobian for the whole run. NULL: they are not.
  bool (*is_linear)(void *self);
  // How far a step from `time` may go along what the effect prescribes by functions of time (signal.h): at
  // most to `farthest`. NULL: that far.
  double (*horizon)(const void *self, const FemForesight *foresight, double time, double farthest);
  // How long the next step may be, at the speeds of the last accepted state, so that forces can be evaluated
  // at its end [s]. NULL: any length.
  double (*longest_step)(const void *self);
  // Puts its counters, at the last accepted state, into those of the run's parts before, between two
  // checkpoints; NULL: none. What counts what happened since creation is added (record_add); of all else the
  // last stands.
  void (*report)(void *self, const FemState *state, Record *counters);
  // What it holds on the heap, `self` included [bytes], by memory_held; NULL: not known.
  size_t (*bytes)(const void *self);
  void (*destroy)(void *self);
} FemEffectOps;

typedef struct FemEffect {
  const FemEffectOps *ops;
  void *self;
} FemEffect;

// Where there are ranks: effects of which each rank computes a part, those that each computes whole, or both.
typedef enum FemEffectPart { FEM_EFFECT_ALL, FEM_EFFECT_DIVIDED, FEM_EFFECT_WHOLE } FemEffectPart;

static inline bool fem_effect_is_of(const FemEffect *effect, FemEffectPart part) {
  return part == FEM_EFFECT_ALL || effect->ops->is_divided == (part == FEM_EFFECT_DIVIDED);
}

// All effects there are.
const FemEffectOps *const *fem_effect_list(int *count);

// Each is defined in the file of its name, here or in the rooms `elements` and `contact`.
extern const FemEffectOps fem_effect_elasticity;
extern const FemEffectOps fem_effect_volume;
extern const FemEffectOps fem_effect_plasticity;
extern const FemEffectOps fem_effect_damping;
extern const FemEffectOps fem_effect_gravity;
extern const FemEffectOps fem_effect_loads;
extern const FemEffectOps fem_effect_contact;
extern const FemEffectOps fem_effect_stick;
extern const FemEffectOps fem_effect_viscosity;

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of a function g by friction (fem/effect/contact/stick.h) at one step, backwards. Given are
// g's derivatives by friction's forces and by the history that friction leaves for the next step. From them
// follow those by positions now and at the step before, by the history of the step before, and by the
// constants of the law, which are summed.
#ifndef TETLAP_FEM_GRADIENT_EFFECT_FRICTION_H
#define TETLAP_FEM_GRADIENT_EFFECT_FRICTION_H

#include "fem/effect/contact/stick.h"
#include "fem/effect/system.h"

typedef struct FemFriction {
  void *effect;          // borrowed
  const FemState *state; // borrowed; its `last` is the step before
  size_t value_count;    // 3 · vertex_count
  int interface_count;
  double *now, *then;       // by positions of this step, of the one before  (value_count)
  double (*before)[3];      // by the history of the step before             (its entries)
  size_t before_capacity;   // of that
  double *stiffness, *slip; // by ln κ and μ of each interface               (interface_count)
  double (*moves)[2][3];    // Σ over side 0's vertices of `now`, of `then`  (interface_count)
  double *answers;          // by overlaps, borrowed; NULL: not wanted      (pairs of meshes, 4)
  double *scaled;           // scratch                                       (value_count)
} FemFriction;

// Of a scene with friction.
Status fem_friction_create(FemFriction *friction, const FemSystem *system);
void fem_friction_destroy(FemFriction *friction); // also of a zeroed one

// Sets all sums to 0, at this state.
Status fem_friction_begin(FemFriction *friction, const FemState *state);
// Adds the derivatives of λ · f. f is the friction of one interface, or of CONTACT_ALL_INTERFACES, and λ =
// weight · forces (vertex_count, 3).
Status fem_friction_pull(FemFriction *friction, int interface, const double *forces, double weight);
// Adds the derivatives that g has through the history `next` after this step, by whose entries they are
// `after`.
Status fem_friction_pull_history(FemFriction *friction, const FemEffectHistory *next,
                                 const double (*after)[3]);
// Adds the friction forces of one interface [N] (vertex_count, 3).
Status fem_friction_add_force(const FemFriction *friction, int interface, double *force);

#endif

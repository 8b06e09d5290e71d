// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of a function by friction (fem/effect/contact/stick.h) at one step, backwards: what is found by
// its forces and by what it leaves for the next step is summed by positions now and at the step before, by
// what was remembered there, and by the constants of the law.
#ifndef TETLAP_FEM_GRADIENT_FRICTION_H
#define TETLAP_FEM_GRADIENT_FRICTION_H

#include "fem/effect/contact/stick.h"
#include "fem/effect/system.h"

typedef struct FemFriction {
  void *effect;          // borrowed
  const FemState *state; // borrowed; its `last` is the step before
  size_t value_count;    // 3 · vertex_count
  int interface_count;
  double *now, *then;       // by positions                                  (value_count)
  double (*before)[3];      // by what was remembered                        (entries of the step before)
  size_t before_capacity;   // of that
  double *stiffness, *slip; // by ln κ and μ of each interface               (interface_count)
  double (*moves)[2][3];    // Σ over side 0's vertices of `now`, of `then`  (interface_count)
  double *answers;          // by overlaps, borrowed; NULL: not wanted      (pairs of meshes, 4)
  double *scaled;           // scratch                                       (value_count)
} FemFriction;

// The scene has friction.
Status fem_friction_create(FemFriction *friction, const FemSystem *system);
void fem_friction_destroy(FemFriction *friction); // also of a zeroed one

// All sums are 0 again, at this state.
Status fem_friction_begin(FemFriction *friction, const FemState *state);
// Adds what a function has by forces · weight on the vertices, of one interface or CONTACT_ALL_INTERFACES.
Status fem_friction_pull(FemFriction *friction, int interface, const double *forces, double weight);
// Adds what it has by what is remembered after this step, as `after` gives it by the entries there.
Status fem_friction_pull_history(FemFriction *friction, const FemEffectHistory *next,
                                 const double (*after)[3]);
// Adds the friction of one interface.
Status fem_friction_add_force(const FemFriction *friction, int interface, double *force);

#endif

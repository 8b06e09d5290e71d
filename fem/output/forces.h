// SPDX-License-Identifier: GPL-3.0-or-later
// Contact and friction forces as they are written. A frame lies within a step, at positions that are
// interpolated: right to the tolerance, which is more than a body at rest is deep, so forces evaluated there
// are not those that moved the body. They are interpolated between the accepted states at the step's ends.
#ifndef TETLAP_FEM_OUTPUT_FORCES_H
#define TETLAP_FEM_OUTPUT_FORCES_H

#include <stdbool.h>

#include "fem/effect/system.h"

// Friction between two [N], and the areas that stick and that slide [m²].
typedef struct FemRubbing {
  double force[3];      // on the first side; part of the force between the two
  double stuck, slides; // 0 with friction by velocities
} FemRubbing;

// At one state.
typedef struct FemForcesAt {
  double time;             // [s]
  double (*interfaces)[3]; // on the first side, friction and viscosity included [N]    (interface_count)
  double *areas;           // of contact [m²]                             (interface_count)
  double (*centres)[3];    // of pressure [m]; NaN: nothing presses       (interface_count)
  double *contact;         // of potential and viscosity [N]; NULL: not wanted    (vertex_count, 3)
  double *friction;        // [N]; NULL: not wanted                       (vertex_count, 3)
  FemRubbing *rubbing;     // NULL: no friction                           (interface_count)
  double *pressure; // at the surface [Pa]; NULL: not wanted, or the potential has none   (vertex_count)
  double *depth;    // likewise [m]                                (vertex_count)
} FemForcesAt;

typedef struct FemForces {
  const FemSystem *system; // borrowed
  int interface_count;
  bool has_begin, has_end; // of the step that is being looked at
  FemForcesAt begin, end;
  FemForcesAt now; // what `set` has found
} FemForces;

// With forces of vertices, or of interfaces alone. A zeroed one, and one whose creation failed, can be
// destroyed.
Status fem_forces_create(FemForces *forces, const FemSystem *system, bool with_vertices);
void fem_forces_destroy(FemForces *forces);

bool fem_forces_has_friction(const FemSystem *system);
bool fem_forces_has_stick(const FemSystem *system); // friction that knows what sticks

// The state that was evaluated last is the one that a run begins or goes on from, or the end of a step.
Status fem_forces_begin(FemForces *forces, double time);
Status fem_forces_end(FemForces *forces, double time);
// The step is accepted: its end is the next one's beginning.
void fem_forces_accept(FemForces *forces);

// Fills `now`: within the step by interpolation, else, or where nothing is known of its ends, from the state
// that was evaluated last.
Status fem_forces_set(FemForces *forces, double time);

#endif

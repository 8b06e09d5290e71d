// SPDX-License-Identifier: GPL-3.0-or-later
// Contact and friction forces as they are written: those of a state, also of a frame within a step, by the
// laws that move the bodies. They follow from the frame's positions; friction and viscosity follow also from
// its velocities and from what the last accepted state left (docs/output.md).
#ifndef TETLAP_FEM_OUTPUT_FORCES_H
#define TETLAP_FEM_OUTPUT_FORCES_H

#include <stdbool.h>

#include "fem/effect/system.h"

// Friction between two [N], and the areas that stick and that slide [m²].
typedef struct FemRubbing {
  double force[3]; // on the first side; part of the force between the two
  double stuck, slides;
} FemRubbing;

typedef struct FemForces {
  const FemSystem *system; // borrowed
  int interface_count;
  double (*interfaces)[3]; // on the first side, friction and viscosity included [N]    (interface_count)
  double *areas;           // of contact [m²]                             (interface_count)
  double (*centres)[3];    // of pressure [m]; NaN: nothing presses       (interface_count)
  double *contact;         // of potential and viscosity [N]; NULL: not wanted    (vertex_count, 3)
  double *friction;        // [N]; NULL: not wanted                       (vertex_count, 3)
  FemRubbing *rubbing;     // NULL: no friction                           (interface_count)
  double *pressure; // at the surface [Pa]; NULL: not wanted, or the potential has none   (vertex_count)
  double *depth;    // likewise [m]                                (vertex_count)
  double *traction; // likewise, friction included [Pa]            (vertex_count, 3)
  double *gap;      // likewise, from the next body or obstacle [m]: −depth where pressed; NaN: none is near
  int *status;      // likewise, a FemContactStatus                (vertex_count)
  double *slip;     // likewise, slid since it was last touched [m]; NULL: no friction    (vertex_count, 3)
  double *way;      // likewise, the length slid so far [m]        (vertex_count)
  double *work;     // dissipated there by friction so far [J]     (vertex_count)
  double (*stuck)[2]; // scratch: what sticks and slides [N]       (vertex_count)
} FemForces;

typedef enum FemContactStatus { FEM_CONTACT_OPEN, FEM_CONTACT_STICKS, FEM_CONTACT_SLIDES } FemContactStatus;

// `with_vertices`: arrays over vertices, too, not of interfaces alone. Without contact all is NULL. A zeroed
// one, and one whose creation failed, can be destroyed.
Status fem_forces_create(FemForces *forces, const FemSystem *system, bool with_vertices);
void fem_forces_destroy(FemForces *forces);

bool fem_forces_has_friction(const FemSystem *system);

// Finds those of a state, without areas and what is reported at the surface. STATUS_RETRY as evaluations.
Status fem_forces_take(FemForces *forces, const FemState *state);
// Adds the areas of contact at the same state: surfaces are clipped for them.
Status fem_forces_take_areas(FemForces *forces, const FemState *state);
// Adds what is reported at the surface at the same state.
Status fem_forces_take_surface(FemForces *forces, const FemState *state);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The stiffness K = −∂f/∂x at a state over all coordinates, the prescribed ones included, and products with
// it and with its parts: what derivatives are made of. Velocities count as 0; damping has its own derivatives
// (fem/gradient/effect/damping.h).
#ifndef TETLAP_FEM_GRADIENT_TANGENT_H
#define TETLAP_FEM_GRADIENT_TANGENT_H

#include "contact/system.h"
#include "fem/effect/system.h"
#include "fem/gradient/contact/answers.h"
#include "fem/gradient/contact/remainder.h"
#include "fem/gradient/effect/damping.h"
#include "fem/gradient/effect/friction.h"
#include "fem/gradient/effect/yielding.h"

typedef struct FemTangent {
  FemSystem *system;      // borrowed
  const FemState *state;  // borrowed
  FemMatrix stiffness;    // K of all coordinates, without friction
  long long layout;       // the version of the system's pattern that it has; 0: of none
  double *coupled;        // positions at which that pattern was found to do [m] (3·vertex_count)
  double reach;           // how far a coordinate may be from there [m]
  FemRemainder remainder; // what the matrix lacks of contact
  int *every_dof;         // 0, 1, 2 …                                    (3·vertex_count)
  double *still;          // velocities, 0                                (3·vertex_count)
  ContactSystem *contact; // borrowed; NULL: the scene has none
  int interface_count;
  void *stick;           // friction's effect, borrowed; NULL: the scene has none
  FemFriction *friction; // where derivatives by friction are added, borrowed; NULL: nowhere
  FemDamping *damping;   // the same by damping
  FemYielding *yielding; // the same by plasticity
  FemAnswers *answers;   // the same by overlaps
} FemTangent;

// Of no state yet. Destroy it also after a failure.
Status fem_tangent_create(FemTangent *tangent, FemSystem *system);
void fem_tangent_destroy(FemTangent *tangent); // also of a zeroed one
// At a state, which is borrowed.
Status fem_tangent_find(FemTangent *tangent, const FemState *state);

// y = −(∂f/∂x)ᵀ x, both (vertex_count, 3), without friction and damping. It is exact also for following
// pressures, overlap models that do not clip and pressure laws, with which −∂f/∂x is not symmetric. On the
// vertices of an obstacle with a mesh y lacks contact.
Status fem_tangent_pull(const FemTangent *tangent, const double *x, double *y);
// Adds the remainder's part of −∂f/∂x x to y, both (vertex_count, 3).
void fem_tangent_add_remainder(const FemTangent *tangent, const double *x, double *y);

// Adds to `answers`, if there are any, the derivatives of λ · f by V and x̄. f are contact's forces of an
// interface, or of CONTACT_ALL_INTERFACES, and λ = weight · forces (vertex_count, 3).
Status fem_tangent_pull_contact(const FemTangent *tangent, int interface, const double *forces,
                                double weight);
// Adds the derivatives by the network's weights that follow from `answers`.
Status fem_tangent_train(const FemTangent *tangent, double *slope);
// fem_answers_begin at the state.
Status fem_tangent_begin_answers(const FemTangent *tangent, FemAnswers *answers);

const ContactInterfaceDef *fem_tangent_interface(const FemTangent *tangent, int interface);
// The contact of one interface, without friction: its forces [N] and its part of −∂f/∂x x or, `back`, of
// −(∂f/∂x)ᵀ x, both added (vertex_count, 3); its energy [J].
Status fem_tangent_add_contact(const FemTangent *tangent, int interface, double *force);
Status fem_tangent_contact_energy(const FemTangent *tangent, int interface, double *energy);
Status fem_tangent_add_contact_product(const FemTangent *tangent, int interface, bool back, const double *x,
                                       double *y);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Contact and stiffness at an equilibrium, over all coordinates, the prescribed ones included, and between
// any two that can meet: what derivatives are products of.
#ifndef TETLAP_FEM_GRADIENT_TANGENT_H
#define TETLAP_FEM_GRADIENT_TANGENT_H

#include "contact/system.h"
#include "fem/effect/system.h"
#include "fem/gradient/damping.h"
#include "fem/gradient/friction.h"
#include "fem/gradient/learned.h"

typedef struct FemTangent {
  FemSystem *system;      // borrowed
  const FemState *state;  // borrowed
  FemMatrix stiffness;    // K = −∂f/∂x at rest over all coordinates, without friction
  long long layout;       // of the system's pattern, of which that is; 0: of none
  double *coupled;        // where everything was when that was found to do  (3·vertex_count)
  double reach;           // how far vertices may be from there [m]
  FemLearned learned;     // what that lacks of contact
  int *every_dof;         // 0, 1, 2 …                                    (3·vertex_count)
  double *still;          // velocities, 0                                (3·vertex_count)
  ContactSystem *contact; // borrowed; NULL: the scene has none
  int interface_count;
  void *stick;           // friction's effect, borrowed; NULL: the scene has none
  FemFriction *friction; // where derivatives by friction are added, borrowed; NULL: nowhere
  FemDamping *damping;   // the same by damping
  FemAnswers *answers;   // the same by overlaps
} FemTangent;

// Of no state yet. Destroy it also after a failure.
Status fem_tangent_create(FemTangent *tangent, FemSystem *system);
void fem_tangent_destroy(FemTangent *tangent); // also of a zeroed one
// At a state, which is borrowed.
Status fem_tangent_find(FemTangent *tangent, const FemState *state);

// y = −(∂f/∂x)ᵀ x, both (vertex_count, 3), but for the parts of friction and damping. K is symmetric but for
// following pressures and overlap models that do not clip. The parts of a mesh obstacle's vertices lack
// contact.
Status fem_tangent_pull(const FemTangent *tangent, const double *x, double *y);
// Adds what −∂f/∂x x has beside K x by such models.
void fem_tangent_add_learned(const FemTangent *tangent, const double *x, double *y);

// Adds to `answers`, if there are any, what weight · forces times contact's forces of an interface, or of
// CONTACT_ALL_INTERFACES, has.
Status fem_tangent_pull_contact(const FemTangent *tangent, int interface, const double *forces,
                                double weight);
// Adds what `answers` gives by the weights.
Status fem_tangent_train(const FemTangent *tangent, double *slope);
Status fem_tangent_begin_answers(const FemTangent *tangent, FemAnswers *answers);

const ContactInterfaceDef *fem_tangent_interface(const FemTangent *tangent, int interface);
// The contact of one interface, without friction: its forces (added), its energy [J], and its part of J x or,
// `back`, of Jᵀ x (added).
Status fem_tangent_add_contact(const FemTangent *tangent, int interface, double *force);
Status fem_tangent_contact_energy(const FemTangent *tangent, int interface, double *energy);
Status fem_tangent_add_contact_product(const FemTangent *tangent, int interface, bool back, const double *x,
                                       double *y);

#endif

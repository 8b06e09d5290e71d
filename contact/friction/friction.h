// SPDX-License-Identifier: GPL-3.0-or-later
// Coulomb friction from the overlap volumes alone. What body B does to an element i of body A is
// f_a = −Σ_j p_ij ∂V_ij/∂x_a on i's vertices a, and the opposite, −f_b, on those of B's elements j. Then
//
//   force   F_i = Σ_{a∈i} f_a,   normal  n, that of ΣF over i and the elements that share a vertex with it,
//   normal force  N = F_i · n,
//   weights  w_a = f_a · n / N,  w_b = −f_b · n / N,  so that Σ w_a = Σ w_b = 1,
//   slip    s = (I − n nᵀ) (Σ w_a v_a − Σ w_b v_b),
//   force   on A  −μ N φ(|s|/ε) s/|s|, shared among a by w_a; on B the opposite, by w_b,
//
// φ(y) = y (2 − y) below 1 and 1 beyond: once continuously differentiable (Li et al. 2020, Incremental
// Potential Contact, eq. 16). So where all slips, each vertex feels μ times its own normal force. Momentum is
// conserved to rounding, angular momentum up to the friction times the depth of the overlap. Contact that
// sticks creeps, slower than ε.
//
// Why not pair by pair: the boundary of a pair's overlap has parts of faces between elements of one body,
// where nothing touches. Those of A cancel in F, those of B in F up to differences of pressure, and nearly so
// in the sum over neighbours. Measured on two blocks at a depth of .3 elements, friction pair by pair is
// twice what it should be; as above it is right to 1 % inside of a flat patch up to a depth of .5. Between
// two bodies the elements of A against B and those of B against A give half each; against an obstacle only
// the body's count.
//
// n, N and w are those of the last accepted state: they are taken by `update` and kept while the integrator
// tries steps, so a force depends on velocities only and its derivative is symmetric and dissipative.
#ifndef TETLAP_CONTACT_FRICTION_H
#define TETLAP_CONTACT_FRICTION_H

#include <stddef.h>

#include "contact/system.h"

// What holds one element by friction until the next update.
typedef struct ContactGrip {
  int interface;      // number in contact_system_interfaces
  int side;           // of the interface that the element is on: 0 or 1
  int begin, count;   // of its vertices and weights in the lists of the friction
  double normal[3];   // n, against the element
  double limit;       // its share of μ N [N]
  double obstacle[3]; // velocity of the obstacle without elements there [m/s]; else 0
} ContactGrip;

typedef struct ContactFriction {
  ContactSystem *system; // borrowed
  double *coefficients;  // μ of each interface                  (interface_count)
  int interface_count;
  double slip_speed;  // ε [m/s]
  ContactGrip *grips; //                                                        (grip_count)
  int grip_count;
  int *vertices;   // of all grips, distinct in each                           (entry_count)
  double *weights; // w of the element's own vertices, −w of the others'       (entry_count)
  int entry_count;
  size_t grip_capacity, vertex_capacity, weight_capacity, outer_capacity, place_capacity;
  double *outer;         // scratch of the damping matrix                           (entry_count, 3)
  double *forces_around; // scratch: F of each element, then Σ F around each node   (…, 3)
  size_t around_capacity;
  int *place;          // scratch: 1 + place of a node in the grip, 0 between calls
  double (*forces)[3]; // of the last power, on side a [N]; of an interface at rest, as it was before
                       // (interface_count)
  long long updates, taken, dropped; // elements taken so far, and left out: nothing presses them along n
} ContactFriction;

// Every interface with the same μ; change `coefficients` for others. STATUS_INPUT: μ < 0 or ε ≤ 0. A zeroed
// friction, and one whose creation failed, can be destroyed.
Status contact_friction_create(ContactFriction *friction, ContactSystem *system, double coefficient,
                               double slip_speed);
void contact_friction_destroy(ContactFriction *friction);
size_t contact_friction_bytes(const ContactFriction *friction); // on the heap

// Takes normals, normal forces and weights from the system's last evaluation.
Status contact_friction_update(ContactFriction *friction);

// Adds the forces [N] at these velocities (vertex_count, 3) to `force`.
void contact_friction_add_force(const ContactFriction *friction, const double *velocities, double *force);

// Adds −∂f/∂v to the sink, as outer products over each grip's vertices.
void contact_friction_add_damping(ContactFriction *friction, const double *velocities,
                                  const ContactStiffnessSink *sink);

// Powers [W] at these velocities, and the forces by interface into friction->forces.
typedef struct ContactFrictionPower {
  double dissipated; // ≥ 0
  double driven;     // put in by moving obstacles without elements; those with a mesh are the caller's
} ContactFrictionPower;
ContactFrictionPower contact_friction_power(ContactFriction *friction, const double *velocities);

#endif

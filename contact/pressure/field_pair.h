// SPDX-License-Identifier: GPL-3.0-or-later
// What the potential `field` (contact/pressure/field.h) finds of a pair.
#ifndef TETLAP_CONTACT_PRESSURE_FIELD_PAIR_H
#define TETLAP_CONTACT_PRESSURE_FIELD_PAIR_H

#include "base/vec3.h"

// A pair with V > 0, for laws that build on it. Side 0 is cells[0] of the pair. Of a shape (side 1) the slope
// is minus its outward normal, the depth that of the mean, both as the force sees them; φ_A and g_A are 0
// there, and x̄ and the weights of side 0 are those of the force: what is left of a shape's force is its
// resultant.
typedef struct ContactFieldPair {
  const struct ContactLaw *law; // NULL: linear; borrowed
  double energy;                // U_ij [J]
  double volume;                // V [m³]
  double weighed[2];    // s_i V, s_j V: how much of A's and B's material at rest is in P; of a shape 0 [m³]
  double centroid[3];   // x̄ [m]
  double force[3];      // F_ij on side 0 [N]; N = |F_ij|
  double signs[2];      // σ of contact/pressure/field.h: −1 where the cell is turned inside out, else 1
  double depths[2];     // σ φ_A(x̄), σ φ_B(x̄): of this point below the surface of side 0, 1 [m]
  double slopes[2][3];  // σ g_A, σ g_B
  double weights[2][4]; // λ(x̄) of the vertices of the sides' tetrahedra (contact_layout_vertices)
} ContactFieldPair;

// The force of the pair over that which a linear law of 1 Pa/m would give.
static inline double contact_field_secant(const ContactFieldPair *field) {
  Vec3 push = vec3_sub(vec3_scale(field->weighed[0], vec3_at(field->slopes[1])),
                       vec3_scale(field->weighed[1], vec3_at(field->slopes[0])));
  double length = vec3_length(push);
  return length > 0 ? vec3_length(vec3_at(field->force)) / length : 0;
}

// The area that a pair covers [m²], V F / (2 U). Of a slab of thickness D over an area V = ∫ D dA, F = 2 c ∫
// D dA and U = c ∫ D² dA. Against a shape F = c ∫ D dA and U = ½ c ∫ D² dA. So it is (∫ D dA)² / ∫ D² dA.
// Exact where D is even, also in squeezed cells; ¾ of the area where D falls to 0 linearly. F and U are those
// of the linear law and of σ = 1, so that it is an area in folded bodies, too.
static inline double contact_field_area(const ContactFieldPair *field) {
  double a = field->signs[0], b = field->signs[1];
  if (field->law || a < 0 || b < 0) {
    Vec3 push = vec3_sub(vec3_scale(b * field->weighed[0], vec3_at(field->slopes[1])),
                         vec3_scale(a * field->weighed[1], vec3_at(field->slopes[0])));
    double moment = b * field->weighed[0] * field->depths[1] + a * field->weighed[1] * field->depths[0];
    return moment > 0 ? 0.5 * field->volume * vec3_length(push) / moment : 0;
  }
  double force = vec3_length(vec3_at(field->force));
  return field->energy > 0 ? 0.5 * field->volume * force / field->energy : 0;
}

#endif

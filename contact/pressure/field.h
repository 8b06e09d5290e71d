// SPDX-License-Identifier: GPL-3.0-or-later
// The potential `field`: every material point of A that is inside B has the energy c φ_B per rest volume, φ_B
// its depth in B (contact/surface/mesh.h), and the other way round. It is buoyancy: each body floats in the
// other's field.
//
//   U = c ∫_{A at rest} φ_B(x(X)) dX + c ∫_{B at rest} φ_A(y(Y)) dY,   c [Pa/m]
//
// Two flat surfaces that overlap by d press with p = 2 c d; a shape without elements has no second term: c d.
// A pressure law of the user's may stand in place of c φ (contact/pressure/field_law.h).
//
// For cells i of A and j of B only the volume V of their intersection P and its centroid x̄ are needed. With
// λ the barycentric coordinates of either one's tetrahedron, m_z = ∫_P λ_z dx = V λ_z(x̄) for the eight
// vertices z, g_A = ∇φ_A and g_B constant in the cells, and s the rest volume over the present one,
//
//   U_ij = c [ s_i V φ_B(x̄) + s_j V φ_A(x̄) ],
//   F_ij = −c V (s_i g_B − s_j g_A)   on A at x̄, its opposite on B,   by λ onto the vertices.
//
// Force and torque of every pair balance by construction, whoever gave V and x̄. The sum over pairs is exactly
// −∂U/∂x; one pair's force is not the gradient of its own U_ij: what its faces within the bodies sweep
// cancels between neighbours and is left out. V and x̄ are continuous where faces of the two coincide, so the
// force is.
//
// Second derivatives, of the first term (the second with A and B exchanged), with u_A = Σ λ_a δx_a,
// u_B = Σ λ_b δx_b and P_f the part of P's boundary on face f of j:
//
//   main     + c s_i ∫_{P_f} (u_A − u_B)·n_f (−g_B)·(u_A − u_B) dA
//   turning  − c s_i m_a ∇λ_b ⊗ g_B at (a, b), its transpose at (b, a);
//            + c s_i (m_c g_B ⊗ ∇λ_b + m_b ∇λ_c ⊗ g_B) at (b, c)
//
// On outer faces g_B = −|g_B| n_f and the main term is positive semidefinite; on others it is, summed with
// the neighbour's, the jump of g across the face. Turning is of the relative size depth/h. There is no 1/sin
// θ.
#ifndef TETLAP_CONTACT_FIELD_H
#define TETLAP_CONTACT_FIELD_H

#include "base/vec3.h"
#include "contact/search/layout.h"

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
  double depths[2];     // φ_A(x̄), φ_B(x̄): of this point below the surface of side 0, 1 [m]
  double slopes[2][3];  // g_A, g_B
  double weights[2][4]; // λ(x̄) of the vertices of the sides' tetrahedra (contact_layout_vertices)
} ContactFieldPair;

// The force of the pair over that which a linear law of 1 Pa/m would give.
static inline double contact_field_secant(const ContactFieldPair *field) {
  Vec3 push = vec3_sub(vec3_scale(field->weighed[0], vec3_at(field->slopes[1])),
                       vec3_scale(field->weighed[1], vec3_at(field->slopes[0])));
  double length = vec3_length(push);
  return length > 0 ? vec3_length(vec3_at(field->force)) / length : 0;
}

// The area that a pair covers [m²], V F / (2 U): of a slab of thickness D over an area V = ∫ D dA,
// F = 2 c ∫ D dA, U = c ∫ D² dA (against a shape F = c ∫ D dA, U = ½ c ∫ D² dA), so that it is
// (∫ D dA)² / ∫ D² dA. Exact where D is even, also in squeezed cells; ¾ of the area where D falls to 0
// linearly. With a law F and U are those of the linear one.
static inline double contact_field_area(const ContactFieldPair *field) {
  if (field->law) {
    Vec3 push = vec3_sub(vec3_scale(field->weighed[0], vec3_at(field->slopes[1])),
                         vec3_scale(field->weighed[1], vec3_at(field->slopes[0])));
    double moment = field->weighed[0] * field->depths[1] + field->weighed[1] * field->depths[0];
    return moment > 0 ? 0.5 * field->volume * vec3_length(push) / moment : 0;
  }
  double force = vec3_length(vec3_at(field->force));
  return field->energy > 0 ? 0.5 * field->volume * force / field->energy : 0;
}

// Of a pair of cells with these coordinates (2, 4, 3), V > 0 and x̄. `forces` (2, 4, 3): on the
// vertices of the two tetrahedra [N].
void contact_field_press(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                         double volume, const double centroid[3], ContactFieldPair *field, double forces[24]);

// Of a tetrahedron (4, 3) and the shape that it meets.
void contact_field_press_shape(const ContactLayout *layout, const ContactPair *pair, double time,
                               const double tet[12], ContactFieldPair *field, double forces[24]);

// ∂²U/∂x² of a pair by the vertices of the two tetrahedra, (24, 24), symmetric; the coordinates are those of
// the cells in general position (contact_layout_unsettle_pair). Not full: the main term on outer faces,
// positive semidefinite. Clipping finds P, whatever model gave V and x̄.
void contact_field_bend(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                        bool is_full, double matrix[576]);

// The same of a shape and a tetrahedron, (12, 12).
void contact_field_bend_shape(const ContactLayout *layout, const ContactPair *pair, double time,
                              const double tet[12], bool is_full, double matrix[144]);

#endif

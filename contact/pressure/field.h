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
// Where a body is folded, cells that are turned inside out (det F < 0) cover what others cover as well. Their
// φ and g count with σ = −1, and ψ of a law is odd: then the sum over all cells at a point has no jump where
// the number of them changes, and is the depth wherever the body covers it once more than it covers it inside
// out. So U is a continuous function of the positions, whose gradient the forces are, through every
// inversion. Not so in a sheet of one layer, whose tetrahedra have φ = 0 all round as their neighbours have:
// they push outwards either way.
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
// On outer faces g_B = −σ |g_B| n_f and the main term is positive semidefinite, but where σ = −1; on others
// it is, summed with the neighbour's, the jump of g across the face. Turning is of the relative size depth/h.
// There is no 1/sin θ.
#ifndef TETLAP_CONTACT_PRESSURE_FIELD_H
#define TETLAP_CONTACT_PRESSURE_FIELD_H

#include "contact/pressure/field_pair.h"
#include "contact/search/layout.h"

// Of a pair of cells with these coordinates (2, 4, 3), V > 0 and x̄. `forces` (2, 4, 3): on the
// vertices of the two tetrahedra [N].
void contact_field_press(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                         double volume, const double centroid[3], ContactFieldPair *field, double forces[24]);

// Of a tetrahedron (4, 3) and the shape that it meets.
void contact_field_press_shape(const ContactLayout *layout, const ContactPair *pair, double time,
                               const double tet[12], ContactFieldPair *field, double forces[24]);

// ∂²U/∂x² of a pair by the vertices of the two tetrahedra, (24, 24), symmetric; the coordinates are those of
// the cells in general position (contact_layout_unsettle_pair). Clipping finds P, whatever model gave V and
// x̄.
void contact_field_bend(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                        double matrix[576]);

// −∂f/∂x of the pair's forces by the vertices of the two tetrahedra, (24, 24), row by row of f, exactly, of a
// model whose ∂V/∂x and ∂x̄/∂x by the cells' coordinates are `slopes` (4, 24); no law. Unlike ∂²U/∂x² it is
// not symmetric, and it has what the pair's faces within the bodies sweep.
void contact_field_turn(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                        const ContactFieldPair *field, const double slopes[96], double matrix[576]);

// The same of a pair with a law whose volume clipping finds, by differences, to about 1e-8 of it; of a shape
// and a tetrahedron (12, 12).
void contact_field_turn_law(const ContactLayout *layout, const ContactPair *pair, double time,
                            const double coordinates[24], const ContactFieldPair *field, double *matrix);

// ∂²U/∂x² of a shape and a tetrahedron, (12, 12).
void contact_field_bend_shape(const ContactLayout *layout, const ContactPair *pair, double time,
                              const double tet[12], double matrix[144]);

#endif

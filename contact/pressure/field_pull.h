// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of what a pair of the potential `field` (contact/pressure/field.h) hands to friction,
// backwards: from those of a function g by the pair's force F, area A and weights λ(x̄) to those by the
// positions of its vertices. With m_z = ∫_P λ_z dx = V λ_z(x̄) over the intersection P of cells A and B, u_A =
// Σ λ_a δx_a, u_B likewise, and n outward on the part P_f of P's boundary that is on a face of B,
//
//   δm_a = m_a ∇·u_A + Σ_f ∫_{P_f} λ_a (u_B − u_A)·n dA  of a vertex a of A
//   δs = −s ∇·u,  δg = −(∇u)ᵀ g  of either cell;
//
// V = Σ_a m_a and V x̄ = Σ_a m_a x_a over A's vertices, all m_z follow from V and x̄, and F, A and λ are
// functions of m, s and g. Models with slopes of their own (overlap/slopes.h) give those of V and x̄
// themselves.
#ifndef TETLAP_CONTACT_PRESSURE_FIELD_PULL_H
#define TETLAP_CONTACT_PRESSURE_FIELD_PULL_H

#include "contact/pressure/field_pair.h"
#include "contact/search/layout.h"

// ∂g/∂F [g/N], ∂g/∂A [g/m²], ∂g/∂λ of the vertices of the sides' tetrahedra.
typedef struct ContactFieldSlopes {
  double force[3];
  double area;
  double weights[2][4];
} ContactFieldSlopes;

// ∂V/∂x and ∂x̄/∂x (4, 24) by the cells' coordinates, as evaluated, by clipping.
void contact_field_slopes(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                          const ContactFieldPair *field, double slopes[96]);

// Adds ∂g/∂x of the vertices of both tetrahedra (2, 4, 3) and, unless NULL, ∂g/∂V and ∂g/∂x̄ to `answer` (4).
// `coordinates` of the cells, as evaluated; no law. `slopes`: ∂V/∂x and ∂x̄/∂x (4, 24) by these.
void contact_field_pull(const ContactLayout *layout, const ContactPair *pair, const double coordinates[24],
                        const ContactFieldPair *field, const double slopes[96], const ContactFieldSlopes *by,
                        double slope[24], double answer[4]);

// The same of a tetrahedron (4, 3) and a shape with these forces on its vertices; no ball, no law.
void contact_field_pull_shape(const ContactLayout *layout, const ContactPair *pair, double time,
                              const double tet[12], const ContactFieldPair *field, const double forces[12],
                              const ContactFieldSlopes *by, double slope[12]);

#endif

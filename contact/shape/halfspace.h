// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a tetrahedron below a plane, in closed form: the overlap with a half-space obstacle.
//
// With heights s_i of the vertices above the plane, V = V_tet F(s). The fraction F is a divided difference of
// a truncated cubic (Hermite and Genocchi), its derivatives are B-splines with the heights as knots (Curry
// and Schoenberg 1966: the section of a simplex is a B-spline):
//
//   F = −[s₀ s₁ s₂ s₃] g,   ∂F/∂s_i = −[s₀ s₁ s₂ s₃ s_i] g,
//
// g(s) = max(−s, 0)³. They are evaluated by recurrences that add non-negative terms and divide by differences
// that span the plane, so a vertex, edge or face near the plane costs no digits, at any scale.
//
// The mean depth max(−s, 0) over the tetrahedron is the same with one power more,
//
//   D = −¼ [s₀ s₁ s₂ s₃] h,   ∂D/∂s_i = −¼ [s₀ s₁ s₂ s₃ s_i] h,   ∂²D/∂s_i∂s_j = −¼ (1 + δ_ij) [s₀ s₁ s₂ s₃
//   s_i s_j] h,
//
// h(s) = max(−s, 0)⁴, convex in the heights. By Leibniz' rule [t₀ … t_n] s g = t₀ [t₀ … t_n] g + [t₁ … t_n] g
// with t₀ the lowest, again in terms of one sign.
#ifndef TETLAP_CONTACT_SHAPE_HALFSPACE_H
#define TETLAP_CONTACT_SHAPE_HALFSPACE_H

// The solid is { x : normal·(x − point) ≤ 0 }; `normal` has unit length. Either orientation of the
// tetrahedron. V [m³], and, where not NULL, dV/dx of the four vertices [m²]. V is C² where one vertex crosses
// the plane; with an edge in the plane d²V/dx² stays bounded but jumps, with a face in it dV/dx jumps.
// Scale-free: no tolerance. A tetrahedron that only touches the plane from above has V = 0 and no
// derivatives.
void contact_halfspace_overlap(const double tet[12], const double point[3], const double normal[3],
                               double *volume, double gradient[12]);

// The overlap V [m³], and of the potential `field` (contact/pressure/field.h) with c = 1 Pa/m the energy
// `rest_volume` · D [m⁴] and, where not NULL, its derivatives [m³] and [m²] (12 × 12, positive semidefinite).
void contact_halfspace_press(const double tet[12], const double point[3], const double normal[3],
                             double rest_volume, double *volume, double *energy, double gradient[12],
                             double hessian[144]);

#endif

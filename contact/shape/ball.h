// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a tetrahedron inside a ball, in closed form: the overlap with a ball as obstacle.
//
// About the ball's centre the volume is a sum over faces. With d the signed distance of the face's plane, A
// the area of the face inside the ball and Ω the solid angle under which its part outside is seen,
//
//   V = Σ_faces ⅓ (d A + sgn(d) R³ Ω),
//
// and A, Ω and the first moment of the part inside are sums over the face's edges about the foot of the
// centre on the plane: triangles where an edge runs inside the circle, sectors where it runs outside. This is
// the decomposition of Strobl, Formella and Pöschel 2016, there for general meshes. Here pieces have signs,
// so that no case needs to be told from another. Each term is elementary; the solid angle of a triangle with
// a right angle at the foot of an edge is that of van Oosterom and Strackee (1983).
//
//   ∂V/∂x_a = Σ_faces ∋ a ∫ N_a n dA over the part inside, N_a linear on the face.
//
// ∫ r² over the part inside, r the distance from the centre, is the same sum with weights of one degree two
// more,
//
//   Σ_faces ⅕ (d ∫ r² dA + sgn(d) R⁵ Ω),
//
// and gives the mean depth (R² − r²)/(2R) of the potential `field` in closed form.
//
// Rounding: about 1e-16 R² h of a tetrahedron of size h, so relative to its volume 1e-16 (R/h)².
#ifndef TETLAP_CONTACT_SHAPE_BALL_H
#define TETLAP_CONTACT_SHAPE_BALL_H

#include <stdbool.h>

// The weights of the corners (4) at the tetrahedron's point that is nearest to the centre; those of the
// middle if the centre lies inside. A continuous function of the corners.
void contact_ball_nearest(const double tet[12], const double centre[3], double weights[4]);

// `tet` (4, 3), of either orientation. `gradient` (4, 3) may be NULL; all outputs are written.
void contact_ball_overlap(const double tet[12], const double centre[3], double radius, double *volume,
                          double gradient[12]);

// The overlap V [m³], and of the potential `field` (contact/pressure/field.h) with c = 1 Pa/m the energy of a
// tetrahedron of that rest volume [m⁴], its gradient [m³] and, where not NULL, the Hessian [m²]. That
// is made of central differences of the gradient, symmetrised: right to about 1e-8 of its largest entry,
// except where the sphere touches an edge or a vertex. Its negative part is −s/R ∫ |δu|² ≥ −s/R V Σ |δu_v|²:
// while as much is added, negative eigenvalues by rounding, of flat tetrahedra, are removed
// (contact/shape/definite.h).
void contact_ball_press(const double tet[12], const double centre[3], double radius, double rest_volume,
                        double *volume, double *energy, double gradient[12], double hessian[144]);

// Distance of the tetrahedron from the sphere: negative once they overlap, −radius if the centre lies inside.
double contact_ball_separation(const double tet[12], const double centre[3], double radius);

#endif

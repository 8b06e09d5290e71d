// SPDX-License-Identifier: GPL-3.0-or-later
// The potential `field` (contact/pressure/field.h) with a pressure law p(d) (contact/pressure/law.h) in place
// of the linear one:
//
//   U = ∫_A ψ(φ_B) dX + ∫_B ψ(φ_A) dX,   ψ = ½ p;   against a shape without elements U = ∫_A p(φ) dX.
//
// Two flat surfaces that overlap by d press with p(d), either way.
//
// Force of a pair. ∫_P ψ′(φ) λ_z dx is taken at two points of P for each of the two depths, those of Gauss:
// with φ̄, σ² and γ of the depth in P (mean, variance, skewness) and C λ its covariance with λ,
//
//   φ_k = φ̄ + ξ_k σ,   λ_k = λ̄ + ξ_k C λ / σ,   ξ = ½ γ ± √(1 + ¼ γ²),   weights ½ (1 ∓ γ/√(4 + γ²)).
//
// The resultant is exact where p is a polynomial of fourth degree, the force where it is of second. Points of
// A and B are the same, so each pair balances. The moments are those of the clipped polyhedron, whatever
// model gave V and x̄; where there is none, x̄ alone is used.
//
// Second derivatives as in field.h with ψ′ at the points of faces and volume in place of c, and
//
//   bulk   + s_i ∫_P ψ″(φ_B) (g_B·(u_A − u_B))² dx,
//
// by rules that are exact where ψ″ is constant.
#ifndef TETLAP_CONTACT_PRESSURE_FIELD_LAW_H
#define TETLAP_CONTACT_PRESSURE_FIELD_LAW_H

#include <float.h>
#include <math.h>

#include "contact/pressure/clipped.h"
#include "contact/pressure/field_pair.h"
#include "contact/pressure/law.h"
#include "contact/pressure/side.h"

// The share of p that each of two depths has.
#define CONTACT_FIELD_HALF 0.5

// Energy and force of a pair whose V, x̄, depths, slopes and weights are there; the forces on the vertices.
void contact_field_law_press(const ContactLayout *layout, const ContactPair *pair,
                             const double coordinates[24], const ContactSide sides[2],
                             ContactFieldPair *field, double forces[24]);

// How far a central difference goes, as a share of a depth or of an exponent: what it omits, the square of
// this, is √ε, and rounding less.
static inline double contact_field_law_step(void) {
  return sqrt(sqrt(DBL_EPSILON));
}

// What faces and volume add up to: ∫_{P_f} ψ′ λ_z λ_w dA over the area of face f, of the faces with a bit in
// `wanted`; of the depth in side t ∫_P ψ′ λ_z dx and ∫_P ψ″ λ_z λ_w dx.
typedef struct ContactFieldLawSums {
  double face[8][8][8];
  double first[2][8];
  double second[2][8][8];
} ContactFieldLawSums;

void contact_field_law_add(ContactClipped *clipped, const ContactLaw *law, const ContactSide sides[2],
                           ContactFieldLawSums *sums);

// Energy [J], its derivatives [N] by the tetrahedron's vertices and, where not NULL, [N/m], of a tetrahedron
// of that rest volume and a shape that it overlaps. By layers: with E(c) the energy at 1 Pa/m against the
// shape that is smaller by the depth c, where the depth is φ − c,
//
//   U = p′(0) E(0) + ∫ p″(c) E(c) dc.
//
// Of a law's derivative by its exponent there is no Hessian.
void contact_field_law_press_shape(const ContactShape *shape, const ContactLaw *law, double time,
                                   const double tet[12], double rest_volume, double *energy,
                                   double gradient[12], double hessian[144]);

#endif

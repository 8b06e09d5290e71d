// SPDX-License-Identifier: GPL-3.0-or-later
// The potential `nodal`: contact by volumes alone. It is for a model whose V is a usable function while the
// centroid that follows from its ∇V is not, such as a network after the paper. The energy is a function of V
// and the forces are its own gradient, so energy is kept whatever V is. There is no friction and no
// viscosity.
//
//   W_a = ¼ Σ_{i∋a} Σ_j V_ij,   U = Σ_a ½ c_a W_a²,   c_a = w κ / V_a [Pa/m³],   κ [Pa]
//   p_ij = ∂U/∂V_ij = ¼ Σ_{a∈i} c_a W_a + ¼ Σ_{b∈j} c_b W_b,   U = Σ U_ij,  U_ij = ½ p_ij V_ij
//   f_ij = −p_ij ∇V_ij   on the eight vertices of two tetrahedra
//
// V_a is a vertex's share of the rest volume. w is ½ between two bodies; against an obstacle or a shape only
// the body's side counts, w = 1.
//
// The matrix is Σ p_ij/V_ij ∇V_ij ∇V_ijᵀ = Σ f_ij f_ijᵀ / (2 U_ij). It is never less than Σ c_a ∇W_a ∇W_aᵀ
// (Cauchy and Schwarz), and equal where each ∇V_ij is in proportion to V_ij, as of flat faces that go into
// each other. The part Σ p_ij ∇²V_ij of U's second derivative is left out: that changes how fast Newton's
// method converges, not what it finds.
#ifndef TETLAP_CONTACT_VOLUME_VOLUME_H
#define TETLAP_CONTACT_VOLUME_VOLUME_H

#include "contact/pressure/field.h"
#include "contact/pressure/patch/patches.h"

// The pairs of an evaluation; all arrays are borrowed.
typedef struct ContactVolumePairs {
  const ContactPatches *patches;
  const double *coordinates; // as the model saw them [m]              (pair_count, 2, 4, 3)
  const double *volumes;     // V_ij [m³]                              (pair_count)
  const double *gradients;   // ∇V_ij [m²]; a shape's part zeros       (pair_count, 2, 4, 3)
  double *nodes;             // scratch                                (node_count)
  ContactFieldPair *fields;  // out                                    (pair_count)
  double *forces;            // out: f_ij [N]                          (pair_count, 2, 4, 3)
} ContactVolumePairs;

// Fills forces, and of `fields` what they mean here. The area is |Σ ∂V/∂x_A|, what is covered as seen along
// the mean normal; depths are V over it. Slopes lie along the force, x̄ and the weights are those of the
// force, and both `weighed` are V.
void contact_volume_press(const ContactLayout *layout, const ContactVolumePairs *pairs);

// The matrix of a pair with that U_ij by the first `count` of its vertices, (3 count, 3 count).
void contact_volume_bend(double energy, const double forces[24], int count, double *matrix);

#endif

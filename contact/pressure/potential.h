// SPDX-License-Identifier: GPL-3.0-or-later
// The contact potentials: from covered volumes to energy and pressure. U depends on the overlap volumes of
// one facing's pairs only, so that force and stiffness follow from p_ij = ∂U/∂V_ij and the curvatures below.
// The formulas stand in contact/system.h.
#ifndef TETLAP_CONTACT_POTENTIAL_H
#define TETLAP_CONTACT_POTENTIAL_H

#include "contact/pressure/patches.h"

// The energy of one patch [J] from `volumes` V_ij of all pairs, W_i of its elements and W_a of its nodes;
// writes `pressures` p_ij of the patch's pairs [Pa].
double contact_potential_apply(const ContactLayout *layout, const ContactPatches *patches,
                               const ContactPatch *patch, const ContactPair *pairs, const double *volumes,
                               double *pressures);

// What U's second derivative by the volumes is made of: Σ c ∇w ∇wᵀ over
//   nodal: w = W_a of each node;  element: W_i of each element;  pair: V_ij of each pair;  body: Σ V_ij once;
//   linear: nothing. The coefficients c [Pa/m³]:
double contact_potential_node_curvature(const ContactLayout *layout, const ContactFacing *facing,
                                        const ContactNode *node);
double contact_potential_element_curvature(const ContactLayout *layout, const ContactFacing *facing,
                                           const ContactElement *element);
double contact_potential_pair_curvature(const ContactLayout *layout, const ContactPair *pair);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The contact potential `nodal`: from covered volumes to energy and pressure. U depends on the overlap
// volumes of one interface's pairs only, so that force and stiffness follow from p_ij = ∂U/∂V_ij and the
// curvature below. The formula stands in contact/def.h.
#ifndef TETLAP_CONTACT_POTENTIAL_H
#define TETLAP_CONTACT_POTENTIAL_H

#include "contact/pressure/patches.h"

// The energy of one patch [J] from W_a of its nodes; writes `pressures` p_ij of the patch's pairs [Pa].
double contact_potential_apply(const ContactLayout *layout, const ContactPatches *patches,
                               const ContactPatch *patch, double *pressures);

// c_a [Pa/m³] of a node: U's second derivative by the volumes is Σ_a c_a ∇W_a ∇W_aᵀ.
double contact_potential_curvature(const ContactLayout *layout, const ContactInterfaceDef *interface,
                                   const ContactNode *node);

#endif

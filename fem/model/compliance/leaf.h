// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff contact may be between two leaves that bend together, as those of a leaf spring.
//
// Two meshes of the edge length h that are bent to the curvature κ lie up to h²κ/8 apart where their edges do
// not match. A contact that is too stiff closes these gaps by force: between two leaves of which each bears
// half a load, the force was four times the true one. A force Q per width at the end of leaves of the length
// L bends them to κ = Q L/D. Through contact of the stiffness c it spreads along λ:
//
//   λ = (2 D/c)^(1/4),   1/D = 1/D_A + 1/D_B,   D = E' t³/12,   E' = E/(1 − ν²),
//
// where t is the thickness of a leaf. The leaves overlap by Q/(2 c λ) ~ Q λ³/D. Whatever Q is, this is more
// than the gaps if λ³ is more than a multiple of L h²:
//
//   c ≤ 2 D/λ⁴,   λ³ = 1.5 L h²,   L of the shorter one, h of the coarser one.
//
// The place where the force acts is then wrong by about 0.4 λ. The bound holds in static scenes, for two
// bodies each at least ten times as long as thick. It does not hold for leaves that are squeezed, which are
//
//   - those in scenes where another body or an obstacle is moved,
//   - those of which one is fixed or driven along more than half of its length,
//   - those that the sum of all loads would press into each other by a twentieth of the thickness of the
//     thinner one.
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_LEAF_H
#define TETLAP_FEM_MODEL_COMPLIANCE_LEAF_H

#include "fem/model/compliance/extent.h"

// The largest c of these two [Pa/m]; INFINITY: there is no such bound.
double fem_leaf_stiffness(const FemModel *model, const int bodies[2], const FemExtent extents[2]);

#endif

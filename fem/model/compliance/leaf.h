// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff contact may be between two leaves that bend together, as those of a leaf spring.
//
// Bent to the curvature κ, meshes of the edges h lie up to h²κ/8 apart where their edges do not match. A
// contact that is stiff beside this forces them upon each other: the force between two leaves of which each
// bears half a load was four times as large. A force Q at the end of leaves of the length L bends them to
// κ = Q L/D, and spreads along
//
//   λ = (2 D/c)^(1/4),   1/D = 1/D_A + 1/D_B,   D = E' t³/12,   E' = E/(1 − ν²),
//
// so that they overlap by Q/(2 c λ) ~ Q λ³/D. That is more than h²κ/8 whatever Q is where λ³ is more than a
// multiple of L h²:
//
//   c ≤ 2 D/λ⁴,   λ³ = 1.5 L h²,   L of the shorter one, h of the coarser one.
//
// Where the force acts is wrong by about .4 λ. The bound holds in static scenes, for two bodies at least ten
// times as long as thick. It does not hold for what is squeezed: where another body or an obstacle is moved,
// where what is fixed or driven of one of the two reaches along more than half of it, and where it lets the
// largest sum of loads press them into each other by a twentieth of their thickness.
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_LEAF_H
#define TETLAP_FEM_MODEL_COMPLIANCE_LEAF_H

#include "fem/model/compliance/extent.h"

// The largest c of these two [Pa/m]; INFINITY: there is no such bound.
double fem_leaf_stiffness(const FemModel *model, const int bodies[2], const FemExtent extents[2]);

#endif

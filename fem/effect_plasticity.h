// SPDX-License-Identifier: GPL-3.0-or-later
// What the recorder asks of the effect `plasticity`.
#ifndef TETLAP_FEM_EFFECT_PLASTICITY_H
#define TETLAP_FEM_EFFECT_PLASTICITY_H

// Adds what the plastic strain of a tetrahedron at these corners (4, 3) takes off, to its Cauchy stress [Pa]
// (xx, yy, zz, xy, yz, xz).
void fem_effect_plasticity_add_stress(const void *self, int tet, const double x[12], double stress[6]);

#endif

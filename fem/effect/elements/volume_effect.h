// SPDX-License-Identifier: GPL-3.0-or-later
// The inside of the effect `volume`, for output.
#ifndef TETLAP_FEM_EFFECT_ELEMENTS_VOLUME_EFFECT_H
#define TETLAP_FEM_EFFECT_ELEMENTS_VOLUME_EFFECT_H

// Adds the vertices' mean pressure in a tetrahedron of a nodal body, at the state last evaluated, to its
// Cauchy stress [Pa] (xx, yy, zz, xy, yz, xz).
void fem_effect_volume_add_stress(const void *self, int tet, const double x[12], double stress[6]);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// The stress of an element at a state, by all effects that give it one.
#ifndef TETLAP_FEM_MEASURE_STRESS_H
#define TETLAP_FEM_MEASURE_STRESS_H

#include "fem/effect/system.h"

// Cauchy stress xx, yy, zz, xy, yz, xz of a tetrahedron [Pa]; 0 of an obstacle's.
void fem_stress_find(const FemSystem *system, const FemState *state, int tet, double stress[6]);

double fem_stress_von_mises(const double stress[6]);

#endif

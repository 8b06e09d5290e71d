// SPDX-License-Identifier: GPL-3.0-or-later
// The neo-Hookean law of CalculiX and Abaqus, whose deviatoric part depends on the change of shape alone
// (formulas in fem/material/material.h). For fem/material/material.c alone.
#ifndef TETLAP_FEM_MATERIAL_ISOCHORIC_H
#define TETLAP_FEM_MATERIAL_ISOCHORIC_H

#include "fem/material/law.h"

// Below this J the power J^(−2/3) goes on as its parabola, so that it is finite for every F and pushes an
// inverted element back.
#define FEM_MATERIAL_ISOCHORIC_SMALLEST 0.05

// J^(−2/3), less 1, with its derivatives by J.
typedef struct FemMaterialPower {
  double less_one, slope, bend;
} FemMaterialPower;
FemMaterialPower fem_material_isochoric_power(double swelling); // of J − 1

void fem_material_isochoric_stress(const FemMaterial *material, const double F[9], double P[9]);

#endif

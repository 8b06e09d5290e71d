// SPDX-License-Identifier: GPL-3.0-or-later
// The logarithm of the volume ratio, and the neo-Hookean law that is made of it (formulas in
// fem/material/material.h). For fem/material/material.c alone.
#ifndef TETLAP_FEM_MATERIAL_LOG_H
#define TETLAP_FEM_MATERIAL_LOG_H

#include "fem/material/law.h"

// Below this J the logarithm goes on as its parabola, which falls without end, so that it is finite for every
// F and pushes an inverted element back. The law's pressure has reached 80 E there (ν = 0.4).
#define FEM_MATERIAL_LOG_SMALLEST 0.05

// θ = ln J with its derivatives by J.
typedef struct FemMaterialLog {
  double value, slope, bend;
} FemMaterialLog;
FemMaterialLog fem_material_log(double swelling); // of J − 1

void fem_material_log_stress(const FemMaterial *material, const double F[9], double P[9]);

#endif

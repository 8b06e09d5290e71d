// SPDX-License-Identifier: GPL-3.0-or-later
// Mooney–Rivlin and Ogden in compressible form, finite for every F (formulas in fem/material/material.h). For
// fem/material/material.c alone: J − 1 and cof F as in fem/material/cofactor.h.
#ifndef TETLAP_FEM_MATERIAL_RUBBER_H
#define TETLAP_FEM_MATERIAL_RUBBER_H

#include "fem/material/law.h"

void fem_material_mooney_stress(const FemMaterial *material, const double F[9], double P[9]);
void fem_material_ogden_stress(const FemMaterial *material, const double F[9], double P[9]);

// Below this stretch Ogden's w goes on as its parabola, so that it is finite for σ ≤ 0. Sums of stretches
// below the other count as it: f is large where σ is small.
#define FEM_MATERIAL_OGDEN_SMALLEST 0.1
#define FEM_MATERIAL_OGDEN_SMALLEST_SUM 1e-4

// f(σ) = w'(σ) = Σ μ_p σ^(α_p − 1), above its edge: μ_p, 0 for a term that is not there, and α_p − 1.
typedef struct FemOgden {
  double own[3], power[3];
} FemOgden;
FemOgden fem_material_ogden(const FemMaterial *material);
// f and f' at the edge.
typedef struct FemOgdenForce {
  double value, slope;
} FemOgdenForce;
FemOgdenForce fem_material_ogden_edge(const FemMaterial *material);

#endif

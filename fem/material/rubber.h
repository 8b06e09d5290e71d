// SPDX-License-Identifier: GPL-3.0-or-later
// Mooney–Rivlin and Ogden in compressible form, finite for every F (formulas in fem/material/material.h). For
// fem/material/material.c alone: J − 1 and cof F as in fem/material/cofactor.h.
#ifndef TETLAP_FEM_MATERIAL_RUBBER_H
#define TETLAP_FEM_MATERIAL_RUBBER_H

#include "fem/material/law.h"

double fem_material_mooney_energy(const FemMaterial *material, const double F[9]);
void fem_material_mooney_stress(const FemMaterial *material, const double F[9], double P[9]);
void fem_material_mooney_tangent(const FemMaterial *material, const double F[9], double dP[81]);

double fem_material_ogden_energy(const FemMaterial *material, const double F[9]);
void fem_material_ogden_stress(const FemMaterial *material, const double F[9], double P[9]);
void fem_material_ogden_tangent(const FemMaterial *material, const double F[9], double dP[81]);

#endif

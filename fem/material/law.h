// SPDX-License-Identifier: GPL-3.0-or-later
// The parameters of a material, by law (formulas in fem/material/material.h).
#ifndef TETLAP_FEM_MATERIAL_LAW_H
#define TETLAP_FEM_MATERIAL_LAW_H

#include <stdbool.h>

typedef enum FemMaterialLaw {
  FEM_MATERIAL_LINEAR,                // small strain: ε = sym(F) − I
  FEM_MATERIAL_COROTATIONAL,          // linear in the polar stretch
  FEM_MATERIAL_STVK,                  // St. Venant–Kirchhoff
  FEM_MATERIAL_NEO_HOOKEAN,           // stable neo-Hookean (Smith, de Goes, Kim 2018)
  FEM_MATERIAL_NEO_HOOKEAN_LOG,       // with ln J
  FEM_MATERIAL_NEO_HOOKEAN_ISOCHORIC, // with J^(−2/3), as in CalculiX and Abaqus
  FEM_MATERIAL_MOONEY_RIVLIN,
  FEM_MATERIAL_OGDEN,
} FemMaterialLaw;

enum { FEM_MATERIAL_LAW_COUNT = 8 };

// Sums of stretches below count as this in corotational's derivative (fem/material/material.h).
#define FEM_MATERIAL_SMALLEST_SUM 1e-6

typedef struct FemMaterial {
  FemMaterialLaw law;
  double young;   // E > 0 [Pa]
  double poisson; // −1 < ν < ½
  double density; // [kg/m³]
  double damping; // β of stiffness-proportional damping [s]; < 0: the scene's
  // Kelvin–Voigt: a viscous second Piola–Kirchhoff stress 2η dev Ė + ζ tr Ė I beside the elastic one.
  double viscosity, bulk_viscosity; // η, ζ ≥ 0 [Pa s]
  double yield_stress, hardening;   // σ_y, 0: elastic, and H of the effect plasticity [Pa]
  double mooney;                    // m of mooney_rivlin, in [0, 1]
  double exponents[3], shares[3];   // α_p and shares of ogden's terms; the shares are divided by their sum
  double fibre_stiffness;           // k [Pa]; 0: no fibres
  double fibre_direction[3];        // need not have unit length
  bool fibres_buckle;
} FemMaterial;

typedef struct FemLame {
  double lambda, mu; // [Pa]
} FemLame;
FemLame fem_material_lame(const FemMaterial *material);

#endif

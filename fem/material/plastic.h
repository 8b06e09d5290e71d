// SPDX-License-Identifier: GPL-3.0-or-later
// J2 plasticity with linear isotropic hardening at a point: radial return from a history to a strain E
// (Simo and Hughes, Computational Inelasticity, 3.3),
//
//   yield: q = √(3/2) |s| ≤ σ_y + H α,   s = 2μ dev(E − E_p)
//   Δα = (q_trial − σ_y − H α)/(3μ + H),   ΔE_p = √(3/2) Δα n,   n = s/|s|
#ifndef TETLAP_FEM_MATERIAL_PLASTIC_H
#define TETLAP_FEM_MATERIAL_PLASTIC_H

#include "fem/material/law.h"

// What a point remembers; numbers only, as a history keeps them.
typedef struct FemPlastic {
  double strain[9]; // E_p, symmetric, without trace
  double alpha;     // accumulated plastic strain
} FemPlastic;

// A return: the new plastic state, and its derivative ∂E_p/∂E = along n ⊗ n + across (I_dev − n ⊗ n).
typedef struct FemPlasticReturn {
  FemPlastic plastic;
  double n[9]; // where it does not yield, s
  double size; // |s| of the trial
  double along, across;
  double growth; // Δα; 0: it does not yield
} FemPlasticReturn;

FemPlasticReturn fem_plastic_return(const FemMaterial *material, const FemPlastic *history,
                                    const double E[9]);

// Derivatives of a function g by what a return starts from.
typedef struct FemPlasticSlope {
  double strain[9];   // by E
  FemPlastic history; // by the history
  double mu, yield, hardening;
} FemPlasticSlope;

// Adds what g has through the new plastic state, by whose numbers its derivatives are `by`.
void fem_plastic_pull(const FemMaterial *material, const FemPlastic *history, const FemPlasticReturn *r,
                      const FemPlastic *by, FemPlasticSlope *slope);

#endif

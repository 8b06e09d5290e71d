// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/material/law.h"

FemLame fem_material_lame(const FemMaterial *material) {
  double E = material->young, nu = material->poisson;
  return (FemLame){.lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), .mu = E / (2 * (1 + nu))};
}

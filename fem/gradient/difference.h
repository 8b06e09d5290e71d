// SPDX-License-Identifier: GPL-3.0-or-later
// f'(p) ≈ Σ weight f(p + place · step) / step, to the sixth order of the step, exact for polynomials of
// degree six (Fornberg 1988).
#ifndef TETLAP_FEM_GRADIENT_DIFFERENCE_H
#define TETLAP_FEM_GRADIENT_DIFFERENCE_H

enum { FEM_DIFFERENCE_POINTS = 6 };

typedef struct FemDifferencePoint {
  double place, weight;
} FemDifferencePoint;

static const FemDifferencePoint fem_difference[FEM_DIFFERENCE_POINTS] = {
    {-3, -1.0 / 60}, {-2, 3.0 / 20}, {-1, -3.0 / 4}, {1, 3.0 / 4}, {2, -3.0 / 20}, {3, 1.0 / 60}};

// Exact of what is linear in p.
static const FemDifferencePoint fem_difference_linear[2] = {{-1, -0.5}, {1, 0.5}};

#endif

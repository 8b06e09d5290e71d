// SPDX-License-Identifier: GPL-3.0-or-later
// The pressure of contact on a patch of a body's surface, the vertices of a probe, with its derivatives.
// Pairs of cells press with p = |F|/A (contact/pressure/field_pair.h), W the weight of the patch's vertices
// at x̄,
//
//   P = Σ W |F| pᵐ / Σ W A pᵐ,
//
// with m = 0 the force over the area that is touched. The larger m is the nearer P is to the largest p, from
// below: with m = 8 it is 10/11 of the peak of a pressure that falls off as a half ellipse (Hertz's), and
// all of an even one.
#ifndef TETLAP_FEM_GRADIENT_CONTACT_PRESSURE_H
#define TETLAP_FEM_GRADIENT_CONTACT_PRESSURE_H

#include "fem/gradient/tangent.h"

enum { FEM_PRESSURE_MEAN = 0, FEM_PRESSURE_PEAK = 8 }; // m

// STATUS_INPUT: what presses there has no such derivatives.
Status fem_pressure_check(const FemModel *model);

// What it is taken of. Zeroed and with the first two set it tells P alone.
typedef struct FemPressure {
  int probe, power; // of the model's; m
  double *slope;    // ∂P/∂x, added; NULL: not wanted                        (vertex_count, 3)
  double *answers;  // ∂P/∂V, ∂P/∂x̄ of pairs of meshes, added; NULL: not wanted (mesh_pair_count, 4)
  int interface;    // whose pairs' derivatives are wanted, or CONTACT_ALL_INTERFACES
  double weight;    // of what is added
  double stiffness; // out: ∂P/∂ ln κ of these pairs
} FemPressure;

// P [Pa]; 0 where nothing presses.
Status fem_pressure_find(FemPressure *pressure, const FemTangent *tangent, double *value);

#endif

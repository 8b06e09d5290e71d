// SPDX-License-Identifier: GPL-3.0-or-later
// Velocities that bodies start with, v = velocity + ω × (x − c), as parameters change them. c, the centre of
// mass, moves by the densities of a body's parts and by its shape.
#ifndef TETLAP_FEM_GRADIENT_PATH_START_H
#define TETLAP_FEM_GRADIENT_PATH_START_H

#include "fem/gradient/parameter.h"

// ∂v/∂p at t = 0 with `rests` = ∂X/∂p, both (vertex_count, 3). A run that goes on from another has no
// velocities of its own: 0.
Status fem_start_find(const FemModel *model, const FemParameter *parameter, const double *rests,
                      double *rates);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Divides a model among ranks (base/ranks.h): which of them has a vertex, and with it elements and rows.
#ifndef TETLAP_FEM_MODEL_DIVISION_H
#define TETLAP_FEM_MODEL_DIVISION_H

#include "fem/model/model.h"

// Makes model->share; one process: NULL. The first rank divides and tells the others, so it is the same on
// all. Vertices of obstacles go to the first.
Status fem_model_divide(FemModel *model);
void fem_model_division_destroy(FemModel *model);

// How many linear and quadratic elements of bodies this rank has.
int fem_model_division_elements(const FemModel *model);

#endif

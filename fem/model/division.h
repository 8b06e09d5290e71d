// SPDX-License-Identifier: GPL-3.0-or-later
// Divides a model among ranks (base/ranks.h): which of them has a vertex, and with it elements and rows.
#ifndef TETLAP_FEM_MODEL_DIVISION_H
#define TETLAP_FEM_MODEL_DIVISION_H

#include "fem/model/model.h"

// Makes model->share; one process: NULL. The first rank divides and sends that to the others, so it is the
// same on all. Vertices of obstacles go to the first.
Status fem_model_divide(FemModel *model);
void fem_model_division_destroy(FemModel *model);

// What ranks would have of a model, least and most of any.
typedef struct FemDivisionPlan {
  int rank_count;
  int vertices[2], elements[2];
  int copies[2]; // vertices of their elements that are others'
} FemDivisionPlan;

Status fem_model_division_plan(const FemModel *model, int rank_count, FemDivisionPlan *plan);

// How many linear and quadratic elements of bodies this rank has.
int fem_model_division_elements(const FemModel *model);

#endif

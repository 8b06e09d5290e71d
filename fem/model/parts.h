// SPDX-License-Identifier: GPL-3.0-or-later
// What a body is made of: its parts, of a material each.
#ifndef TETLAP_FEM_MODEL_PARTS_H
#define TETLAP_FEM_MODEL_PARTS_H

#include "fem/model/model.h"

// Appends a body's parts, those that have elements, and says of each element in which it is. STATUS_INPUT: a
// selection holds none, an element is in two or in none; the message says which.
Status fem_model_parts_append(FemModel *model, int body, const FemMesh *mesh);

// How much of the surface is of each part, where inner faces are known.
Status fem_model_parts_measure(FemModel *model);

double fem_model_parts_volume(const FemModel *model, int body); // of a body [m³]
// Of a part, lumped as masses are (vertex_count); zeroed first [m³].
void fem_model_parts_spread(const FemModel *model, int part, double *volumes);

// The mean over a body's volume, and over its surface, of what is of its material.
typedef double FemModelPartValue(const FemMaterial *material);
double fem_model_parts_mean(const FemModel *model, int body, FemModelPartValue *value);
double fem_model_parts_surface_mean(const FemModel *model, int body, FemModelPartValue *value);
// The smallest of it.
double fem_model_parts_least(const FemModel *model, int body, FemModelPartValue *value);

#endif

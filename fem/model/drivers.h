// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinates whose motion is prescribed: fixed, driven, those of obstacles with a mesh.
#ifndef TETLAP_FEM_MODEL_DRIVERS_H
#define TETLAP_FEM_MODEL_DRIVERS_H

#include "fem/mesh/mesh.h"
#include "fem/model/model.h"

// Makes the drivers of the model's bodies and obstacles; `meshes` are theirs, in this order. STATUS_INPUT: a
// selection is empty, or a vertex is prescribed twice in a component; the message names body and key.
Status fem_model_drivers_create(FemModel *model, const FemMesh *meshes);

// Positions and velocities of all coordinates that are prescribed once what is due until `released` has been
// released, at a time; the others are left alone.
void fem_model_drivers_move(const FemModel *model, double released, double time, double *positions,
                            double *velocities);

#endif

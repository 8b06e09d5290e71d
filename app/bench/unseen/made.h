// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies from a mesh generator that is not in the training data: boxes filled by gmsh.
#ifndef TETLAP_APP_BENCH_UNSEEN_MADE_H
#define TETLAP_APP_BENCH_UNSEEN_MADE_H

#include "fem/mesh/mesh.h"

// A box of that size, its middle over x = y = 0, from z = 0 up, filled by Delaunay tetrahedra with edges of
// about `edge` at one end and `growth` times that at the other, along x. Destroy it with fem_mesh_destroy.
// STATUS_IO, STATUS_INPUT: what reading a .geo fails with, such as gmsh not being there.
Status app_unseen_made_create(FemMesh *mesh, const double size[3], double edge, double growth);

#endif

// SPDX-License-Identifier: GPL-3.0-or-later
// Curved edges for a mesh whose file has straight ones.
#ifndef TETLAP_FEM_MESH_CURVE_H
#define TETLAP_FEM_MESH_CURVE_H

#include "fem/mesh/mesh.h"

// Gives a mesh of straight edges `middles`, for fem_mesh_make_quadratic: of edges on a curved part of the
// surface, where the smooth surface through the vertices is (contact/surface/smooth/smooth_points.h, exact
// for quadratic surfaces); of others halfway. Edges between faces that make more than `crease` [°] stay
// between the surfaces on both sides: a curved one is a curve through its vertices. A mesh with middles keeps
// its own.
Status fem_mesh_curve(FemMesh *mesh, double crease);

#endif

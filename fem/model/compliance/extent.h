// SPDX-License-Identifier: GPL-3.0-or-later
// How large a body is, of any shape and however it is turned.
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_EXTENT_H
#define TETLAP_FEM_MODEL_COMPLIANCE_EXTENT_H

#include "base/vec3.h"
#include "fem/model/model.h"

typedef struct FemExtent {
  double height; // the smaller of √12 times the least radius of inertia, which is the least edge of a box,
                 // and six times the volume over the surface, which is the edge of a cube and follows the
                 // wall of what is hollow [m]
  double length; // √12 times the largest radius of inertia, the largest edge of a box [m]
  Vec3 axis;     // along the length, of length 1
  double edge;   // how far a facet of the surface reaches along the axis, in the mean [m]
} FemExtent;

Status fem_extent_measure(const FemModel *model, int body, FemExtent *extent);

#endif

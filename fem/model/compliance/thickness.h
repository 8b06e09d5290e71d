// SPDX-License-Identifier: GPL-3.0-or-later
// How many elements lie through the thickness of a body that bends. From the middle of a triangle of the
// surface inwards along its normal to where the body ends is the thickness there; the height of the
// triangle's own element over it is a layer. A body counts as slender where that thickness is at most a fifth
// of its length (extent.h) on at least half of its surface, however it is turned.
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_THICKNESS_H
#define TETLAP_FEM_MODEL_COMPLIANCE_THICKNESS_H

#include "fem/model/model.h"

typedef struct FemThickness {
  bool is_slender;
  double thickness; // median by area of where it is thin [m]; 0: it is not slender
  double layers;    // likewise, of the elements through it
  double wall; // what an impact has to go through, a continuous function of the shape: the height of what
               // is solid; the mean thickness of the middle fifth of the surface's area up to a fifth
               // of the length, from a third on the height, in between what lies between [m]
} FemThickness;

// Of a body at rest; on a large surface of a few hundred triangles of it.
Status fem_thickness_find(const FemModel *model, int body, FemThickness *thickness);

#endif

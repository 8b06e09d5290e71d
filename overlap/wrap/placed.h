// SPDX-License-Identifier: Apache-2.0
// The centroid of clipping with the volume of the model: a force needs a place, and a model that gives V
// alone has none. Where clipping finds no overlap and the model does, the place is the middle of what is
// common to both bounding boxes.
#ifndef TETLAP_OVERLAP_WRAP_PLACED_H
#define TETLAP_OVERLAP_WRAP_PLACED_H

#include "overlap/wrap/wrap.h"

extern const OverlapWrapKind overlap_wrap_placed, overlap_wrap_derived;

#endif

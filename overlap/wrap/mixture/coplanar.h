// SPDX-License-Identifier: Apache-2.0
// Pairs with faces that nearly lie in one plane are blended with clipping, the more the nearer
// (geo/coplanar.h): a smooth V has half of the kinks there that a true one has, and those of neighbouring
// pairs no longer cancel.
#ifndef TETLAP_OVERLAP_WRAP_MIXTURE_COPLANAR_H
#define TETLAP_OVERLAP_WRAP_MIXTURE_COPLANAR_H

#include "overlap/wrap/wrap.h"

extern const OverlapWrapKind overlap_wrap_coplanar;

#endif

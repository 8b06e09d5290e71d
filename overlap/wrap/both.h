// SPDX-License-Identifier: Apache-2.0
// The mean of both orders: V = ½ (V(A, B) + V(B, A)), V x̄ likewise. Which tetrahedron comes first no longer
// matters. The model is asked for twice the pairs, in one call.
#ifndef TETLAP_OVERLAP_WRAP_BOTH_H
#define TETLAP_OVERLAP_WRAP_BOTH_H

#include "overlap/wrap/wrap.h"

extern const OverlapWrapKind overlap_wrap_both;

#endif

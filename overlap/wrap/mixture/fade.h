// SPDX-License-Identifier: Apache-2.0
// V is faded in over the first overlap, and exactly 0 of disjoint pairs: V S(q/touch). S is the step x²(3 −
// 2x) between 0 and 1. The share of the overlap is q = V₀ (1/V_A + 1/V_B), with V₀ the closed form of `geo`
// (tpn/share.h). So the first contact is no jump, whatever the model says of it. Its number is `touch`.
#ifndef TETLAP_OVERLAP_WRAP_MIXTURE_FADE_H
#define TETLAP_OVERLAP_WRAP_MIXTURE_FADE_H

#include "overlap/wrap/wrap.h"

extern const OverlapWrapKind overlap_wrap_fade;

#endif

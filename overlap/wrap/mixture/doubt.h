// SPDX-License-Identifier: Apache-2.0
// `hybrid` of a model that tells its doubt B, how far its V may be off, or the range of pairs that it was
// made for, or both. V and x̄ turn to those of clipping beyond the range, and where B is not small beside V
// (hybrid/share.h). With d the share by the doubt, and w the weights of the pair and of V in the range
// (pair/range.h), the share of clipping is
//
//     c = 1 − (1 − d) w(x) w(V).
//
// An infinite B leaves the pair to clipping. Where the model gives no ∇B, there is no ∇V. Its number is the
// relative error up to which the model is left alone.
#ifndef TETLAP_OVERLAP_WRAP_MIXTURE_DOUBT_H
#define TETLAP_OVERLAP_WRAP_MIXTURE_DOUBT_H

#include "overlap/wrap/wrap.h"

extern const OverlapWrapKind overlap_wrap_doubt;

#endif

// SPDX-License-Identifier: Apache-2.0
// `hybrid` of a model that tells its doubt B, how far its V may be off: V and x̄ turn to those of clipping
// where B is not small beside V, as hybrid/share.h has it. An infinite B, of a pair that is unlike those of
// the training, leaves it to clipping. Nothing is known of ∇B, so there is no ∇V. Its number is the relative
// error up to which the model is left alone.
#ifndef TETLAP_OVERLAP_WRAP_MIXTURE_DOUBT_H
#define TETLAP_OVERLAP_WRAP_MIXTURE_DOUBT_H

#include "overlap/wrap/wrap.h"

extern const OverlapWrapKind overlap_wrap_doubt;

#endif

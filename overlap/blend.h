// SPDX-License-Identifier: Apache-2.0
// Answers with their first derivatives, and what they become where clipping has a share in them.
#ifndef TETLAP_OVERLAP_BLEND_H
#define TETLAP_OVERLAP_BLEND_H

#include "overlap/ops.h"

// An answer for one pair with V, ∇V, x̄ and ∂x̄/∂x.
typedef struct OverlapBlend {
  double volume;
  double gradient[24];
  double centroid[3];
  double slopes[3 * 24];
} OverlapBlend;

// ∂x̄/∂x of a centroid that follows from V and ∇V (overlap/centroid.h), by ∇²V.
void overlap_blend_derive(const double pair[24], double volume, const double gradient[24],
                          const double hessian[576], double slopes[72]);
// Of clipping.
Status overlap_blend_clip(const double pair[24], OverlapBlend *clip);
// Turns `to` to (1 − c) V + c V_clip and V x̄ likewise, given c and ∇c.
void overlap_blend_mix(double share, const double share_gradient[24], const OverlapBlend *clip,
                       OverlapBlend *to);

#endif

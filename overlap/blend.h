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

// ∂x̄/∂x of a centroid that follows from V and ∇V (overlap/pair/centroid.h), by ∇²V.
void overlap_blend_derive(const double pair[24], double volume, const double gradient[24],
                          const double hessian[576], double slopes[72]);
// Of clipping.
Status overlap_blend_clip(const double pair[24], OverlapBlend *clip);
// Turns `to` to (1 − c) V + c V_clip and V x̄ likewise, given c and ∇c.
void overlap_blend_mix(double share, const double share_gradient[24], const OverlapBlend *clip,
                       OverlapBlend *to);

// c with ∇c (24) and ∇²c (24, 24), of which j ≥ i is read.
typedef struct OverlapBlendShare {
  double value;
  const double *gradient, *hessian;
} OverlapBlendShare;

// Turns ∇V and ∇²V, each NULL where it is not wanted, to those of (1 − c) V + c V_other, given V_other − V,
// ∇V_other − ∇V and ∇²V_other.
void overlap_blend_turn(const OverlapBlendShare *share, double difference, const double apart[24],
                        const double *other_hessian, double *gradient, double *hessian);

// Turns V and, unless NULL, x̄ to those of the blend: V x̄ is blended as V is.
void overlap_blend_move(double share, double other_volume, const double other_centroid[3], double *volume,
                        double *centroid);

#endif

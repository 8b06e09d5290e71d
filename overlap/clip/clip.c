// SPDX-License-Identifier: Apache-2.0
#include "overlap/clip/clip.h"

#include <math.h>
#include <string.h>

#include "overlap/exact/exact.h"

#define INLINED static inline

#include "overlap/clip/sums.inc"

// V, ∇V and x̄ of the exact model; the Hessian is left alone where there is a volume.
static Status fall_back(const double pair[24], const OverlapAnswer *answer) {
  OverlapAnswer rest = *answer;
  rest.hessian = NULL;
  Status status = overlap_exact_ops.eval_pair(NULL, pair, &rest);
  if (!status && answer->hessian && *answer->flags & (OVERLAP_DISJOINT | OVERLAP_FLAT))
    memset(answer->hessian, 0, (size_t)OVERLAP_PAIR_SIZE * OVERLAP_PAIR_SIZE * sizeof(double));
  *answer->flags |= OVERLAP_FALLBACK;
  return status;
}

static void write_derivatives(const OverlapClipPolytope *polytope, const FaceSums *sums,
                              const double pair[24], const OverlapAnswer *answer) {
  OverlapClipMoments moments = moments_of(polytope, sums);
  if (answer->gradient) write_gradient(polytope, &moments, answer->gradient);
  if (answer->hessian) overlap_clip_hessian(polytope, &moments, pair, answer->hessian);
}

static Status eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  (void)self;
  OverlapClipPolytope polytope;
  OverlapClipOutcome outcome = overlap_clip_polytope_make(&polytope, pair);
  *answer->flags = outcome == OVERLAP_CLIP_ENCLOSED ? OVERLAP_ENCLOSED : 0;
  if (outcome == OVERLAP_CLIP_DISJOINT || outcome == OVERLAP_CLIP_UNCERTAIN) {
    overlap_ops_write_nothing(answer);
    *answer->flags = OVERLAP_DISJOINT;
    return outcome == OVERLAP_CLIP_DISJOINT ? STATUS_OK : fall_back(pair, answer);
  }

  FaceSums sums;
  bool wants_derivatives = answer->gradient || answer->hessian;
  add_sides(&polytope, &sums, wants_derivatives || answer->centroid);
  double volume = fmin(volume_of(&polytope, &sums), smaller_size(&polytope));
  bool falls_back = is_doubtful(&polytope, &sums, volume);
  if (!falls_back && !(volume > 0)) {
    overlap_ops_write_nothing(answer);
    *answer->flags = OVERLAP_DISJOINT;
    return STATUS_OK;
  }
  *answer->volume = volume;
  if (wants_derivatives) write_derivatives(&polytope, &sums, pair, answer);
  if (falls_back) return fall_back(pair, answer);
  if (answer->centroid) write_centroid(&polytope, &sums, pair, volume, answer->centroid);
  return STATUS_OK;
}

const OverlapOps overlap_clip_scalar_ops = {
    .name = "clip-scalar",
    .help = "as clip, one pair at a time: the portable form and the reference for the other",
    .has_hessian = overlap_ops_always,
    .has_centroid = overlap_ops_always,
    .rejects_disjoint = true,
    .seconds_per_pair = 5e-7,
    .eval_pair = eval_pair,
};

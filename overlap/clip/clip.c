// SPDX-License-Identifier: Apache-2.0
#include "overlap/clip/clip.h"

#include <math.h>
#include <string.h>

#include "overlap/exact/exact.h"

#define INLINED static inline

#include "overlap/clip/sums.inc"

// x of the polytope's vertex o, from the tetrahedron that was clipped.
static Vec3 apex_of(const OverlapClipPolytope *polytope, const double pair[24]) {
  const double *tet = pair + 12 * polytope->subject, *share = polytope->origin + 4 * polytope->subject;
  Vec3 apex = vec3_at(tet);
  for (int k = 1; k < 4; k++)
    apex = vec3_add(apex, vec3_scale(share[k], vec3_sub(vec3_at(tet + 3 * k), vec3_at(tet))));
  return apex;
}

// φ_f times the mean of P_f, relative to o.
static Vec3 face_mean(const OverlapClipPolytope *polytope, const FaceSums *sums, int f,
                      const double pair[24]) {
  const double *tet = pair + 12 * (f >> 2);
  Vec3 t = vec3_at(tet + 3 * (overlap_clip_t[f] & 3)), apex = vec3_at(tet + 3 * (f & 3));
  Vec3 along_u = vec3_sub(vec3_at(tet + 3 * (overlap_clip_u[f] & 3)), t);
  Vec3 along_v = vec3_sub(vec3_at(tet + 3 * (overlap_clip_v[f] & 3)), t);
  Vec3 down = vec3_scale(sums->area[f] * polytope->origin[f], vec3_sub(t, apex));
  return vec3_add(
      down, vec3_add(vec3_scale(sums->first_u[f] / 3, along_u), vec3_scale(sums->first_v[f] / 3, along_v)));
}

// Where V is only rounding, nothing else keeps x̄ near the pair.
static void clamp_to_boxes(const double pair[24], double centroid[3]) {
  for (int t = 0; t < 2; t++)
    for (int c = 0; c < 3; c++) {
      const double *x = pair + 12 * t + c;
      centroid[c] = fmax(centroid[c], fmin(fmin(x[0], x[3]), fmin(x[6], x[9])));
      centroid[c] = fmin(centroid[c], fmax(fmax(x[0], x[3]), fmax(x[6], x[9])));
    }
}

static void write_centroid(const OverlapClipPolytope *polytope, const FaceSums *sums, const double pair[24],
                           double volume, double *centroid) {
  Vec3 sum = {0, 0, 0};
  for (int f = 0; f < 8; f++) {
    double weight = polytope->origin[f] * fabs(polytope->frame[f >> 2].det) / 6;
    sum = vec3_add(sum, vec3_scale(weight, face_mean(polytope, sums, f, pair)));
  }
  vec3_store(centroid, vec3_add(apex_of(polytope, pair), vec3_scale(0.75 / volume, sum)));
  clamp_to_boxes(pair, centroid);
}

// V, ∇V and x̄ of the exact model; the Hessian is left alone.
static Status fall_back(const double pair[24], const OverlapAnswer *answer) {
  OverlapAnswer rest = *answer;
  rest.hessian = NULL;
  Status status = overlap_exact_ops.eval_pair(NULL, pair, &rest);
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
    .help = "as clip, one pair at a time: the portable form and the referee of the other",
    .has_hessian = overlap_ops_always,
    .has_centroid = overlap_ops_always,
    .rejects_disjoint = true,
    .seconds_per_pair = 5e-7,
    .eval_pair = eval_pair,
};

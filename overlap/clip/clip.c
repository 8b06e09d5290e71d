// SPDX-License-Identifier: Apache-2.0
#include "overlap/clip/clip.h"

#include <math.h>
#include <string.h>

#include "overlap/exact/exact.h"

// Sums over the directed edges of each face, of points relative to the polytope's vertex o. In the parameters
// (u, v) of a face, triangle (o, p, q) has twice the area u_p v_q − v_p u_q, in units of the whole face.
typedef struct FaceSums {
  double area[8];    // Σ d, d the triangle's
  double first_u[8]; // Σ d (u_p + u_q)
  double first_v[8]; // Σ d (v_p + v_q)
} FaceSums;

static inline void add_side(FaceSums *sums, int face, const double *p, const double *q, bool wants_moments) {
  int u = overlap_clip_u[face], v = overlap_clip_v[face];
  double d = p[u] * q[v] - p[v] * q[u];
  sums->area[face] += d;
  if (!wants_moments) return;
  sums->first_u[face] += d * (p[u] + q[u]);
  sums->first_v[face] += d * (p[v] + q[v]);
}

// Moves the polytope's origin of coordinates to one of its vertices.
static void add_sides(OverlapClipPolytope *polytope, FaceSums *sums, bool wants_moments) {
  memset(sums, 0, sizeof *sums);
  memcpy(polytope->origin, polytope->vertex[polytope->edge[0].from], sizeof polytope->origin);
  for (int i = 0; i < polytope->vertex_count; i++)
    for (int lane = 0; lane < 8; lane++) polytope->vertex[i][lane] -= polytope->origin[lane];
  for (int e = 0; e < polytope->edge_count; e++) {
    OverlapClipEdge edge = polytope->edge[e];
    const double *p = polytope->vertex[edge.from], *q = polytope->vertex[edge.to];
    add_side(sums, edge.left, p, q, wants_moments);
    add_side(sums, edge.right, q, p, wants_moments);
  }
  // edges turn outward as the subject's barycentric space sees it; the other's may be its mirror image
  if ((polytope->frame[0].det < 0) == (polytope->frame[1].det < 0)) return;
  for (int f = 4 - 4 * polytope->subject; f < 8 - 4 * polytope->subject; f++)
    sums->area[f] = -sums->area[f], sums->first_u[f] = -sums->first_u[f],
    sums->first_v[f] = -sums->first_v[f];
}

static OverlapClipMoments moments_of(const OverlapClipPolytope *polytope, const FaceSums *sums) {
  OverlapClipMoments moments;
  memset(&moments, 0, sizeof moments);
  for (int f = 0; f < 8; f++) {
    int u = overlap_clip_u[f], v = overlap_clip_v[f];
    double area = sums->area[f];
    double m_u = area * polytope->origin[u] + sums->first_u[f] / 3;
    double m_v = area * polytope->origin[v] + sums->first_v[f] / 3;
    moments.fraction[f] = area;
    moments.moment[f][u & 3] = m_u;
    moments.moment[f][v & 3] = m_v;
    moments.moment[f][overlap_clip_t[f] & 3] = area - m_u - m_v;
  }
  return moments;
}

static double volume_of(const OverlapClipPolytope *polytope, const FaceSums *sums) {
  double part[2] = {0, 0};
  for (int f = 0; f < 8; f++) part[f >> 2] += sums->area[f] * polytope->origin[f];
  return part[0] * fabs(polytope->frame[0].det) / 6 + part[1] * fabs(polytope->frame[1].det) / 6;
}

static void write_gradient(const OverlapClipPolytope *polytope, const OverlapClipMoments *moments,
                           double *gradient) {
  for (int t = 0; t < 2; t++) {
    double half = polytope->frame[t].det < 0 ? 0.5 : -0.5;
    Vec3 area[4];
    for (int f = 0; f < 4; f++) area[f] = vec3_scale(half, polytope->frame[t].normal[f]);
    for (int a = 0; a < 4; a++) {
      Vec3 sum = {0, 0, 0};
      for (int f = 0; f < 4; f++) sum = vec3_add(sum, vec3_scale(moments->moment[4 * t + f][a], area[f]));
      vec3_store(gradient + 12 * t + 3 * a, sum);
    }
  }
}

// What clip.h says that rounding may do to V.
static double rounding_of(const OverlapClipPolytope *polytope, const FaceSums *sums) {
  double covered[2] = {0, 0}, noise = polytope->noise, slide = OVERLAP_CLIP_SLIDE * noise;
  for (int f = 0; f < 8; f++) covered[f >> 2] += fabs(sums->area[f]);
  return noise / 2 *
         (covered[0] * (1 + slide / fabs(polytope->frame[1].det)) +
          covered[1] * (1 + slide / fabs(polytope->frame[0].det)));
}

static bool is_doubtful(const OverlapClipPolytope *polytope, const FaceSums *sums, double volume) {
  double size = fmin(fabs(polytope->frame[0].det), fabs(polytope->frame[1].det)) / 6;
  bool is_small = !(volume > 0.999e-6 * size), is_flat = !(polytope->noise / 2 <= 1e-12 * size);
  if (is_small && is_flat) return true;
  return !(rounding_of(polytope, sums) <= (is_small ? 1e-12 * size : 1e-9 * volume));
}

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
  double size = fmin(fabs(polytope.frame[0].det), fabs(polytope.frame[1].det)) / 6;
  double volume = fmin(volume_of(&polytope, &sums), size);
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

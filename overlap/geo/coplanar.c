// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/coplanar.h"

#include <math.h>
#include <string.h>

#include "overlap/blend.h"
#include "overlap/clip/clip.h"
#include "overlap/geo/hessian.h"

enum { SIZE = OVERLAP_PAIR_SIZE };

#include "overlap/geo/coplanar.inc"

void overlap_geo_coplanar_find(const GeoMatrix *projector, OverlapGeoCoplanar *coplanar) {
  find_close(projector, coplanar);
}

// δr_kl
static double change_ratio(const GeoMatrix *projector, const OverlapGeoClose *close,
                           const GeoMatrix *change) {
  int k = close->k, l = close->l;
  double kk = projector->row[k][k], ll = projector->row[l][l];
  double dk = change->row[k][k], dl = change->row[l][l];
  return (dk + dl + 2 * close->side * change->row[k][l]) / (kk * ll) - close->ratio * (dk / kk + dl / ll);
}

// The change of ∂r_kl/∂P, times `factor`.
static void add_bend(const GeoMatrix *projector, const OverlapGeoClose *close, const GeoMatrix *change,
                     double ratio_change, double factor, GeoMatrix *bent) {
  int k = close->k, l = close->l;
  double kk = projector->row[k][k], ll = projector->row[l][l], inverse = 1 / (kk * ll);
  double dk = change->row[k][k], dl = change->row[l][l];
  double inverse_change = -inverse * (dk / kk + dl / ll);
  bent->row[k][k] += factor * (inverse_change - ratio_change / kk + close->ratio * dk / (kk * kk));
  bent->row[l][l] += factor * (inverse_change - ratio_change / ll + close->ratio * dl / (ll * ll));
  bent->row[k][l] += factor * close->side * inverse_change;
  bent->row[l][k] += factor * close->side * inverse_change;
}

// The change of ∂w/∂P along a change of P.
static void bend_share(const OverlapGeoCoplanar *coplanar, const GeoMatrix *projector,
                       const GeoMatrix *change, GeoMatrix *slope_change) {
  memset(slope_change, 0, sizeof *slope_change);
  double ratio_change[OVERLAP_GEO_MOST_CLOSE];
  for (int c = 0; c < coplanar->count; c++)
    ratio_change[c] = change_ratio(projector, &coplanar->close[c], change);
  for (int c = 0; c < coplanar->count; c++) {
    const OverlapGeoClose *close = &coplanar->close[c];
    double kept = left_by_others(coplanar, c, c), factor = kept * close->bending * ratio_change[c];
    for (int o = 0; o < coplanar->count; o++)
      if (o != c)
        factor -= left_by_others(coplanar, c, o) * close->slope * coplanar->close[o].slope * ratio_change[o];
    add_slope(projector, close, factor, slope_change);
    add_bend(projector, close, change, ratio_change[c], kept * close->slope, slope_change);
  }
}

// Column j of ∇²w.
static void find_column(const OverlapGeoFrame *frame, const OverlapGeoCoplanar *coplanar,
                        const OverlapGeoAdjoint *adjoint, const GeoMatrix *slope, int j, double *hessian) {
  double direction[SIZE] = {0}, column[SIZE];
  direction[j] = 1;
  OverlapGeoTangent tangent;
  GeoMatrix slope_change;
  overlap_geo_frame_push(frame, direction, &tangent);
  bend_share(coplanar, &frame->projector, &tangent.projector, &slope_change);
  overlap_geo_frame_bend(frame, adjoint, slope, &tangent, &slope_change, column);
  for (int i = 0; i < SIZE; i++) hessian[i * SIZE + j] = column[i];
}

void overlap_geo_coplanar_pull(const OverlapGeoFrame *frame, const OverlapGeoCoplanar *coplanar,
                               double gradient[24], double *hessian) {
  GeoMatrix slope; // ∂w/∂P
  OverlapGeoAdjoint adjoint;
  find_share_slope(coplanar, &frame->projector, &slope);
  overlap_geo_frame_pull(frame, &slope, 0, &adjoint);
  memcpy(gradient, adjoint.gradient, sizeof adjoint.gradient);
  if (!hessian) return;
  int moved = overlap_geo_hessian_moved(frame), first = moved * SIZE / 2;
  for (int j = first; j < first + SIZE / 2; j++) find_column(frame, coplanar, &adjoint, &slope, j, hessian);
  overlap_geo_hessian_complete(frame, moved, gradient, hessian);
}

// A pair between the two models: how their volumes and gradients differ, and the derivatives of w.
typedef struct Blend {
  double share, share_gradient[SIZE], share_hessian[SIZE * SIZE];
  double volume, gradient[SIZE], hessian[SIZE * SIZE]; // of clip
  double difference, gradient_difference[SIZE];        // clip − network
} Blend;

// Turns the network's gradient and Hessian to the blend's; either may be NULL. The blend has `part` of w.
static void blend_derivatives(const OverlapGeoFrame *frame, const OverlapGeoCoplanar *coplanar, double part,
                              Blend *blend, double *gradient, double *hessian) {
  if (!gradient) return;
  for (int i = 0; i < SIZE; i++) blend->gradient_difference[i] = blend->gradient[i] - gradient[i];
  overlap_geo_coplanar_pull(frame, coplanar, blend->share_gradient, hessian ? blend->share_hessian : NULL);
  for (int i = 0; i < SIZE; i++) blend->share_gradient[i] *= part;
  for (int i = 0; i < SIZE * SIZE && hessian; i++) blend->share_hessian[i] *= part;
  overlap_blend_turn(&(OverlapBlendShare){blend->share, blend->share_gradient, blend->share_hessian},
                     blend->difference, blend->gradient_difference, blend->hessian, gradient, hessian);
}

Status overlap_geo_coplanar_blend(const OverlapGeoFrame *frame, const double pair[24], double *volume,
                                  double *gradient, double *hessian, double *centroid, unsigned *flags) {
  OverlapGeoCoplanar coplanar;
  overlap_geo_coplanar_find(&frame->projector, &coplanar);
  if (!(coplanar.share > 0)) return STATUS_OK;
  Blend blend;
  blend.share = coplanar.share;
  unsigned clip_flags;
  double clip_centroid[3];
  TRY(overlap_clip_ops.eval_pair(NULL, pair,
                                 &(OverlapAnswer){.volume = &blend.volume,
                                                  .gradient = gradient ? blend.gradient : NULL,
                                                  .hessian = hessian ? blend.hessian : NULL,
                                                  .centroid = centroid ? clip_centroid : NULL,
                                                  .flags = &clip_flags}));
  blend.difference = blend.volume - *volume;
  overlap_blend_move(blend.share, blend.volume, clip_centroid, volume, centroid);
  if (flags) *flags |= OVERLAP_BLENDED;
  blend_derivatives(frame, &coplanar, 1, &blend, gradient, hessian);
  return STATUS_OK;
}

void overlap_geo_coplanar_fade(const OverlapGeoFrame *frame, double *bound, double *gradient,
                               double *hessian) {
  OverlapGeoCoplanar coplanar;
  overlap_geo_coplanar_find(&frame->projector, &coplanar);
  if (!(coplanar.share > 0)) return;
  Blend blend = {.share = OVERLAP_GEO_COPLANAR_FADE * coplanar.share, .difference = -*bound};
  *bound *= 1 - blend.share;
  blend_derivatives(frame, &coplanar, OVERLAP_GEO_COPLANAR_FADE, &blend, gradient, hessian);
}

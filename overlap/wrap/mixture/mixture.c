// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/mixture/mixture.h"

#include <string.h>

#include "overlap/blend.h"
#include "overlap/clip/clip.h"
#include "overlap/portions.h"
#include "overlap/slopes.h"

enum {
  SIZE = OVERLAP_PAIR_SIZE,
  SQUARE = SIZE * SIZE,
  ROWS = 3 * SIZE,
  PORTION = OVERLAP_WRAP_MIXTURE_PORTION
};

// The other answer to those pairs of a portion that have a share in it.
typedef struct Other {
  int count, at[PORTION];
  double pairs[PORTION * SIZE];
  double volume[PORTION], gradient[PORTION * SIZE], hessian[PORTION * SQUARE], centroid[3 * PORTION];
  unsigned flags[PORTION]; // 0 without clip
} Other;

static Status ask_other(const OverlapWrapMixture *mixture, const OverlapBatch *portion,
                        const OverlapWrapShares *shares, Other *other) {
  other->count = 0;
  for (int i = 0; i < portion->pair_count; i++)
    if (shares->value[i] > 0) {
      memcpy(other->pairs + SIZE * other->count, portion->pairs + SIZE * i, SIZE * sizeof(double));
      other->at[other->count++] = i;
    }
  if (other->count == 0) return STATUS_OK;
  OverlapBatch asked = {.pair_count = other->count,
                        .pairs = other->pairs,
                        .volume = other->volume,
                        .gradient = portion->gradient ? other->gradient : NULL,
                        .hessian = portion->hessian ? other->hessian : NULL,
                        .centroid = portion->centroid ? other->centroid : NULL,
                        .flags = other->flags};
  memset(other->flags, 0, sizeof other->flags);
  if (mixture->has_clip) return overlap_clip_ops.eval_batch(NULL, &asked);
  for (int k = 0; k < other->count; k++) {
    OverlapAnswer answer = overlap_ops_answer(&asked, k, NULL);
    overlap_ops_write_nothing(&answer);
  }
  return STATUS_OK;
}

static unsigned flags_of(unsigned inner, unsigned other, bool has_clip, double share, double volume) {
  if (inner & OVERLAP_FLAT) return inner;
  const unsigned beyond = inner & OVERLAP_BEYOND;
  if (volume == 0) return (inner & OVERLAP_UNSOUND) | beyond | OVERLAP_DISJOINT;
  inner &= ~(unsigned)OVERLAP_DISJOINT;
  if (has_clip && share >= 1) inner = OVERLAP_FALLBACK | beyond;
  if (has_clip && share < 1) inner |= OVERLAP_BLENDED;
  return inner | (other & OVERLAP_ENCLOSED);
}

static void mix(const OverlapBatch *portion, const OverlapWrapShares *shares, const Other *other, int k,
                bool has_clip) {
  unsigned unused = 0;
  const int i = other->at[k];
  const double share = shares->value[i];
  OverlapAnswer answer = overlap_ops_answer(portion, i, &unused);
  double apart[SIZE];
  for (int r = 0; r < SIZE && answer.gradient; r++)
    apart[r] = other->gradient[SIZE * k + r] - answer.gradient[r];
  if (answer.gradient)
    overlap_blend_turn(&(OverlapBlendShare){share, shares->gradient[i], shares->hessian[i]},
                       other->volume[k] - *answer.volume, apart, other->hessian + SQUARE * k, answer.gradient,
                       answer.hessian);
  overlap_blend_move(share, other->volume[k], other->centroid + 3 * k, answer.volume, answer.centroid);
  if (portion->flags)
    *answer.flags = flags_of(*answer.flags, other->flags[k], has_clip, share, *answer.volume);
}

static Status mix_portion(const void *self, const OverlapBatch *portion, int first) {
  const OverlapWrap *wrap = self;
  const OverlapWrapMixture *mixture = wrap->kind->mixture;
  OverlapWrapShares shares;
  Other other;
  (void)first;
  TRY(mixture->share(wrap, portion, portion->hessian ? 2 : portion->gradient ? 1 : 0, &shares));
  TRY(ask_other(mixture, portion, &shares, &other));
  for (int k = 0; k < other.count; k++) mix(portion, &shares, &other, k, mixture->has_clip);
  return STATUS_OK;
}

Status overlap_wrap_mixture_eval(OverlapWrap *wrap, const OverlapBatch *batch) {
  const size_t n = (size_t)batch->pair_count;
  const bool needs_gradient = batch->hessian && !batch->gradient;
  const bool needs_doubt = wrap->kind->mixture->by_doubt && wrap->inner.ops->gives_doubt;
  const bool needs_slope = needs_doubt && (batch->gradient || needs_gradient);
  const size_t gradients = (needs_gradient ? SIZE * n : 0), slopes = (needs_slope ? SIZE * n : 0);
  TRY(overlap_wrap_reserve(wrap, gradients + slopes + (needs_doubt ? n : 0), 0));
  OverlapBatch asked = *batch;
  if (needs_gradient) asked.gradient = wrap->room;
  if (needs_slope) asked.doubt_gradient = wrap->room + gradients;
  if (needs_doubt) asked.doubt = wrap->room + gradients + slopes;
  TRY(overlap_model_eval(&wrap->inner, &asked));
  return overlap_portions_eval(&asked, PORTION, true, mix_portion, wrap);
}

static Status mix_slopes(const OverlapWrap *wrap, const double *pair, double *slopes) {
  OverlapBlend own, other = {0};
  OverlapWrapShares shares;
  OverlapBatch asked = {.pair_count = 1,
                        .pairs = pair,
                        .volume = &own.volume,
                        .gradient = own.gradient,
                        .centroid = own.centroid};
  TRY(overlap_slopes_eval(&wrap->inner, &asked, own.slopes));
  TRY(wrap->kind->mixture->share(wrap, &asked, 1, &shares));
  if (shares.value[0] > 0) {
    if (wrap->kind->mixture->has_clip) TRY(overlap_blend_clip(pair, &other));
    overlap_blend_mix(shares.value[0], shares.gradient[0], &other, &own);
  }
  memcpy(slopes, own.slopes, sizeof own.slopes);
  return STATUS_OK;
}

Status overlap_wrap_mixture_slopes(const OverlapWrap *wrap, int count, const double *pairs, double *slopes) {
  for (int i = 0; i < count; i++)
    TRY(mix_slopes(wrap, pairs + SIZE * (ptrdiff_t)i, slopes + ROWS * (ptrdiff_t)i));
  return STATUS_OK;
}

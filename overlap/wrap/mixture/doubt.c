// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/mixture/doubt.h"

#include <math.h>
#include <string.h>

#include "overlap/hybrid/share.h"
#include "overlap/pair/range.h"
#include "overlap/wrap/mixture/mixture.h"

enum { SIZE = OVERLAP_PAIR_SIZE };

static Status check(const OverlapModel *inner) {
  return inner->ops->gives_doubt || inner->ops->range
             ? STATUS_OK
             : status_fail(
                   STATUS_INPUT,
                   "hybrid: '%s' tells no doubt: how far each V may be off, and no range of pairs that it "
                   "was made for",
                   inner->ops->name);
}

static bool has_gradient(const OverlapModel *inner) {
  return !inner->ops->gives_doubt || inner->ops->gives_doubt_gradient;
}

// d, with ∇d where `gradient` is not NULL.
static double share_of_doubt(const OverlapWrap *wrap, const OverlapBatch *portion, int i, double *gradient) {
  const OverlapHybridSigns signs = {.pair = portion->pairs + SIZE * i,
                                    .doubt = wrap->number,
                                    .volume = portion->volume[i],
                                    .bound = portion->doubt[i],
                                    .volume_gradient = gradient ? portion->gradient + SIZE * i : NULL,
                                    .bound_gradient = gradient ? portion->doubt_gradient + SIZE * i : NULL};
  // A volume of 0 that is in doubt may be a contact that was missed.
  if (!(signs.volume > 0)) return signs.bound > 0;
  return gradient ? overlap_hybrid_share_derive(&signs, gradient, NULL) : overlap_hybrid_share(&signs);
}

// w(x) w(V), with its gradient.
static double weight_of_range(const OverlapRange *range, const OverlapBatch *portion, int i,
                              double *gradient) {
  const double within = overlap_range_weight(range, portion->pairs + SIZE * i, gradient, NULL);
  const OverlapBend bend = overlap_range_overlap_weight(range, portion->volume[i]);
  for (int r = 0; r < SIZE && gradient; r++)
    gradient[r] = gradient[r] * bend.value + within * bend.slope * portion->gradient[SIZE * i + r];
  return within * bend.value;
}

// c, with ∇c.
static double share_of(const OverlapWrap *wrap, const OverlapBatch *portion, int i, double *gradient) {
  const OverlapRange *range = wrap->inner.ops->range;
  double by_range[SIZE] = {0}, share = 0, weight = 1;
  if (gradient) memset(gradient, 0, SIZE * sizeof *gradient);
  if (portion->doubt) share = share_of_doubt(wrap, portion, i, gradient);
  if (range) weight = weight_of_range(range, portion, i, gradient ? by_range : NULL);
  for (int r = 0; r < SIZE && gradient; r++) gradient[r] = gradient[r] * weight - (1 - share) * by_range[r];
  return 1 - (1 - share) * weight;
}

static Status share(const OverlapWrap *wrap, const OverlapBatch *portion, int order,
                    OverlapWrapShares *shares) {
  for (int i = 0; i < portion->pair_count; i++)
    shares->value[i] = share_of(wrap, portion, i, order > 0 ? shares->gradient[i] : NULL);
  return STATUS_OK;
}

static const OverlapWrapMixture mixture = {.has_clip = true, .share = share, .by_doubt = true};

const OverlapWrapKind overlap_wrap_doubt = {
    .name = "hybrid",
    .help = "clip where the model doubts, and beyond its range",
    .number = "the relative error of V up to which the model is left alone",
    .least = 0,
    .most = INFINITY,
    .usual = 0.005,
    .check = check,
    .eval = overlap_wrap_mixture_eval,
    .has_gradient = has_gradient,
    .lacks_hessian = true,
    .centroid = OVERLAP_WRAP_MIXED_CENTROID,
    .mixture = &mixture,
};

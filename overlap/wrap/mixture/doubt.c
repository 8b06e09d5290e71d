// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/mixture/doubt.h"

#include <math.h>

#include "overlap/hybrid/share.h"
#include "overlap/wrap/mixture/mixture.h"

enum { SIZE = OVERLAP_PAIR_SIZE };

static Status check(const OverlapModel *inner) {
  return inner->ops->gives_doubt
             ? STATUS_OK
             : status_fail(STATUS_INPUT, "hybrid: '%s' tells no doubt: how far each V may be off",
                           inner->ops->name);
}

static Status share(const OverlapWrap *wrap, const OverlapBatch *portion, int order,
                    OverlapWrapShares *shares) {
  (void)order; // there is no ∇V
  for (int i = 0; i < portion->pair_count; i++) {
    const OverlapHybridSigns signs = {.pair = portion->pairs + SIZE * i,
                                      .doubt = wrap->number,
                                      .volume = portion->volume[i],
                                      .bound = portion->doubt[i]};
    // A volume of 0 that is in doubt may be a contact that was missed.
    shares->value[i] = signs.volume > 0 ? overlap_hybrid_share(&signs) : signs.bound > 0;
  }
  return STATUS_OK;
}

static const OverlapWrapMixture mixture = {.has_clip = true, .share = share, .by_doubt = true};

static Status eval(OverlapWrap *wrap, const OverlapBatch *batch) {
  return overlap_wrap_mixture_eval(wrap, &mixture, batch);
}

const OverlapWrapKind overlap_wrap_doubt = {
    .name = "hybrid",
    .help = "clip where the model doubts",
    .number = "the relative error of V up to which the model is left alone",
    .least = 0,
    .most = INFINITY,
    .usual = 0.005,
    .check = check,
    .eval = eval,
    .lacks_gradient = true,
    .centroid = OVERLAP_WRAP_MIXED_CENTROID,
};

// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/placed.h"

#include <string.h>

#include "overlap/blend.h"
#include "overlap/clip/clip.h"
#include "overlap/pair/centroid.h"

enum { SIZE = OVERLAP_PAIR_SIZE, ROWS = 3 * SIZE };

static Status eval(OverlapWrap *wrap, const OverlapBatch *batch) {
  static const double none[SIZE] = {0};
  OverlapBatch asked = *batch;
  asked.centroid = NULL;
  TRY(overlap_model_eval(&wrap->inner, &asked));
  if (!batch->centroid) return STATUS_OK;
  TRY(overlap_wrap_reserve(wrap, (size_t)batch->pair_count, 0));
  TRY(overlap_clip_ops.eval_batch(NULL, &(OverlapBatch){.pair_count = batch->pair_count,
                                                        .pairs = batch->pairs,
                                                        .volume = wrap->room,
                                                        .centroid = batch->centroid}));
  for (int i = 0; i < batch->pair_count; i++)
    if (!(wrap->room[i] > 0) || batch->volume[i] == 0)
      overlap_centroid_derive(batch->pairs + SIZE * (ptrdiff_t)i, batch->volume[i], none,
                              batch->centroid + 3 * (ptrdiff_t)i);
  return STATUS_OK;
}

static Status eval_slopes(const OverlapWrap *wrap, int count, const double *pairs, double *slopes) {
  static const double none[SIZE * SIZE] = {0};
  (void)wrap;
  for (int i = 0; i < count; i++) {
    OverlapBlend clip;
    const double *pair = pairs + SIZE * (ptrdiff_t)i;
    TRY(overlap_blend_clip(pair, &clip));
    if (!(clip.volume > 0)) overlap_blend_derive(pair, 1, none, none, clip.slopes); // of the boxes
    memcpy(slopes + ROWS * (ptrdiff_t)i, clip.slopes, sizeof clip.slopes);
  }
  return STATUS_OK;
}

const OverlapWrapKind overlap_wrap_placed = {
    .name = "placed",
    .help = "the centroid of clip",
    .eval = eval,
    .eval_slopes = eval_slopes,
    .keeps_doubt = true,
    .centroid = OVERLAP_WRAP_OWN_CENTROID,
};

static Status check_gradient(const OverlapModel *inner) {
  return overlap_model_has_gradient(inner)
             ? STATUS_OK
             : status_fail(STATUS_INPUT, "derived: '%s' gives no gradient", inner->ops->name);
}

// The centroid is the caller's business (overlap/model.h).
static Status eval_inner(OverlapWrap *wrap, const OverlapBatch *batch) {
  return overlap_model_eval(&wrap->inner, batch);
}

const OverlapWrapKind overlap_wrap_derived = {
    .name = "derived",
    .help = "the centroid that follows from V and its gradient",
    .check = check_gradient,
    .eval = eval_inner,
    .keeps_doubt = true,
    .centroid = OVERLAP_WRAP_NO_CENTROID,
};

// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/sound.h"

#include <math.h>
#include <string.h>

#include "overlap/pair/sizes.h"
#include "overlap/slopes.h"

enum { SIZE = OVERLAP_PAIR_SIZE, ROWS = 3 * SIZE };

static bool is_finite(const OverlapAnswer *answer) {
  return overlap_ops_are_finite(1, answer->volume) && overlap_ops_are_finite(SIZE, answer->gradient) &&
         overlap_ops_are_finite((size_t)SIZE * SIZE, answer->hessian) &&
         overlap_ops_are_finite(3, answer->centroid);
}

static Status check_pair(const OverlapWrap *wrap, const OverlapBatch *batch, int i) {
  unsigned unused;
  const OverlapAnswer answer = overlap_ops_answer(batch, i, &unused);
  const double smaller = overlap_sizes_smaller(batch->pairs + SIZE * (ptrdiff_t)i), volume = *answer.volume;
  const int number = batch->numbers ? batch->numbers[i] : i;
  if (!is_finite(&answer))
    return status_fail(STATUS_SOLVER,
                       "overlap model '%s': pair %d: its answer is not finite, its volume %g m³", wrap->name,
                       number, volume);
  return overlap_ops_is_possible(volume, smaller)
             ? STATUS_OK
             : overlap_ops_fail_impossible(wrap->name, number, volume, smaller);
}

static Status eval_strict(OverlapWrap *wrap, const OverlapBatch *batch) {
  TRY(overlap_model_eval(&wrap->inner, batch));
  for (int i = 0; i < batch->pair_count; i++) TRY(check_pair(wrap, batch, i));
  return STATUS_OK;
}

static Status eval_lenient(OverlapWrap *wrap, const OverlapBatch *batch) {
  TRY(overlap_model_eval(&wrap->inner, batch));
  for (int i = 0; i < batch->pair_count; i++) {
    unsigned unused = 0;
    const OverlapAnswer answer = overlap_ops_answer(batch, i, &unused);
    const bool is_told = is_finite(&answer);
    const double smaller = overlap_sizes_smaller(batch->pairs + SIZE * (ptrdiff_t)i);
    if (is_told && overlap_ops_is_possible(*answer.volume, smaller)) continue;
    if (!is_told || *answer.volume < 0) overlap_ops_write_nothing(&answer);
    *answer.flags |= OVERLAP_UNSOUND;
  }
  return STATUS_OK;
}

static Status eval_slopes(const OverlapWrap *wrap, int count, const double *pairs, double *slopes) {
  for (int i = 0; i < count; i++) {
    double volume, gradient[SIZE], centroid[3];
    TRY(overlap_slopes_eval(&wrap->inner,
                            &(OverlapBatch){.pair_count = 1,
                                            .pairs = pairs + SIZE * (ptrdiff_t)i,
                                            .volume = &volume,
                                            .gradient = gradient,
                                            .centroid = centroid},
                            slopes + ROWS * (ptrdiff_t)i));
  }
  return STATUS_OK;
}

static Status eval_pull(OverlapWrap *wrap, const OverlapPull *pull) {
  return wrap->inner.ops->eval_pull(wrap->inner.self, pull);
}

const OverlapWrapKind overlap_wrap_strict = {
    .name = "strict",
    .help = "a volume that is not finite, below 0 or above the smaller tetrahedron is an error",
    .eval = eval_strict,
    .eval_slopes = eval_slopes,
    .eval_pull = eval_pull,
    .keeps_doubt = true,
    .centroid = OVERLAP_WRAP_INNER_CENTROID,
};

const OverlapWrapKind overlap_wrap_lenient = {
    .name = "lenient",
    .help = "such volumes are counted, and those that are not finite are 0",
    .eval = eval_lenient,
    .eval_slopes = eval_slopes,
    .eval_pull = eval_pull,
    .keeps_doubt = true,
    .centroid = OVERLAP_WRAP_INNER_CENTROID,
};

// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/sound.h"

#include <math.h>
#include <string.h>

#include "overlap/pair/sizes.h"
#include "overlap/slopes.h"

enum { SIZE = OVERLAP_PAIR_SIZE, ROWS = 3 * SIZE };

// A finite sum of differences: each is 0 for a finite number, else NaN.
static bool are_finite(size_t count, const double *numbers) {
  double sum = 0;
  for (size_t i = 0; numbers && i < count; i++) sum += numbers[i] - numbers[i];
  return sum == 0;
}

static bool is_finite(const OverlapAnswer *answer) {
  return are_finite(1, answer->volume) && are_finite(SIZE, answer->gradient) &&
         are_finite((size_t)SIZE * SIZE, answer->hessian) && are_finite(3, answer->centroid);
}

static const double ROUNDING = 1e-9; // of the smaller tetrahedron's volume

static Status check_pair(const OverlapWrap *wrap, const OverlapBatch *batch, int i) {
  unsigned unused;
  const OverlapAnswer answer = overlap_ops_answer(batch, i, &unused);
  const double smaller = overlap_sizes_smaller(batch->pairs + SIZE * (ptrdiff_t)i), volume = *answer.volume;
  const int number = batch->numbers ? batch->numbers[i] : i;
  if (!is_finite(&answer))
    return status_fail(STATUS_SOLVER,
                       "overlap model '%s': pair %d: its answer is not finite, its volume %g m³", wrap->name,
                       number, volume);
  if (volume >= 0 && volume <= smaller * (1 + ROUNDING)) return STATUS_OK;
  return status_fail(STATUS_SOLVER,
                     "overlap model '%s': pair %d: its volume is %g m³, expected 0 to that of the smaller "
                     "tetrahedron, %g m³",
                     wrap->name, number, volume, smaller);
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
    if (is_told && *answer.volume >= 0 &&
        *answer.volume <= overlap_sizes_smaller(batch->pairs + SIZE * (ptrdiff_t)i) * (1 + ROUNDING))
      continue;
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

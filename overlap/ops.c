// SPDX-License-Identifier: Apache-2.0
#include "overlap/ops.h"

#include <string.h>

bool overlap_ops_always(const void *self) {
  (void)self;
  return true;
}

OverlapBatch overlap_ops_single(const double pair[24], const OverlapAnswer *answer) {
  return (OverlapBatch){.pair_count = 1,
                        .pairs = pair,
                        .volume = answer->volume,
                        .gradient = answer->gradient,
                        .hessian = answer->hessian,
                        .flags = answer->flags,
                        .centroid = answer->centroid};
}

OverlapAnswer overlap_ops_answer(const OverlapBatch *batch, int i, unsigned *flags) {
  enum { SIZE = OVERLAP_PAIR_SIZE };
  size_t at = (size_t)i * SIZE;
  return (OverlapAnswer){.volume = batch->volume + i,
                         .gradient = batch->gradient ? batch->gradient + at : NULL,
                         .hessian = batch->hessian ? batch->hessian + at * SIZE : NULL,
                         .centroid = batch->centroid ? batch->centroid + 3 * (size_t)i : NULL,
                         .flags = batch->flags ? batch->flags + i : flags};
}

void overlap_ops_write_nothing(const OverlapAnswer *answer) {
  enum { SIZE = OVERLAP_PAIR_SIZE };
  *answer->volume = 0;
  if (answer->gradient) memset(answer->gradient, 0, SIZE * sizeof(double));
  if (answer->hessian) memset(answer->hessian, 0, SIZE * SIZE * sizeof(double));
  if (answer->centroid) memset(answer->centroid, 0, 3 * sizeof(double));
}

bool overlap_ops_are_finite(size_t count, const double *numbers) {
  double sum = 0; // x − x is 0 for finite x, else NaN
  for (size_t i = 0; numbers && i < count; i++) sum += numbers[i] - numbers[i];
  return sum == 0;
}

bool overlap_ops_is_possible(double volume, double smaller) {
  static const double ROUNDING = 1e-9;
  return volume >= 0 && volume <= smaller * (1 + ROUNDING);
}

Status overlap_ops_fail_impossible(const char *model, int pair, double volume, double smaller) {
  return status_fail(STATUS_SOLVER,
                     "overlap model '%s': pair %d: its volume is %g m³, expected 0 to that of the smaller "
                     "tetrahedron, %g m³",
                     model, pair, volume, smaller);
}

static OverlapOrigins part_of(const OverlapOrigins *origins, size_t begin) {
  if (!origins->elements) return *origins;
  return (OverlapOrigins){.elements = origins->elements + 2 * begin,
                          .bodies = origins->bodies + 2 * begin,
                          .rest = origins->rest + 2 * begin};
}

OverlapBatch overlap_ops_part(const OverlapBatch *batch, int begin, int count) {
  enum { SIZE = OVERLAP_PAIR_SIZE };
  size_t at = (size_t)begin * SIZE;
  int left = batch->pair_count - begin;
  return (OverlapBatch){.pair_count = left < count ? left : count,
                        .pairs = batch->pairs + at,
                        .volume = batch->volume + begin,
                        .gradient = batch->gradient ? batch->gradient + at : NULL,
                        .hessian = batch->hessian ? batch->hessian + at * SIZE : NULL,
                        .flags = batch->flags ? batch->flags + begin : NULL,
                        .centroid = batch->centroid ? batch->centroid + 3 * (size_t)begin : NULL,
                        .doubt = batch->doubt ? batch->doubt + begin : NULL,
                        .doubt_gradient = batch->doubt_gradient ? batch->doubt_gradient + at : NULL,
                        .origins = part_of(&batch->origins, (size_t)begin),
                        .numbers = batch->numbers ? batch->numbers + begin : NULL};
}

void overlap_ops_swap(const double pair[24], double swapped[24]) {
  enum { HALF = OVERLAP_PAIR_SIZE / 2 };
  memcpy(swapped, pair + HALF, HALF * sizeof *pair);
  memcpy(swapped + HALF, pair, HALF * sizeof *pair);
}

// SPDX-License-Identifier: GPL-3.0-or-later
#include "overlap/ops.h"

#include <string.h>

OverlapBatch overlap_ops_part(const OverlapBatch *batch, int begin, int count) {
  enum { SIZE = OVERLAP_PAIR_SIZE };
  size_t at = (size_t)begin * SIZE;
  int left = batch->pair_count - begin;
  return (OverlapBatch){.pair_count = left < count ? left : count,
                        .pairs = batch->pairs + at,
                        .volume = batch->volume + begin,
                        .gradient = batch->gradient ? batch->gradient + at : NULL,
                        .hessian = batch->hessian ? batch->hessian + at * SIZE : NULL,
                        .flags = batch->flags ? batch->flags + begin : NULL};
}

void overlap_ops_swap(const double pair[24], double swapped[24]) {
  enum { HALF = OVERLAP_PAIR_SIZE / 2 };
  memcpy(swapped, pair + HALF, HALF * sizeof *pair);
  memcpy(swapped + HALF, pair, HALF * sizeof *pair);
}

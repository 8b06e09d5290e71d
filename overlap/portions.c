// SPDX-License-Identifier: Apache-2.0
#include "overlap/portions.h"

#include <limits.h>

Status overlap_portions_eval(const OverlapBatch *batch, int size, bool is_parallel, OverlapPortionEval eval,
                             const void *self) {
  int portions = batch->pair_count / size + (batch->pair_count % size > 0), first_failed = INT_MAX;
#pragma omp parallel for schedule(dynamic) reduction(min : first_failed) if (is_parallel && portions > 1)
  for (int p = 0; p < portions; p++) {
    OverlapBatch portion = overlap_ops_part(batch, p * size, size);
    if (eval(self, &portion, p * size) != STATUS_OK && p < first_failed) first_failed = p;
  }
  if (first_failed == INT_MAX) return STATUS_OK;
  // A message belongs to the thread that failed: this thread evaluates the portion again to have it.
  int first = first_failed * size;
  OverlapBatch portion = overlap_ops_part(batch, first, size);
  Status status = eval(self, &portion, first);
  if (status != STATUS_OK) return status;
  return status_fail(STATUS_SOLVER, "pairs %d to %d: the evaluation failed once and not again", first,
                     first + portion.pair_count - 1);
}

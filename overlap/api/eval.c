// SPDX-License-Identifier: Apache-2.0
// The C API's pairs.
#include <limits.h>
#include <omp.h>

#include "overlap/api/argument.h"
#include "overlap/api/handle.h"

_Static_assert((int)TETLAP_OVERLAP_DISJOINT == (int)OVERLAP_DISJOINT &&
                   (int)TETLAP_OVERLAP_FLAT == (int)OVERLAP_FLAT &&
                   (int)TETLAP_OVERLAP_FALLBACK == (int)OVERLAP_FALLBACK &&
                   (int)TETLAP_OVERLAP_ENCLOSED == (int)OVERLAP_ENCLOSED &&
                   (int)TETLAP_OVERLAP_BLENDED == (int)OVERLAP_BLENDED &&
                   (int)TETLAP_OVERLAP_NET == (int)OVERLAP_NET &&
                   (int)TETLAP_OVERLAP_BEYOND == (int)OVERLAP_BEYOND,
               "the API's flags are the models'");

enum { SIZE = OVERLAP_PAIR_SIZE };

// Pairs whose Hessians a thread has on its stack at once.
enum { PORTION = 32 };

static void multiply(const double hessian[SIZE * SIZE], const double u[SIZE], double product[SIZE]) {
  for (int i = 0; i < SIZE; i++) {
    double sum = 0;
    for (int j = 0; j < SIZE; j++) sum += hessian[SIZE * i + j] * u[j];
    product[i] = sum;
  }
}

static Status multiply_portion(const OverlapModel *model, const TetlapOverlapBatch *batch, int begin) {
  double volume[PORTION], hessian[PORTION * SIZE * SIZE];
  size_t at = (size_t)begin * SIZE;
  int left = (int)batch->count - begin, count = left < PORTION ? left : PORTION;
  OverlapBatch part = {.pair_count = count, .pairs = batch->pairs + at, .volume = volume, .hessian = hessian};
  TRY(overlap_model_eval(model, &part));
  for (int k = 0; k < count; k++)
    multiply(hessian + k * SIZE * SIZE, batch->direction + at + k * SIZE, batch->product + at + k * SIZE);
  return STATUS_OK;
}

static Status multiply_all(const OverlapModel *model, const TetlapOverlapBatch *batch) {
  int count = (int)batch->count, portions = count / PORTION + (count % PORTION > 0), first_failed = INT_MAX;
#pragma omp parallel for schedule(dynamic) reduction(min : first_failed) if (portions > 1)
  for (int p = 0; p < portions; p++)
    if (multiply_portion(model, batch, p * PORTION) != STATUS_OK && p < first_failed) first_failed = p;
  if (first_failed == INT_MAX) return STATUS_OK;
  // the message belongs to the thread that failed: let this one see it too
  int first = first_failed * PORTION;
  Status status = multiply_portion(model, batch, first);
  return status == STATUS_OK ? status_fail(STATUS_SOLVER, "pairs from %d on failed once and not again", first)
                             : status_prefix(status, "pairs from %d on", first);
}

static Status check(const TetlapOverlap *overlap, const TetlapOverlapBatch *batch) {
  if (batch->count > INT_MAX)
    return status_fail(STATUS_INPUT, "%zu pairs: at most %d a call are expected", batch->count, INT_MAX);
  if (batch->count > 0 && !(batch->pairs && batch->volume))
    return status_fail(STATUS_INPUT, "TetlapOverlapBatch: `%s` is NULL", batch->pairs ? "volume" : "pairs");
  if (batch->product && !batch->direction)
    return status_fail(STATUS_INPUT, "TetlapOverlapBatch: `product` needs `direction`, which is NULL");
  if (batch->product && !overlap_model_has_hessian(&overlap->model))
    return status_fail(STATUS_INPUT, "overlap model '%s' has no Hessian, so none to multiply with",
                       overlap->model.ops->name);
  return STATUS_OK;
}

// The products come last: what is wrong with the input is known by then, with the pair's own number.
static Status eval(const OverlapModel *model, const TetlapOverlapBatch *batch) {
  OverlapBatch pairs = {.pair_count = (int)batch->count,
                        .pairs = batch->pairs,
                        .volume = batch->volume,
                        .gradient = batch->gradient,
                        .hessian = batch->hessian,
                        .flags = batch->flags,
                        .centroid = batch->centroid};
  TRY(overlap_model_eval(model, &pairs));
  return batch->product ? multiply_all(model, batch) : STATUS_OK;
}

static Status check_and_eval(const TetlapOverlap *overlap, const TetlapOverlapBatch *given) {
  TetlapOverlapBatch batch;
  if (!overlap) return status_fail(STATUS_INPUT, "the handle is NULL");
  TRY(overlap_api_argument_copy(&batch, sizeof batch, sizeof batch, given, "TetlapOverlapBatch"));
  TRY(check(overlap, &batch));
  if (batch.count == 0) return STATUS_OK;
  int before = overlap_api_handle_enter(overlap);
  Status status = eval(&overlap->model, &batch);
  overlap_api_handle_leave(before);
  return status;
}

int tetlap_overlap_eval(const TetlapOverlap *overlap, const TetlapOverlapBatch *batch) {
  return overlap_api_argument_status(check_and_eval(overlap, batch));
}

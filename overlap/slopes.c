// SPDX-License-Identifier: Apache-2.0
#include "overlap/slopes.h"

#include <string.h>

#include "base/memory.h"
#include "overlap/blend.h"
#include "overlap/portions.h"

enum { SIZE = OVERLAP_PAIR_SIZE, SQUARE = SIZE * SIZE, ROWS = 3 * SIZE, PORTION = 16 };

static bool has_own(const OverlapModel *model) {
  return overlap_model_has_own_centroid(model) && (model->ops->eval_slopes || model->ops->eval_pull);
}

bool overlap_slopes_are_there(const OverlapModel *model) {
  if (!overlap_model_has_gradient(model)) return false;
  return overlap_model_has_own_centroid(model) ? has_own(model) : overlap_model_has_hessian(model);
}

typedef struct Asked {
  const OverlapModel *model;
  double *slopes; // of the batch
} Asked;

static Status eval_own(const void *self, const OverlapBatch *portion, int first) {
  const Asked *asked = self;
  return asked->model->ops->eval_slopes(asked->model->self, portion->pair_count, portion->pairs,
                                        asked->slopes + ROWS * (size_t)first);
}

static Status eval_by_hessian(const void *self, const OverlapBatch *portion, int first) {
  const Asked *asked = self;
  double hessians[PORTION * SQUARE];
  OverlapBatch bent = *portion;
  bent.hessian = hessians;
  TRY(overlap_model_eval(asked->model, &bent));
  for (int i = 0; i < bent.pair_count; i++)
    overlap_blend_derive(bent.pairs + SIZE * i, bent.volume[i], bent.gradient + SIZE * i,
                         hessians + SQUARE * i, asked->slopes + ROWS * (size_t)(first + i));
  return STATUS_OK;
}

// One row of ∂x̄/∂x after the other.
static Status pull_own(const OverlapModel *model, const OverlapBatch *batch, double *slopes) {
  size_t count = (size_t)batch->pair_count;
  double *by = memory_zeroed(4 * count, sizeof *by), *rows = memory_zeroed(count, SIZE * sizeof *rows);
  Status status = by && rows ? STATUS_OK : status_no_memory("derivatives of centroids");
  for (int c = 0; c < 3 && !status; c++) {
    for (size_t i = 0; i < 3 * count; i++) by[count + i] = i % 3 == (size_t)c;
    status = model->ops->eval_pull(model->self, &(OverlapPull){.pair_count = batch->pair_count,
                                                               .pairs = batch->pairs,
                                                               .by_volume = by,
                                                               .by_centroid = by + count,
                                                               .slope = rows,
                                                               .numbers = batch->numbers});
    for (size_t i = 0; i < count && !status; i++)
      memcpy(slopes + ROWS * i + (size_t)(SIZE * c), rows + SIZE * i, SIZE * sizeof *rows);
  }
  memory_free(by);
  memory_free(rows);
  return status;
}

Status overlap_slopes_eval(const OverlapModel *model, const OverlapBatch *batch, double *slopes) {
  const Asked asked = {model, slopes};
  if (!overlap_slopes_are_there(model))
    return status_fail(STATUS_INPUT, "overlap model '%s' has no derivatives of its centroid",
                       model->ops->name);
  if (!overlap_model_has_own_centroid(model))
    return overlap_portions_eval(batch, PORTION, true, eval_by_hessian, &asked);
  TRY(overlap_model_eval(model, batch));
  TRY(model->ops->eval_slopes ? overlap_portions_eval(batch, PORTION, true, eval_own, &asked)
                              : pull_own(model, batch, slopes));
  for (size_t i = 0; i < (size_t)batch->pair_count; i++)
    if (batch->volume[i] == 0) memset(slopes + ROWS * i, 0, ROWS * sizeof *slopes);
  return STATUS_OK;
}

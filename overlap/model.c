// SPDX-License-Identifier: Apache-2.0
#include "overlap/model.h"

#include <math.h>

#include "base/memory.h"
#include "overlap/ops.h"
#include "overlap/pair/centroid.h"
#include "overlap/portions.h"
#include "overlap/separation.h"

bool overlap_model_has_ghosts(const OverlapModel *model) {
  return model->ops->has_ghosts && model->ops->has_ghosts(model->self);
}

bool overlap_model_has_hessian(const OverlapModel *model) {
  return model->ops->has_hessian && model->ops->has_hessian(model->self);
}

bool overlap_model_has_own_centroid(const OverlapModel *model) {
  return model->ops->has_centroid && model->ops->has_centroid(model->self);
}

bool overlap_model_has_gradient(const OverlapModel *model) {
  return !model->ops->has_gradient || model->ops->has_gradient(model->self);
}

bool overlap_model_wants_origins(const OverlapModel *model) {
  return model->ops->wants_origins && model->ops->wants_origins(model->self);
}

void overlap_model_destroy(OverlapModel *model) {
  if (model->ops && model->ops->destroy) model->ops->destroy(model->self);
  *model = (OverlapModel){0};
}

enum { BLOCK = 64 }; // pairs looked through at once

// Whether the sum of all coordinates of `count` pairs is finite: then each is. One that is not may have
// overflowed. Eight sums do not wait for each other.
static inline bool have_finite_sum(int count, const double *pairs) {
  double sum[8] = {0};
  for (int i = 0; i < OVERLAP_PAIR_SIZE * count; i += 8)
    for (int k = 0; k < 8; k++) sum[k] += pairs[i + k];
  for (int k = 0; k < 4; k++) sum[k] += sum[k + 4];
  return isfinite(sum[0] + sum[1] + (sum[2] + sum[3]));
}

static Status fail_not_finite(int pair_index, const double pair[OVERLAP_PAIR_SIZE]) {
  int i = 0;
  while (isfinite(pair[i])) i++;
  return status_fail(STATUS_INPUT,
                     "pair %d, tetrahedron %d, vertex %d: coordinate %c is %g, it must be a finite number",
                     pair_index, i / 12, i / 3 % 4, "xyz"[i % 3], pair[i]);
}

// The first pair with a coordinate that is not finite, pair_count if there is none.
static int first_not_finite(const OverlapBatch *batch) {
  int first = batch->pair_count;
#pragma omp parallel for schedule(static) reduction(min : first) if (batch->pair_count > 20000)
  for (int begin = 0; begin < batch->pair_count; begin += BLOCK) {
    const double *pairs = batch->pairs + (size_t)begin * OVERLAP_PAIR_SIZE;
    const int left = batch->pair_count - begin, count = left < BLOCK ? left : BLOCK;
    if (have_finite_sum(count, pairs)) continue;
    for (int i = 0; i < count; i++)
      if (!overlap_ops_are_finite(OVERLAP_PAIR_SIZE, pairs + i * OVERLAP_PAIR_SIZE) && begin + i < first)
        first = begin + i;
  }
  return first;
}

static Status check_finite(const OverlapBatch *batch) {
  int bad = first_not_finite(batch);
  return bad == batch->pair_count ? STATUS_OK
                                  : fail_not_finite(batch->numbers ? batch->numbers[bad] : bad,
                                                    batch->pairs + (size_t)bad * OVERLAP_PAIR_SIZE);
}

static Status eval_one(const OverlapModel *model, const OverlapBatch *batch, int i) {
  unsigned flags = 0;
  OverlapAnswer answer = overlap_ops_answer(batch, i, &flags);
  return model->ops->eval_pair(model->self, batch->pairs + (size_t)i * OVERLAP_PAIR_SIZE, &answer);
}

static void write_disjoint(const OverlapBatch *batch, int i) {
  unsigned flags;
  OverlapAnswer answer = overlap_ops_answer(batch, i, &flags);
  overlap_ops_write_nothing(&answer);
  *answer.flags = OVERLAP_DISJOINT;
}

// Less work than this [s] is not worth waking threads for.
static const double WORTH_THREADS = 2e-4;

enum { PORTION = 64 }; // pairs that a thread takes at a time

// All pairs but those that a face separates: what these are is known without the model.
static Status eval_portion(const void *self, const OverlapBatch *portion, int first) {
  const OverlapModel *model = self;
  bool is_apart[PORTION] = {false};
  if (!model->ops->rejects_disjoint && !overlap_model_has_ghosts(model))
    overlap_separation_find(portion->pair_count, portion->pairs, is_apart);
  for (int i = 0; i < portion->pair_count; i++) {
    Status status = STATUS_OK;
    if (is_apart[i])
      write_disjoint(portion, i);
    else
      status = eval_one(model, portion, i);
    if (status)
      return status_prefix(status, "overlap model '%s': pair %d", model->ops->name,
                           portion->numbers ? portion->numbers[i] : first + i);
  }
  return STATUS_OK;
}

// Costs differ from pair to pair by a hundred and more, hence small portions.
static Status eval_each(const OverlapModel *model, const OverlapBatch *batch) {
  bool is_much = batch->pair_count * model->ops->seconds_per_pair > WORTH_THREADS;
  return overlap_portions_eval(batch, PORTION, is_much, eval_portion, model);
}

static Status ask(const OverlapModel *model, const OverlapBatch *batch) {
  return model->ops->eval_batch ? model->ops->eval_batch(model->self, batch) : eval_each(model, batch);
}

// Centroids from V and ∇V.
static Status eval_with_centroid(const OverlapModel *model, const OverlapBatch *batch) {
  enum { SIZE = OVERLAP_PAIR_SIZE };
  OverlapBatch asked = *batch;
  asked.centroid = NULL;
  if (!batch->gradient) asked.gradient = memory_zeroed((size_t)batch->pair_count, SIZE * sizeof(double));
  if (!asked.gradient) return status_no_memory("gradients of overlaps");
  Status status = ask(model, &asked);
#pragma omp parallel for schedule(static) if (batch->pair_count > 2000)
  for (int i = 0; i < batch->pair_count; i++)
    if (!status)
      overlap_centroid_derive(batch->pairs + (size_t)i * SIZE, batch->volume[i],
                              asked.gradient + (size_t)i * SIZE, batch->centroid + 3 * (size_t)i);
  if (!batch->gradient) memory_free(asked.gradient);
  return status;
}

Status overlap_model_eval(const OverlapModel *model, const OverlapBatch *batch) {
  if (batch->hessian && !overlap_model_has_hessian(model))
    return status_fail(STATUS_INPUT, "overlap model '%s' has no Hessian", model->ops->name);
  if (batch->gradient && !overlap_model_has_gradient(model))
    return status_fail(STATUS_INPUT, "overlap model '%s' gives no gradient", model->ops->name);
  if (batch->centroid && !overlap_model_has_own_centroid(model) && !overlap_model_has_gradient(model))
    return status_fail(STATUS_INPUT,
                       "overlap model '%s' gives V alone: a centroid needs one of its own, or its gradient",
                       model->ops->name);
  if (!model->ops->checks_finite) TRY(check_finite(batch));
  Status status = batch->centroid && !overlap_model_has_own_centroid(model) ? eval_with_centroid(model, batch)
                                                                            : ask(model, batch);
  if (status != STATUS_OK && model->ops->checks_finite) TRY(check_finite(batch)); // which says more
  return status;
}

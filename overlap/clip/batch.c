// SPDX-License-Identifier: Apache-2.0
// Batches of pairs on vectors. Groups in which few lanes may overlap wait until there are enough for a full
// vector, so that disjoint pairs cost only the first part of lanes.h.
#include <math.h>
#include <string.h>

#include "overlap/clip/clip.h"
#include "overlap/clip/lanes.h"
#include "overlap/portions.h"

// Pairs that wait, a vector's worth and less than one more.
typedef struct Queue {
  int count;
  int at[2 * OVERLAP_CLIP_MAX_LANES]; // index into the batch
  double pairs[2 * OVERLAP_CLIP_MAX_LANES][OVERLAP_PAIR_SIZE];
} Queue;

typedef struct Work {
  const OverlapClipLanes *lanes;
  const OverlapBatch *batch;
  Queue queue;
} Work;

// Pairs that are not finite all come here, for their lanes are doubtful.
static Status ask_carefully(const OverlapBatch *batch, int i) {
  size_t begin = (size_t)i * OVERLAP_PAIR_SIZE;
  for (size_t c = begin; c < begin + OVERLAP_PAIR_SIZE; c++)
    if (!isfinite(batch->pairs[c])) return status_fail(STATUS_INPUT, "pair %d is not finite", i);
  unsigned flags = 0;
  OverlapAnswer answer = overlap_ops_answer(batch, i, &flags);
  return overlap_clip_scalar_ops.eval_pair(NULL, batch->pairs + begin, &answer);
}

static void write_disjoint(const OverlapBatch *batch, int i) {
  batch->volume[i] = 0;
  if (batch->gradient)
    memset(batch->gradient + (size_t)i * OVERLAP_PAIR_SIZE, 0, OVERLAP_PAIR_SIZE * sizeof(double));
  if (batch->centroid) memset(batch->centroid + 3 * (size_t)i, 0, 3 * sizeof(double));
}

static OverlapClipLanesOutcome run(const Work *work, const double *pairs, int least, double *volume,
                                   double *gradient, double *centroid) {
  if (centroid) return work->lanes->locate(pairs, least, volume, gradient, centroid);
  return gradient ? work->lanes->differentiate(pairs, least, volume, gradient)
                  : work->lanes->measure(pairs, least, volume);
}

static unsigned flags_of(const OverlapClipLanesOutcome *outcome, int lane) {
  return (outcome->disjoint >> lane & 1 ? (unsigned)OVERLAP_DISJOINT : 0) |
         (outcome->enclosed >> lane & 1 ? (unsigned)OVERLAP_ENCLOSED : 0);
}

// The first `count` that wait, at most a vector's worth.
static Status answer_queue(Work *work, int count) {
  const OverlapBatch *batch = work->batch;
  Queue *queue = &work->queue;
  double volume[OVERLAP_CLIP_MAX_LANES], gradient[OVERLAP_CLIP_MAX_LANES][OVERLAP_PAIR_SIZE];
  double centroid[OVERLAP_CLIP_MAX_LANES][3];
  for (int k = count; k < work->lanes->width; k++)
    memcpy(queue->pairs[k], queue->pairs[0], sizeof queue->pairs[k]);
  OverlapClipLanesOutcome outcome =
      run(work, queue->pairs[0], 0, volume, batch->gradient ? gradient[0] : NULL,
          batch->centroid ? centroid[0] : NULL);
  for (int k = 0; k < count; k++) {
    int i = queue->at[k];
    if (outcome.doubtful >> k & 1) {
      TRY(ask_carefully(batch, i));
      continue;
    }
    batch->volume[i] = volume[k];
    if (batch->gradient)
      memcpy(batch->gradient + (size_t)i * OVERLAP_PAIR_SIZE, gradient[k], sizeof gradient[k]);
    if (batch->centroid) memcpy(batch->centroid + 3 * (size_t)i, centroid[k], sizeof centroid[k]);
    if (batch->flags) batch->flags[i] = flags_of(&outcome, k);
  }
  queue->count -= count;
  memmove(queue->pairs, queue->pairs + count, (size_t)queue->count * sizeof *queue->pairs);
  memmove(queue->at, queue->at + count, (size_t)queue->count * sizeof *queue->at);
  return STATUS_OK;
}

static Status enqueue(Work *work, int i) {
  Queue *queue = &work->queue;
  queue->at[queue->count] = i;
  memcpy(queue->pairs[queue->count++], work->batch->pairs + (size_t)i * OVERLAP_PAIR_SIZE,
         sizeof queue->pairs[0]);
  return queue->count < 2 * work->lanes->width ? STATUS_OK : answer_queue(work, work->lanes->width);
}

static Status answer_group(Work *work, int first) {
  const OverlapBatch *batch = work->batch;
  size_t begin = (size_t)first * OVERLAP_PAIR_SIZE;
  int width = work->lanes->width;
  OverlapClipLanesOutcome outcome = run(work, batch->pairs + begin, width / 2 + 1, batch->volume + first,
                                        batch->gradient ? batch->gradient + begin : NULL,
                                        batch->centroid ? batch->centroid + 3 * (size_t)first : NULL);
  for (int k = 0; batch->flags && k < width; k++) batch->flags[first + k] = flags_of(&outcome, k);
  for (uint32_t left = outcome.doubtful; left; left &= left - 1)
    TRY(ask_carefully(batch, first + __builtin_ctz(left)));
  for (uint32_t left = outcome.waiting; left; left &= left - 1)
    TRY(enqueue(work, first + __builtin_ctz(left)));
  bool is_written = outcome.waiting == 0 && outcome.disjoint != (1ULL << width) - 1;
  for (uint32_t left = is_written ? 0 : outcome.disjoint; left; left &= left - 1)
    write_disjoint(batch, first + __builtin_ctz(left));
  return STATUS_OK;
}

static Status answer_all(const OverlapClipLanes *lanes, const OverlapBatch *batch) {
  Work work = {.lanes = lanes, .batch = batch};
  int i = 0;
  for (; i + lanes->width <= batch->pair_count; i += lanes->width) TRY(answer_group(&work, i));
  for (; i < batch->pair_count; i++) TRY(enqueue(&work, i));
  while (work.queue.count > 0)
    TRY(answer_queue(&work, work.queue.count < lanes->width ? work.queue.count : lanes->width));
  return STATUS_OK;
}

// What one thread takes at a time: small portions of small batches, so that there are enough of them. From
// WORTH_THREADS pairs on more than one thread is worth it.
enum { PORTION = 512, SMALL_PORTION = 128, MANY = 16 * PORTION, WORTH_THREADS = 16 * SMALL_PORTION };

// `self`: the lanes; NULL: none, each pair by itself.
static Status eval_portion(const void *self, const OverlapBatch *portion, int first) {
  Status status = STATUS_OK;
  if (self && !portion->hessian)
    status = answer_all(self, portion);
  else
    for (int i = 0; i < portion->pair_count && !status; i++) status = ask_carefully(portion, i);
  return status ? status_prefix(status, "clipping pairs %d to %d", first, first + portion->pair_count - 1)
                : STATUS_OK;
}

static Status eval(const OverlapClipLanes *lanes, const OverlapBatch *batch) {
  int size = batch->pair_count < MANY ? SMALL_PORTION : PORTION;
  return overlap_portions_eval(batch, size, batch->pair_count >= WORTH_THREADS, eval_portion, lanes);
}

static Status eval_one(const OverlapClipLanes *lanes, const double pair[24], const OverlapAnswer *answer) {
  OverlapBatch batch = overlap_ops_single(pair, answer);
  return lanes && !batch.hessian ? answer_all(lanes, &batch) : ask_carefully(&batch, 0);
}

static Status eval_batch(const void *self, const OverlapBatch *batch) {
  (void)self;
  return eval(overlap_clip_lanes(), batch);
}

static Status eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  (void)self;
  return eval_one(overlap_clip_lanes(), pair, answer);
}

static Status eval_batch_single(const void *self, const OverlapBatch *batch) {
  (void)self;
  return eval(overlap_clip_lanes_single(), batch);
}

static Status eval_pair_single(const void *self, const double pair[24], const OverlapAnswer *answer) {
  (void)self;
  return eval_one(overlap_clip_lanes_single(), pair, answer);
}

const OverlapOps overlap_clip_ops = {
    .name = "clip",
    .help = "clipping in double precision, with exact gradient and Hessian",
    .has_hessian = overlap_ops_always,
    .has_centroid = overlap_ops_always,
    .seconds_per_pair = 1e-7,
    .eval_pair = eval_pair,
    .eval_batch = eval_batch,
    .checks_finite = true,
};

const OverlapOps overlap_clip32_ops = {
    .name = "clip32",
    .has_centroid = overlap_ops_always,
    .help = "as clip in single precision: relative error of V up to 1e-3",
    .seconds_per_pair = 7e-8,
    .eval_pair = eval_pair_single,
    .eval_batch = eval_batch_single,
    .checks_finite = true,
};

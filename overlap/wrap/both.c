// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/both.h"

#include <string.h>

#include "base/memory.h"
#include "overlap/blend.h"
#include "overlap/slopes.h"

enum { SIZE = OVERLAP_PAIR_SIZE, HALF = SIZE / 2, SQUARE = SIZE * SIZE, ROWS = 3 * SIZE };

// Where a coordinate stands in the other order.
static int across(int i) {
  return (i + HALF) % SIZE;
}

// Arrays of all pairs, then of all pairs in the other order.
static Status lay_out(OverlapWrap *wrap, const OverlapBatch *batch, OverlapBatch *asked) {
  const size_t n = 2 * (size_t)batch->pair_count;
  const bool tells = batch->origins.elements != NULL;
  const size_t widths[] = {SIZE,
                           1,
                           batch->gradient ? SIZE : 0,
                           batch->hessian ? SQUARE : 0,
                           batch->centroid ? 3 : 0,
                           batch->doubt ? 1 : 0,
                           batch->doubt_gradient ? SIZE : 0,
                           tells ? 2 : 0};
  enum { PAIRS, VOLUME, GRADIENT, HESSIAN, CENTROID, DOUBT, DOUBT_GRADIENT, REST, ARRAYS };
  double *arrays[ARRAYS];
  size_t sum = 0;
  for (int a = 0; a < ARRAYS; a++) sum += widths[a] * n;
  TRY(overlap_wrap_reserve(wrap, sum, (tells ? 6 : 2) * n));
  for (int a = 0, at = 0; a < ARRAYS; at += (int)widths[a++])
    arrays[a] = widths[a] ? wrap->room + n * (size_t)at : NULL;
  *asked = (OverlapBatch){.pair_count = (int)n,
                          .pairs = arrays[PAIRS],
                          .volume = arrays[VOLUME],
                          .gradient = arrays[GRADIENT],
                          .hessian = arrays[HESSIAN],
                          .centroid = arrays[CENTROID],
                          .doubt = arrays[DOUBT],
                          .doubt_gradient = arrays[DOUBT_GRADIENT],
                          .flags = (unsigned *)wrap->integers,
                          .numbers = wrap->integers + n};
  if (tells) asked->origins = (OverlapOrigins){wrap->integers + 2 * n, wrap->integers + 4 * n, arrays[REST]};
  return STATUS_OK;
}

static void copy_origins(const OverlapBatch *batch, const OverlapBatch *asked) {
  const OverlapOrigins *from = &batch->origins;
  int32_t *elements = (int32_t *)asked->origins.elements, *bodies = (int32_t *)asked->origins.bodies;
  double *rest = (double *)asked->origins.rest;
  const size_t n = (size_t)batch->pair_count;
  for (size_t k = 0; k < 2 * n && from->elements; k++) {
    const size_t other = 2 * n + (k ^ 1);
    elements[k] = elements[other] = from->elements[k];
    bodies[k] = bodies[other] = from->bodies[k];
    rest[k] = rest[other] = from->rest[k];
  }
}

static void copy_pairs(const OverlapWrap *wrap, const OverlapBatch *batch) {
  const size_t n = (size_t)batch->pair_count;
  int *numbers = wrap->integers + 2 * n;
  memcpy(wrap->room, batch->pairs, n * SIZE * sizeof *wrap->room);
  for (size_t i = 0; i < n; i++) {
    overlap_ops_swap(batch->pairs + SIZE * i, wrap->room + SIZE * (n + i));
    numbers[i] = numbers[n + i] = batch->numbers ? batch->numbers[i] : (int)i;
  }
}

static void take_centroid(const double volumes[2], const double *first, const double *second,
                          double *centroid) {
  const double sum = volumes[0] + volumes[1];
  for (int c = 0; c < 3; c++)
    centroid[c] = sum > 0 ? (volumes[0] * first[c] + volumes[1] * second[c]) / sum : 0;
}

static void take_gradient(const double *gradients, size_t n, size_t i, double *gradient) {
  for (size_t r = 0; r < SIZE; r++)
    gradient[r] = (gradients[SIZE * i + r] + gradients[SIZE * (n + i) + (size_t)across((int)r)]) / 2;
}

static void take(const OverlapBatch *asked, size_t n, size_t i, const OverlapAnswer *answer) {
  const double volumes[2] = {asked->volume[i], asked->volume[n + i]};
  *answer->volume = (volumes[0] + volumes[1]) / 2;
  *answer->flags = asked->flags[i] | asked->flags[n + i];
  if (*answer->volume > 0) *answer->flags &= ~(unsigned)OVERLAP_DISJOINT;
  if (answer->gradient) take_gradient(asked->gradient, n, i, answer->gradient);
  for (size_t r = 0; r < SIZE && answer->hessian; r++)
    for (size_t c = 0; c < SIZE; c++)
      answer->hessian[SIZE * r + c] =
          (asked->hessian[SQUARE * i + SIZE * r + c] +
           asked->hessian[SQUARE * (n + i) + SIZE * (size_t)across((int)r) + (size_t)across((int)c)]) /
          2;
  if (answer->centroid)
    take_centroid(volumes, asked->centroid + 3 * i, asked->centroid + 3 * (n + i), answer->centroid);
}

static Status eval(OverlapWrap *wrap, const OverlapBatch *batch) {
  OverlapBatch asked;
  const size_t n = (size_t)batch->pair_count;
  TRY(lay_out(wrap, batch, &asked));
  copy_pairs(wrap, batch);
  copy_origins(batch, &asked);
  TRY(overlap_model_eval(&wrap->inner, &asked));
  for (size_t i = 0; i < n; i++) {
    unsigned flags;
    OverlapAnswer answer = overlap_ops_answer(batch, (int)i, &flags);
    take(&asked, n, i, &answer);
    if (batch->doubt) batch->doubt[i] = (asked.doubt[i] + asked.doubt[n + i]) / 2;
    if (batch->doubt_gradient) take_gradient(asked.doubt_gradient, n, i, batch->doubt_gradient + SIZE * i);
  }
  return STATUS_OK;
}

static Status ask_order(const OverlapModel *inner, const double *pair, OverlapBlend *answer) {
  return overlap_slopes_eval(inner,
                             &(OverlapBatch){.pair_count = 1,
                                             .pairs = pair,
                                             .volume = &answer->volume,
                                             .gradient = answer->gradient,
                                             .centroid = answer->centroid},
                             answer->slopes);
}

static Status eval_slopes(const OverlapWrap *wrap, int count, const double *pairs, double *slopes) {
  const double none[SIZE] = {0};
  for (int i = 0; i < count; i++) {
    OverlapBlend own, told, other;
    double swapped[SIZE];
    const double *pair = pairs + SIZE * (ptrdiff_t)i;
    overlap_ops_swap(pair, swapped);
    TRY(ask_order(&wrap->inner, pair, &own));
    TRY(ask_order(&wrap->inner, swapped, &told));
    other = told;
    overlap_ops_swap(told.gradient, other.gradient);
    for (int c = 0; c < 3; c++) overlap_ops_swap(told.slopes + SIZE * c, other.slopes + SIZE * c);
    overlap_blend_mix(0.5, none, &other, &own);
    memcpy(slopes + ROWS * (ptrdiff_t)i, own.slopes, sizeof own.slopes);
  }
  return STATUS_OK;
}

static Status eval_logits(const OverlapWrap *wrap, int count, const double *pairs, double *logits) {
  const OverlapModel *inner = &wrap->inner;
  const size_t n = (size_t)count;
  double *swapped = memory_zeroed(n, (SIZE + 1) * sizeof *swapped);
  if (!swapped) return status_no_memory("pairs for an overlap model");
  double *second = swapped + SIZE * n;
  for (size_t i = 0; i < n; i++) overlap_ops_swap(pairs + SIZE * i, swapped + SIZE * i);
  Status status = inner->ops->eval_logits(inner->self, count, pairs, logits);
  if (!status) status = inner->ops->eval_logits(inner->self, count, swapped, second);
  for (size_t i = 0; i < n && !status; i++) logits[i] = (logits[i] + second[i]) / 2;
  memory_free(swapped);
  return status;
}

const OverlapWrapKind overlap_wrap_both = {
    .name = "both",
    .help = "the mean of both orders of the two tetrahedra",
    .eval = eval,
    .eval_slopes = eval_slopes,
    .eval_logits = eval_logits,
    .keeps_doubt = true,
    .lacks_range = true,
    .centroid = OVERLAP_WRAP_MIXED_CENTROID,
};

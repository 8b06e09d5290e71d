// SPDX-License-Identifier: Apache-2.0
#include "overlap/wrap/cut.h"

#include <math.h>
#include <string.h>

#include "overlap/clip/clip.h"
#include "overlap/pair/sizes.h"
#include "overlap/separation.h"

enum { SIZE = OVERLAP_PAIR_SIZE, SQUARE = SIZE * SIZE };

static Status check(const OverlapModel *inner) {
  return overlap_model_has_ghosts(inner)
             ? STATUS_OK
             : status_fail(STATUS_INPUT,
                           "'%s' gives no volume to disjoint pairs: leave out what is about them",
                           inner->ops->name);
}

// What clipping finds so much of, as a share of the smaller tetrahedron, does overlap.
static const double CERTAIN_SHARE = 1e-6;

// Why a pair is not asked for: its flag; 0: it is asked for. `clipped`: V by clipping, NAN: not known. It
// only saves time: the separating axes of a pair that overlaps take ten times as long.
static unsigned answer_unasked(const OverlapWrap *wrap, const double pair[SIZE], double clipped) {
  const double most = overlap_sizes_smaller(pair);
  if (!(most > 0)) return OVERLAP_FLAT;
  if (!wrap->kind->answers_disjoint || clipped > CERTAIN_SHARE * most) return 0;
  return overlap_separation_pair(pair, 0) >= 0 ? OVERLAP_DISJOINT : 0;
}

// The pairs that are asked for: theirs of each array, one behind the other.
typedef struct Asked {
  int *rows; // of the batch
  OverlapBatch batch;
} Asked;

// Places in the scratch memory for all pairs of the batch; the first `n` numbers are V by clipping.
static Status lay_out(OverlapWrap *wrap, const OverlapBatch *batch, Asked *asked) {
  enum { CLIPPED, PAIRS, VOLUME, GRADIENT, HESSIAN, CENTROID, DOUBT, DOUBT_GRADIENT, REST, ARRAYS };
  const size_t n = (size_t)batch->pair_count;
  const bool tells = batch->origins.elements != NULL;
  const size_t widths[ARRAYS] = {1,
                                 SIZE,
                                 1,
                                 batch->gradient ? SIZE : 0,
                                 batch->hessian ? SQUARE : 0,
                                 batch->centroid ? 3 : 0,
                                 batch->doubt ? 1 : 0,
                                 batch->doubt_gradient ? SIZE : 0,
                                 tells ? 2 : 0};
  double *arrays[ARRAYS];
  size_t sum = 0;
  for (int a = 0; a < ARRAYS; a++) sum += widths[a];
  TRY(overlap_wrap_reserve(wrap, sum * n, (tells ? 7 : 3) * n));
  sum = 0;
  for (int a = 0; a < ARRAYS; sum += widths[a++]) arrays[a] = widths[a] ? wrap->room + sum * n : NULL;
  asked->rows = wrap->integers;
  asked->batch = (OverlapBatch){.pairs = arrays[PAIRS],
                                .volume = arrays[VOLUME],
                                .gradient = arrays[GRADIENT],
                                .hessian = arrays[HESSIAN],
                                .centroid = arrays[CENTROID],
                                .doubt = arrays[DOUBT],
                                .doubt_gradient = arrays[DOUBT_GRADIENT],
                                .flags = (unsigned *)wrap->integers + n,
                                .numbers = wrap->integers + 2 * n};
  if (tells)
    asked->batch.origins = (OverlapOrigins){wrap->integers + 3 * n, wrap->integers + 5 * n, arrays[REST]};
  return STATUS_OK;
}

static void append(Asked *asked, const OverlapBatch *batch, int row) {
  const size_t k = (size_t)asked->batch.pair_count++, i = (size_t)row;
  const OverlapOrigins *from = &batch->origins, *to = &asked->batch.origins;
  asked->rows[k] = row;
  ((int *)asked->batch.numbers)[k] = batch->numbers ? batch->numbers[i] : row;
  memcpy((double *)asked->batch.pairs + SIZE * k, batch->pairs + SIZE * i, SIZE * sizeof(double));
  for (size_t t = 0; t < 2 && from->elements; t++) {
    ((int32_t *)to->elements)[2 * k + t] = from->elements[2 * i + t];
    ((int32_t *)to->bodies)[2 * k + t] = from->bodies[2 * i + t];
    ((double *)to->rest)[2 * k + t] = from->rest[2 * i + t];
  }
}

static void choose(OverlapWrap *wrap, const OverlapBatch *batch, Asked *asked) {
  // Clipping refuses coordinates that the axes do not; then they decide alone.
  const bool is_clipped =
      wrap->kind->answers_disjoint &&
      overlap_clip_ops.eval_batch(NULL, &(OverlapBatch){.pair_count = batch->pair_count,
                                                        .pairs = batch->pairs,
                                                        .volume = wrap->room}) == STATUS_OK;
  for (int i = 0; i < batch->pair_count; i++) {
    unsigned unused;
    const double *pair = batch->pairs + SIZE * (ptrdiff_t)i;
    OverlapAnswer answer = overlap_ops_answer(batch, i, &unused);
    *answer.flags = answer_unasked(wrap, pair, is_clipped ? wrap->room[i] : NAN);
    if (*answer.flags)
      overlap_ops_write_nothing(&answer);
    else
      append(asked, batch, i);
    if (*answer.flags && batch->doubt) batch->doubt[i] = 0;
    if (*answer.flags && batch->doubt_gradient)
      memset(batch->doubt_gradient + SIZE * (ptrdiff_t)i, 0, SIZE * sizeof *batch->doubt_gradient);
  }
}

static void copy(const double *from, double *to, size_t size) {
  if (to) memcpy(to, from, size * sizeof *to);
}

static Status eval(OverlapWrap *wrap, const OverlapBatch *batch) {
  Asked asked;
  TRY(lay_out(wrap, batch, &asked));
  choose(wrap, batch, &asked);
  if (asked.batch.pair_count == 0) return STATUS_OK;
  TRY(overlap_model_eval(&wrap->inner, &asked.batch));
  for (int k = 0; k < asked.batch.pair_count; k++) {
    unsigned unused;
    const OverlapAnswer from = overlap_ops_answer(&asked.batch, k, NULL),
                        to = overlap_ops_answer(batch, asked.rows[k], &unused);
    *to.volume = *from.volume, *to.flags = *from.flags;
    copy(from.gradient, to.gradient, SIZE);
    copy(from.hessian, to.hessian, SQUARE);
    copy(from.centroid, to.centroid, 3);
    if (batch->doubt) batch->doubt[asked.rows[k]] = asked.batch.doubt[k];
    if (batch->doubt_gradient)
      copy(asked.batch.doubt_gradient + SIZE * (ptrdiff_t)k,
           batch->doubt_gradient + SIZE * (ptrdiff_t)asked.rows[k], SIZE);
  }
  return STATUS_OK;
}

static Status eval_pull(OverlapWrap *wrap, const OverlapPull *pull) {
  const size_t n = (size_t)pull->pair_count;
  size_t count = 0;
  TRY(overlap_wrap_reserve(wrap, (3 * SIZE + 4) * n, 2 * n));
  double *pairs = wrap->room, *by_gradient = pairs + SIZE * n, *slope = by_gradient + SIZE * n,
         *by_centroid = slope + SIZE * n, *by_volume = by_centroid + 3 * n;
  int *numbers = wrap->integers + n;
  for (size_t i = 0; i < n; i++) {
    memset(pull->slope + SIZE * i, 0, SIZE * sizeof *pull->slope);
    if (answer_unasked(wrap, pull->pairs + SIZE * i, NAN)) continue;
    copy(pull->pairs + SIZE * i, pairs + SIZE * count, SIZE);
    by_volume[count] = pull->by_volume[i];
    if (pull->by_centroid) copy(pull->by_centroid + 3 * i, by_centroid + 3 * count, 3);
    if (pull->by_gradient) copy(pull->by_gradient + SIZE * i, by_gradient + SIZE * count, SIZE);
    numbers[count] = pull->numbers ? pull->numbers[i] : (int)i;
    wrap->integers[count++] = (int)i;
  }
  if (count == 0) return STATUS_OK;
  TRY(wrap->inner.ops->eval_pull(wrap->inner.self,
                                 &(OverlapPull){.pair_count = (int)count,
                                                .pairs = pairs,
                                                .by_volume = by_volume,
                                                .by_centroid = pull->by_centroid ? by_centroid : NULL,
                                                .by_gradient = pull->by_gradient ? by_gradient : NULL,
                                                .slope = slope,
                                                .numbers = numbers}));
  for (size_t k = 0; k < count; k++)
    copy(slope + SIZE * k, pull->slope + SIZE * (size_t)wrap->integers[k], SIZE);
  return STATUS_OK;
}

const OverlapWrapKind overlap_wrap_cut = {
    .name = "cut",
    .help = "disjoint pairs are answered by 0",
    .check = check,
    .eval = eval,
    .eval_pull = eval_pull,
    .answers_disjoint = true,
    .keeps_doubt = true,
    .centroid = OVERLAP_WRAP_INNER_CENTROID,
};

const OverlapWrapKind overlap_wrap_keep = {
    .name = "keep",
    .help = "the model is asked for disjoint pairs, too",
    .check = check,
    .eval = eval,
    .eval_pull = eval_pull,
    .keeps_doubt = true,
    .centroid = OVERLAP_WRAP_INNER_CENTROID,
};

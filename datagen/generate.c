// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/generate.h"

#include <limits.h>
#include <string.h>

#include "base/random.h"
#include "datagen/draw/sampler.h"
#include "overlap/clip/clip.h"
#include "overlap/exact/exact.h"

Status datagen_generate_label(DatagenLabel label, const double pair[24], int dimension, double *volume,
                              double *gradient, double *centroid) {
  unsigned flags;
  OverlapAnswer answer = {.volume = volume, .gradient = gradient, .centroid = centroid, .flags = &flags};
  *volume = 0;
  if (centroid) memset(centroid, 0, 3 * sizeof *centroid);
  if (gradient) memset(gradient, 0, OVERLAP_PAIR_SIZE * sizeof *gradient);
  if (dimension < 3) return STATUS_OK;
  if (label == DATAGEN_LABEL_CLIP) {
    TRY(overlap_clip_ops.eval_pair(NULL, pair, &answer));
    if (*volume > 0) return STATUS_OK;
  }
  return overlap_exact_ops.eval_pair(NULL, pair, &answer);
}

// One pair, into its place in the arrays.
static Status make_pair(const DatagenPlan *plan, long long index, const DatagenPairs *pairs, int place,
                        long long *attempts) {
  Random random = random_seeded(plan->seed, (uint64_t)index);
  DatagenKind kind = datagen_plan_kind(plan, index);
  DatagenSample sample = datagen_sampler_draw(kind, &plan->sieve, plan->law.swap_share, &random);
  const size_t offset = (size_t)place * OVERLAP_PAIR_SIZE;
  memcpy(pairs->coordinates + offset, sample.pair, sizeof sample.pair);
  pairs->status[place] = sample.proof.dimension >= 0;
  pairs->kind[place] = (uint8_t)kind;
  attempts[kind] += sample.attempts;
  return datagen_generate_label(plan->label, sample.pair, sample.proof.dimension, pairs->volume + place,
                                pairs->gradient ? pairs->gradient + offset : NULL,
                                pairs->centroid ? pairs->centroid + 3 * (size_t)place : NULL);
}

// Kinds cost differently, by a thousand times: indices are handed out in small lots.
Status datagen_generate(const DatagenPlan *plan, long long first, int count, const DatagenPairs *pairs,
                        long long attempts[DATAGEN_KIND_COUNT]) {
  int first_failed = INT_MAX;
#pragma omp parallel for schedule(dynamic, 16) reduction(min : first_failed)                                 \
    reduction(+ : attempts[ : DATAGEN_KIND_COUNT])
  for (int i = 0; i < count; i++)
    if (make_pair(plan, first + i, pairs, i, attempts) != STATUS_OK && i < first_failed) first_failed = i;
  if (first_failed == INT_MAX) return STATUS_OK;
  // A message belongs to the thread that failed: this thread makes the pair again to have it.
  long long ignored[DATAGEN_KIND_COUNT] = {0};
  Status status = make_pair(plan, first + first_failed, pairs, first_failed, ignored);
  if (status == STATUS_OK)
    return status_fail(STATUS_SOLVER, "pair %lld failed once and not again", first + first_failed);
  return status_prefix(status, "pair %lld", first + first_failed);
}

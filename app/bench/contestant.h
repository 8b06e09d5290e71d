// SPDX-License-Identifier: GPL-3.0-or-later
// An overlap model that evaluates a batch of pairs repeatedly; benches measure several in turn.
#ifndef TETLAP_APP_BENCH_CONTESTANT_H
#define TETLAP_APP_BENCH_CONTESTANT_H

#include "app/bench/timer.h"
#include "overlap/model.h"

typedef struct AppBenchContestant {
  const OverlapModel *model; // borrowed
  OverlapBatch batch;        // its arrays are the bench's; contestants may share what is written
  int threads;
  int calls;           // a round; 0: not known before the first turn, the warm-up
  AppBenchTimer timer; // of a pair
} AppBenchContestant;

// The largest batch, `wanted` at most, whose single call does not take long by the model's own guess;
// Hessians cost four times as much.
int app_bench_contestant_batch(const OverlapModel *model, bool has_hessian, int threads, int wanted);

// Evaluates the batch as often as fills a round and times a pair; an AppBenchAct. The first turn finds how
// often that is.
Status app_bench_contestant_take_turn(void *contestant, int round);

#endif

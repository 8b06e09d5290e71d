// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/contestant.h"

#include <limits.h>
#include <omp.h>

#include "base/clock.h"

static const double ROUND_S = 0.05, CALL_S = 0.25; // what a round and a call shall take

static int limited(double value, int largest) {
  return value < 1 ? 1 : value < largest ? (int)value : largest;
}

int app_bench_contestant_batch(const OverlapModel *model, bool has_hessian, int threads, int wanted) {
  double per_pair = model->ops->seconds_per_pair * (has_hessian ? 4 : 1);
  // a model that needs less than a microsecond is never cut: its guess is not that good
  return per_pair < 1e-6 ? wanted : limited(CALL_S * threads / per_pair, wanted);
}

static Status find_calls(AppBenchContestant *contestant) {
  double began = clock_wall_s();
  TRY(overlap_model_eval(contestant->model, &contestant->batch)); // wakes threads, loads caches
  double first = clock_wall_s();
  if (first - began > ROUND_S) {
    contestant->calls = 1;
    return STATUS_OK;
  }
  TRY(overlap_model_eval(contestant->model, &contestant->batch));
  contestant->calls = limited(ROUND_S / (clock_wall_s() - first + 1e-9), INT_MAX);
  return STATUS_OK;
}

Status app_bench_contestant_take_turn(void *self, int round) {
  AppBenchContestant *contestant = self;
  omp_set_num_threads(contestant->threads);
  if (contestant->calls == 0) TRY(find_calls(contestant));
  app_bench_timer_start(&contestant->timer);
  for (int call = 0; call < contestant->calls; call++)
    TRY(overlap_model_eval(contestant->model, &contestant->batch));
  app_bench_timer_stop(&contestant->timer, round, (double)contestant->calls * contestant->batch.pair_count);
  return STATUS_OK;
}
